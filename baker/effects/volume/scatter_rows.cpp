#include "baker/effects/volume/scatter_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>
#include <vector>

#include "baker/jobs/parallel.hpp"

namespace lambent::baker {

ScatterRows::ScatterRows(const VolumeScene& scene, const SphereTable& table, std::span<const double> met,
                         std::uint64_t memory)
    : scene_(scene),
      table_(&table),
      met_(met.begin(), met.end()),
      self_(met.size()),
      others_(met.size()),
      chunks_((met.size() + kChunk - 1) / kChunk, memory),
      steps_(scene.density, scene.grid, table.size()) {}

// A Row accumulates the weights of one sample: those of nodes, and those that correct for the curvature
// between nodes.
class ScatterRows::Row {
 public:
  explicit Row(const TransferGrid& grid) : grid_(grid), weights_(grid.nodes(), Entry{}) {}

  // `resolved` is 1 where a free path is at least a voxel, and 0 where it is much shorter. There T changes
  // faster than curves can follow, and only weights that are all positive keep it in range.
  void begin(double resolved) { resolved_ = resolved; }

  void add(const glm::dvec3& place, int level, double share) {
    const TransferGrid::Stencil at = grid_.stencil(place, level, /*beyond=*/resolved_ > 0.5);
    // Between two nodes at fraction f, a curve T lies below its chord by f (1 - f) / 2 T'', and a node of
    // level l, as the mean of 2^l voxels, lies above T by (1 - 4^-l) / 24 T''; T'' is measured in nodes of
    // the level.
    const glm::dvec3 bend =
        resolved_ * (0.5 * at.fraction * (1.0 - at.fraction) + (1.0 - std::ldexp(1.0, -2 * level)) / 24.0);
    for (int i = 0; i < at.count; ++i) {
      const std::uint32_t node = at.node[static_cast<std::size_t>(i)];
      Entry& entry = touch(node);
      const double weight = share * at.weight[static_cast<std::size_t>(i)];
      entry.weight += weight;
      entry.bend += weight * bend;
    }
    sum_ += share;
  }

  double sum() const { return sum_; }

  // Calls give(node, weight) by ascending nodes, and empties the row.
  template <typename Give>
  void finish(const Give& give) {
    const std::size_t touched = touched_.size();
    for (std::size_t i = 0; i < touched; ++i) {
      const std::uint32_t node = touched_[i];
      const glm::dvec3 bend = weights_[node].bend;
      for (int axis = 0; axis < 3; ++axis) {
        // At the rim, the curvature is that one node further in.
        auto [before, after] = grid_.neighbors(node, axis);
        std::int32_t middle = static_cast<std::int32_t>(node);
        if (before < 0 && after >= 0)
          middle = after;
        else if (after < 0 && before >= 0)
          middle = before;
        std::tie(before, after) = grid_.neighbors(static_cast<std::uint32_t>(middle), axis);
        if (before < 0 || after < 0) continue;
        touch(static_cast<std::uint32_t>(middle)).weight += 2.0 * bend[axis];
        touch(static_cast<std::uint32_t>(before)).weight -= bend[axis];
        touch(static_cast<std::uint32_t>(after)).weight -= bend[axis];
      }
    }
    std::sort(touched_.begin(), touched_.end());
    for (const std::uint32_t node : touched_) {
      give(node, weights_[node].weight);
      weights_[node] = Entry{};
    }
    touched_.clear();
    sum_ = 0.0;
  }

 private:
  struct Entry {
    double weight = 0.0;
    glm::dvec3 bend{0.0};
    bool touched = false;
  };
  Entry& touch(std::uint32_t node) {
    Entry& entry = weights_[node];
    if (!entry.touched) touched_.push_back(node), entry.touched = true;
    return entry;
  }

  const TransferGrid& grid_;
  std::vector<Entry> weights_;
  std::vector<std::uint32_t> touched_;
  double sum_ = 0.0, resolved_ = 1.0;
};

void ScatterRows::traceRow(const glm::vec3& origin, const SphereTable& table, std::vector<float>& reach,
                           Row& row) const {
  const glm::dvec3 grid_origin = scene_.grid.gridFromGroup(glm::dvec3(origin));
  const double thickness =
      double{scene_.density.atGrid(scene_.density.gridFromGroup(origin))} * double{scene_.grid.meanEdge()};
  row.begin(1.0 - glm::smoothstep(2.0, 4.0, thickness));
  scene_.occluders.reach(origin, table.directions(), reach);
  for (std::size_t r = 0; r < table.size(); ++r) {
    const glm::vec3& direction = table.direction(r);
    const glm::dvec3 grid_direction = scene_.grid.gridDirection(glm::dvec3(direction));
    steps_.gather(origin, direction, reach[r], [&](double t, double share) {
      row.add(grid_origin + t * grid_direction, steps_.levelAt(t), share);
    });
  }
}

ScatterRows::Chunk ScatterRows::trace(std::size_t begin, std::size_t end, std::span<double> self,
                                      std::span<double> others) const {
  Chunk chunk;
  Row row(scene_.grid);
  std::vector<float> reach(table_->size());
  chunk.begins.push_back(0);
  for (std::size_t p = begin; p < end; ++p) {
    traceRow(scene_.grid.place(p), *table_, reach, row);
    const double scale = row.sum() > 0.0 ? met_[p] / row.sum() : 0.0;
    double rest = 0.0, own = 0.0;
    row.finish([&](std::uint32_t node, double weight) {
      if (node == p) {
        own = scale * weight;
        return;
      }
      rest += scale * weight;
      chunk.nodes.push_back(node);
      chunk.weights.push_back(static_cast<float>(scale * weight));
    });
    chunk.begins.push_back(static_cast<std::uint32_t>(chunk.nodes.size()));
    if (!self.empty()) self[p] = own, others[p] = rest;
  }
  return chunk;
}

ScatterRows::Gather::Gather(const ScatterRows& rows)
    : rows_(rows), row_(std::make_unique<Row>(rows.scene_.grid)) {}
ScatterRows::Gather::~Gather() = default;

void ScatterRows::Gather::look(const glm::vec3& place, const SphereTable& table, double met,
                               std::span<const std::vector<float>> nodes, std::span<float> out) {
  reach_.resize(table.size());
  rows_.traceRow(place, table, reach_, *row_);
  const double scale = row_->sum() > 0.0 ? met / row_->sum() : 0.0;
  std::fill(out.begin(), out.end(), 0.0f);
  row_->finish([&](std::uint32_t node, double weight) {
    const auto share = static_cast<float>(scale * weight);
    for (std::size_t b = 0; b < nodes.size(); ++b)
      for (std::size_t i = 0; i < kBlockColumns; ++i)
        out[b * kBlockColumns + i] += share * nodes[b][node * kBlockColumns + i];
  });
}

std::optional<ScatterRows> ScatterRows::build(const VolumeScene& scene, const SphereTable& table,
                                              std::span<const double> met, std::uint64_t memory,
                                              const BakeContext& context) {
  ScatterRows rows(scene, table, met, memory);
  const auto fits = [&](const Chunk& chunk, std::size_t count) {
    return chunk.fits(count, scene.grid.nodes());
  };
  const auto compute = [&](std::size_t begin, std::size_t end) {
    rows.chunks_.offer(begin / kChunk, rows.trace(begin, end, rows.self_, rows.others_));
  };
  const auto done =
      runStage({.name = "scattering",
                .count = met.size(),
                .grain = kChunk,
                .writes = {rowsOf(rows.self_), rowsOf(rows.others_), rows.chunks_.output(kChunk, fits)},
                .compute = compute},
               context);
  if (!done) return std::nullopt;
  rows.samples_traced_ = done->computed;
  return rows;
}

// Returns whether the chunk has the form that trace() gives it, or is empty.
bool ScatterRows::Chunk::fits(std::size_t rows, std::size_t nodes_there) const {
  if (begins.empty()) return nodes.empty() && weights.empty();
  return begins.size() == rows + 1 && begins.front() == 0 && begins.back() == nodes.size() &&
         weights.size() == nodes.size() && std::is_sorted(begins.begin(), begins.end()) &&
         std::all_of(nodes.begin(), nodes.end(), [&](std::uint32_t node) { return node < nodes_there; });
}

bool ScatterRows::apply(std::span<float> nodes, std::span<float> out, const std::stop_token& stop) const {
  scene_.grid.raise(nodes, kBlockColumns);
  return parallelRanges(samples(), kChunk, stop, [&](std::size_t begin, std::size_t end) {
    const Chunk& kept = chunks_[begin / kChunk];
    const Chunk traced = kept.begins.empty() ? trace(begin, end, {}, {}) : Chunk{};
    const Chunk& chunk = kept.begins.empty() ? traced : kept;
    for (std::size_t p = begin; p < end; ++p) {
      float sum[kBlockColumns] = {};
      for (std::uint32_t e = chunk.begins[p - begin]; e < chunk.begins[p - begin + 1]; ++e) {
        const float weight = chunk.weights[e];
        const float* from = &nodes[chunk.nodes[e] * kBlockColumns];
        for (std::size_t i = 0; i < kBlockColumns; ++i) sum[i] += weight * from[i];
      }
      std::copy(sum, sum + kBlockColumns, &out[p * kBlockColumns]);
    }
  });
}

namespace {

constexpr std::size_t kRowsPerSum = 512;  // rows that are summed up together
using ColumnSums = std::array<double, kBlockColumns>;
using Vector = std::vector<float>;

template <typename Body>
void overRows(std::size_t rows, const Body& body) {
  parallelRanges(rows, kRowsPerSum, {}, [&](std::size_t begin, std::size_t end) { body(begin, end); });
}

ColumnSums dots(std::span<const float> a, std::span<const float> b) {
  const std::size_t rows = a.size() / kBlockColumns;
  std::vector<ColumnSums> partial((rows + kRowsPerSum - 1) / kRowsPerSum);
  overRows(rows, [&](std::size_t begin, std::size_t end) {
    ColumnSums sum{};
    for (std::size_t r = begin; r < end; ++r)
      for (std::size_t c = 0; c < kBlockColumns; ++c)
        sum[c] += double{a[r * kBlockColumns + c]} * double{b[r * kBlockColumns + c]};
    partial[begin / kRowsPerSum] = sum;
  });
  ColumnSums sum{};
  for (const ColumnSums& part : partial)
    for (std::size_t c = 0; c < kBlockColumns; ++c) sum[c] += part[c];
  return sum;
}

// Adds factor * from to `to`, column by column.
void addColumns(std::span<float> to, std::span<const float> from, const ColumnSums& factor) {
  std::array<float, kBlockColumns> f;
  for (std::size_t c = 0; c < kBlockColumns; ++c) f[c] = static_cast<float>(factor[c]);
  overRows(to.size() / kBlockColumns, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r)
      for (std::size_t c = 0; c < kBlockColumns; ++c)
        to[r * kBlockColumns + c] += f[c] * from[r * kBlockColumns + c];
  });
}

double lengthOf(const ColumnSums& squares) {
  double sum = 0.0;
  for (const double s : squares) sum += s;
  return std::sqrt(sum);
}

// Divides each column by its length; columns of length 0 become 0. Returns the lengths.
ColumnSums normalize(std::span<float> v) {
  ColumnSums length = dots(v, v), inverse;
  for (std::size_t c = 0; c < kBlockColumns; ++c) {
    length[c] = std::sqrt(length[c]);
    inverse[c] = length[c] > 1e-30 ? 1.0 / length[c] : 0.0;
  }
  std::array<float, kBlockColumns> f;
  for (std::size_t c = 0; c < kBlockColumns; ++c) f[c] = static_cast<float>(inverse[c]);
  overRows(v.size() / kBlockColumns, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r)
      for (std::size_t c = 0; c < kBlockColumns; ++c) v[r * kBlockColumns + c] *= f[c];
  });
  return length;
}

// LeastSquares is the least-squares problem of one column, solved by Givens rotations.
struct LeastSquares {
  std::vector<std::vector<double>> h;  // columns of the triangular matrix
  std::vector<double> cosine, sine, g;

  explicit LeastSquares(double length = 0.0) : g(1, length) {}
  void add(std::vector<double> column) {
    const std::size_t j = h.size();
    for (std::size_t i = 0; i < j; ++i) {
      const double a = column[i], b = column[i + 1];
      column[i] = cosine[i] * a + sine[i] * b;
      column[i + 1] = cosine[i] * b - sine[i] * a;
    }
    const double r = std::hypot(column[j], column[j + 1]);
    cosine.push_back(r > 0.0 ? column[j] / r : 1.0);
    sine.push_back(r > 0.0 ? column[j + 1] / r : 0.0);
    column[j] = r;
    g.push_back(-sine[j] * g[j]);
    g[j] *= cosine[j];
    h.push_back(std::move(column));
  }

  std::vector<double> solve() const {
    std::vector<double> y(h.size(), 0.0);
    for (std::size_t i = h.size(); i-- > 0;) {
      double sum = g[i];
      for (std::size_t j = i + 1; j < h.size(); ++j) sum -= h[j][i] * y[j];
      y[i] = h[i][i] > 1e-30 ? sum / h[i][i] : 0.0;
    }
    return y;
  }
};

}  // namespace

GmresResult solveGmres(std::span<const float> b, std::span<float> x,
                       const std::function<bool(std::span<const float>, std::span<float>)>& apply,
                       const GmresSettings& settings) {
  const std::size_t rows = b.size() / kBlockColumns;
  const double wanted = lengthOf(dots(b, b));
  if (wanted == 0.0) {
    std::fill(x.begin(), x.end(), 0.0f);
    return {};
  }
  GmresResult result;
  const auto applied = [&](std::span<const float> from, std::span<float> to) {
    ++result.iterations;
    result.stopped = !apply(from, to);
    return !result.stopped;
  };
  double before = 0.0;  // residual of the previous round; 0: none
  Vector image(b.size());
  while (true) {
    // The residual is r = b - (x - G x).
    if (!applied(x, image)) return result;
    std::vector<Vector> basis(1, Vector(b.size()));
    overRows(rows, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin * kBlockColumns; i < end * kBlockColumns; ++i)
        basis[0][i] = b[i] - x[i] + image[i];
    });
    const ColumnSums length = normalize(basis[0]);
    ColumnSums squares;
    std::array<LeastSquares, kBlockColumns> small;
    for (std::size_t c = 0; c < kBlockColumns; ++c)
      small[c] = LeastSquares(length[c]), squares[c] = length[c] * length[c];
    result.residual = lengthOf(squares) / wanted;
    // Rounding sets a floor: a residual that a whole round hardly improves will not get better.
    const bool stuck = before > 0.0 && result.residual > 0.7 * before && result.residual < 1e-3;
    if (result.residual <= settings.tolerance || result.iterations >= settings.most_iterations || stuck)
      return result;
    before = result.residual;

    for (int j = 0; j < settings.restart && result.iterations < settings.most_iterations; ++j) {
      const Vector& v = basis.back();
      if (!applied(v, image)) return result;
      Vector next(b.size());
      overRows(rows, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin * kBlockColumns; i < end * kBlockColumns; ++i) next[i] = v[i] - image[i];
      });
      std::array<std::vector<double>, kBlockColumns> column;
      for (const Vector& earlier : basis) {
        ColumnSums h = dots(next, earlier);
        for (std::size_t c = 0; c < kBlockColumns; ++c) column[c].push_back(h[c]), h[c] = -h[c];
        addColumns(next, earlier, h);
      }
      const ColumnSums last = normalize(next);
      double left = 0.0;
      for (std::size_t c = 0; c < kBlockColumns; ++c) {
        column[c].push_back(last[c]);
        small[c].add(std::move(column[c]));
        left += small[c].g.back() * small[c].g.back();
      }
      basis.push_back(std::move(next));
      if (std::sqrt(left) <= settings.tolerance * wanted) break;
    }
    std::array<std::vector<double>, kBlockColumns> y;
    for (std::size_t c = 0; c < kBlockColumns; ++c) y[c] = small[c].solve();
    for (std::size_t j = 0; j < y[0].size(); ++j) {
      ColumnSums factor;
      for (std::size_t c = 0; c < kBlockColumns; ++c) factor[c] = y[c][j];
      addColumns(x, basis[j], factor);
    }
  }
}

void write(const SolvedBlock& block, ByteWriter& out) {
  out.add(block.result.iterations), out.add(block.result.residual);
  out.addList(std::span<const float>(block.x));
}

bool read(ByteReader& in, SolvedBlock& block) {
  return in.read(block.result.iterations) && in.read(block.result.residual) && in.readInto(block.x);
}

}  // namespace lambent::baker
