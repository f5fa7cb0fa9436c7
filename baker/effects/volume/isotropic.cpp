// Computes one more scattering in a medium with an isotropic phase function: the mean radiance that arrives
// at each sample after one scattering is a weighted sum of what arrived at all samples before it,
//   T^k(p) = sum_q w k_pq T^{k-1}(q),
// where w is the albedo and k_pq comes from rays of p that pass near q:
//   T^k(p) = (1/4pi) int ds int sigma(x_t) tau(p, x_t) w T^{k-1}(x_t) dt      (literature 1.8)
// with T linear between the samples. A stretch of a ray of optical depth e scatters tau (1 - exp(-e)), so
// that all stretches and the rest sum to one whatever their lengths: under uniform light a medium without
// absorption is invisible. Rays diverge, so far away they read coarser levels of the grid, with voxels as
// large as the distance between rays.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <tuple>

#include <glm/gtc/quaternion.hpp>

#include "baker/effects/volume/scattering.hpp"
#include "baker/jobs/parallel.hpp"
#include "baker/jobs/stage.hpp"

namespace lambent::baker {

namespace {

// A Row accumulates the weights of one sample: those of nodes, and those that correct for the curvature
// between nodes.
class Row {
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

// A Chunk holds the rows of some samples.
struct Chunk {
  std::vector<std::uint32_t> begins, nodes;
  std::vector<float> weights;
  std::uint64_t bytes() const { return 4 * (begins.size() + nodes.size() + weights.size()); }
  void shrink() { nodes.shrink_to_fit(), weights.shrink_to_fit(); }
  // Returns whether the chunk has the form that trace() gives it, or is empty.
  bool fits(std::size_t rows, std::size_t nodes_there) const {
    if (begins.empty()) return nodes.empty() && weights.empty();
    return begins.size() == rows + 1 && begins.front() == 0 && begins.back() == nodes.size() &&
           weights.size() == nodes.size() && std::is_sorted(begins.begin(), begins.end()) &&
           std::all_of(nodes.begin(), nodes.end(), [&](std::uint32_t node) { return node < nodes_there; });
  }
  friend void write(const Chunk& chunk, ByteWriter& out) {
    out.addList(chunk.begins), out.addList(chunk.nodes), out.addList(chunk.weights);
  }
  friend bool read(ByteReader& in, Chunk& chunk) {
    return in.readList(chunk.begins) && in.readList(chunk.nodes) && in.readList(chunk.weights);
  }
};

class ScatterRows {
 public:
  // `met` has for each sample the mean share of a ray that the medium takes before the ray reaches the
  // outside or a surface; rows sum to it. Rows are kept in at most `memory` bytes; those that do not fit are
  // traced again each time, with the same result. All must outlive this.
  ScatterRows(const VolumeScene& scene, const SphereTable& table, std::span<const double> met,
              std::uint64_t memory)
      : scene_(scene),
        table_(table),
        met_(met),
        self_(met.size()),
        others_(met.size()),
        chunks_((met.size() + kSamplesPerChunk - 1) / kSamplesPerChunk, memory),
        steps_(scene.density, scene.grid, table.size()) {}

  // Traces all rows. Returns the figures of the samples, or nothing if stopped.
  std::optional<StageFigures> trace(const BakeContext& context) {
    const auto fits = [&](const Chunk& chunk, std::size_t count) {
      return chunk.fits(count, scene_.grid.nodes());
    };
    const auto compute = [&](std::size_t begin, std::size_t end) {
      chunks_.offer(begin / kSamplesPerChunk, trace(begin, end, self_, others_));
    };
    return runStage({.name = "scattering",
                     .count = met_.size(),
                     .grain = kSamplesPerChunk,
                     .writes = {rowsOf(self_), rowsOf(others_), chunks_.output(kSamplesPerChunk, fits)},
                     .compute = compute},
                    context);
  }

  const TransferGrid& grid() const { return scene_.grid; }
  // Returns k_pp of a sample, or the sum of its other weights.
  double self(std::size_t p) const { return self_[p]; }
  double others(std::size_t p) const { return others_[p]; }
  std::uint64_t bytes() const { return chunks_.bytes(); }

  // Computes out_p = sum over q != p of k_pq x_q. `nodes` is [grid.nodes()][kBlockColumns], samples first;
  // its upper levels are filled in here. Returns false if stopped.
  bool apply(std::span<float> nodes, std::span<float> out, const std::stop_token& stop) const {
    scene_.grid.raise(nodes, kBlockColumns);
    return parallelRanges(met_.size(), kSamplesPerChunk, stop, [&](std::size_t begin, std::size_t end) {
      const Chunk& kept = chunks_[begin / kSamplesPerChunk];
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

  // Traces the rays of a table from any place. `reach` is scratch memory.
  void traceRow(const glm::vec3& origin, const SphereTable& table, std::vector<float>& reach,
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

 private:
  // Traces the rows of some samples. If `self` and `others` are not empty, stores their sums there.
  Chunk trace(std::size_t begin, std::size_t end, std::span<double> self, std::span<double> others) const {
    Chunk chunk;
    Row row(scene_.grid);
    std::vector<float> reach(table_.size());
    chunk.begins.push_back(0);
    for (std::size_t p = begin; p < end; ++p) {
      traceRow(scene_.grid.place(p), table_, reach, row);
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

  const VolumeScene& scene_;
  const SphereTable& table_;
  std::span<const double> met_;
  std::vector<double> self_, others_;
  KeptChunks<Chunk> chunks_;
  RaySteps steps_;
};

// A Gather computes scattered light at places that are no samples. One object serves one thread.
class Gather {
 public:
  explicit Gather(const ScatterRows& rows) : rows_(rows), row_(rows.grid()) {}

  // Computes one scattering: the light that comes along the table's rays, of which the medium takes the share
  // `met`. `nodes` holds blocks of columns as for ScatterRows::apply(), with their upper levels filled in
  // (TransferGrid::raise); `out` has one block after the other.
  void look(const glm::vec3& place, const SphereTable& table, double met,
            std::span<const std::vector<float>> nodes, std::span<float> out) {
    reach_.resize(table.size());
    rows_.traceRow(place, table, reach_, row_);
    const double scale = row_.sum() > 0.0 ? met / row_.sum() : 0.0;
    std::fill(out.begin(), out.end(), 0.0f);
    row_.finish([&](std::uint32_t node, double weight) {
      const auto share = static_cast<float>(scale * weight);
      for (std::size_t b = 0; b < nodes.size(); ++b)
        for (std::size_t i = 0; i < kBlockColumns; ++i)
          out[b * kBlockColumns + i] += share * nodes[b][node * kBlockColumns + i];
    });
  }

 private:
  const ScatterRows& rows_;
  Row row_;
  std::vector<float> reach_;
};

// Fits a transfer grid that is too coarse for its medium. Where a free path is shorter than a voxel, light
// changes within the voxel, most of all at the border of the medium, which is the part that one sees; voxel
// centres miss that, and pictures come out too dark. So light is computed at eight more places per voxel,
// with an eighth of the rays each, rotated from place to place: light that comes in from outside, and one
// scattering of the solver's result. Samples then become the values that interpolate best to it, weighted by
// how much of it leaves the medium: density times the mean transmittance to the outside
// (GridFit).

constexpr std::size_t kPlacesPerVoxel = 8;
constexpr std::size_t kLeastRays = 16;
constexpr float kThin = 0.25f;  // optical depth of a voxel whose centre is accurate enough
constexpr std::size_t kPlacesPerRange = 64;
constexpr std::size_t kTogether = 1u << 13;  // places whose light is kept at a time

struct Place {
  glm::vec3 point{0.0f};  // group frame
  float density = 0.0f;
};

// Returns a point in [0, 1)³: the fractions of n divided by powers of the root of x^4 = x + 1, which are
// evenly spread in three dimensions (Roberts 2018).
glm::dvec3 spread(std::size_t n) {
  constexpr double kRoot = 1.2207440846057596;
  const double k = static_cast<double>(n) + 0.5;
  return glm::fract(k * glm::dvec3(1.0 / kRoot, 1.0 / (kRoot * kRoot), 1.0 / (kRoot * kRoot * kRoot)));
}

// Returns one place with density in each eighth of each voxel that is not thin.
std::vector<Place> placesIn(const DensityField& density, const TransferGrid& grid) {
  std::vector<Place> out;
  const glm::dvec3 scale = glm::dvec3(density.size()) / glm::dvec3(grid.size());
  for (std::size_t q = 0; q < grid.samples(); ++q) {
    const std::uint32_t v = grid.voxels()[q];
    const glm::uvec3& n = grid.size();
    const glm::dvec3 corner(v % n.x, v / n.x % n.y, v / (n.x * n.y));
    const std::size_t first = out.size();
    float most = 0.0f;
    for (std::size_t k = 0; k < kPlacesPerVoxel; ++k) {
      const glm::dvec3 eighth(k & 1, k >> 1 & 1, k >> 2);
      const glm::vec3 at(scale * (corner + 0.5 * (eighth + spread(q * kPlacesPerVoxel + k))));
      const float here = density.atGrid(at);
      if (!(here > 0.0f)) continue;
      out.push_back({glm::vec3(density.groupFromGrid() * glm::vec4(at, 1.0f)), here});
      most = std::max(most, here);
    }
    if (most * grid.meanEdge() <= kThin) out.resize(first);
  }
  return out;
}

// Makes tables of few rays, rotated against each other, so that together a voxel's places look in all
// directions.
std::vector<SphereTable> turnedTables(std::size_t rays, int order) {
  std::vector<SphereTable> out;
  for (std::size_t k = 0; k < kPlacesPerVoxel; ++k) {
    const glm::dvec3 at = spread(k);
    const double z = 2.0 * at.x - 1.0, phi = 2.0 * std::numbers::pi * at.y;
    const double across = std::sqrt(1.0 - z * z);
    const glm::dvec3 axis(across * std::cos(phi), across * std::sin(phi), z);
    out.emplace_back(std::max(kLeastRays, rays / kPlacesPerVoxel), order,
                     glm::angleAxis(2.0 * std::numbers::pi * at.z, axis));
  }
  return out;
}

// Returns all scatterings at the nodes, in blocks of columns, one channel after the other.
std::vector<std::vector<float>> blocksOf(const VolumeTransfer& transfer) {
  std::vector<std::vector<float>> out;
  const std::size_t columns = transfer.columns(), width = transfer.vectorSize();
  for (std::uint32_t channel = 0; channel < transfer.full_channels; ++channel)
    for (std::size_t first = 0; first < columns; first += kBlockColumns) {
      auto& block = out.emplace_back(transfer.grid.nodes() * kBlockColumns, 0.0f);
      for (std::size_t q = 0; q < transfer.grid.samples(); ++q)
        std::copy_n(&transfer.vectors[q * width + (1 + channel) * columns + first],
                    std::min(kBlockColumns, columns - first), &block[q * kBlockColumns]);
      transfer.grid.raise(block, kBlockColumns);
    }
  return out;
}

// Changes the vectors of `out`, which must have one output. `rows` is null if there is only single
// scattering. Voxels whose optical depth is at most 0.25 at all of their places are left out. Returns false
// if stopped.
bool fitWithinVoxels(const Medium& medium, const VolumeSettings& settings, const Occluders& occluders,
                     const ScatterRows* rows, VolumeTransfer& out, const BakeContext& context) {
  const std::vector<Place> places = placesIn(*medium.density, out.grid);
  if (places.empty()) return true;
  context.progress.begin("light within voxels", places.size(), "places");
  const std::size_t columns = out.columns(), width = out.vectorSize();
  const std::size_t blocks = (columns + kBlockColumns - 1) / kBlockColumns;
  const std::vector<SphereTable> many = turnedTables(settings.rays, settings.order),
                                 few = turnedTables(settings.rays / kRaysPerScatteringRay, 1);
  const std::vector<std::vector<float>> nodes = blocksOf(out);
  GridFit fit(out.grid, width, out.vectors);
  std::vector<float> values(kTogether * width);
  std::vector<double> weights(kTogether);
  std::size_t traced = 0;
  for (std::size_t start = 0; start < places.size(); start += kTogether) {
    const std::size_t count = std::min(kTogether, places.size() - start);
    const auto compute = [&](std::size_t begin, std::size_t end) {
      FirstLight first(*medium.density, occluders);
      std::optional<Gather> gather;
      if (rows != nullptr) gather.emplace(*rows);
      std::vector<float> scattered(nodes.size() * kBlockColumns);
      for (std::size_t k = begin; k < end; ++k) {
        const Place& place = places[start + k];
        const std::size_t table = (start + k) % kPlacesPerVoxel;
        const std::span<float> value = std::span(values).subspan(k * width, width);
        const Arrival arrival = first.look(place.point, many[table], value.first(columns));
        weights[k] = double{place.density} * arrival.out;
        if (gather) gather->look(place.point, few[table], arrival.met, nodes, scattered);
        for (std::uint32_t channel = 0; channel < out.full_channels; ++channel) {
          const double albedo = std::min(double{out.albedo[static_cast<int>(channel)]}, kLargestAlbedo);
          for (std::size_t i = 0; i < columns; ++i)
            value[(1 + channel) * columns + i] = static_cast<float>(
                double{value[i]} + albedo * double{scattered[channel * blocks * kBlockColumns + i]});
        }
      }
    };
    const auto done = runStage({.count = count,
                                .grain = kPlacesPerRange,
                                .writes = {rowsOf(values, width), rowsOf(weights)},
                                .compute = compute},
                               context.part("places", start));
    if (!done) return false;
    traced += done->computed;
    for (std::size_t k = 0; k < count; ++k)
      fit.add(places[start + k].point, weights[k], std::span(values).subspan(k * width, width));
  }
  const std::uint64_t rays = many.front().size() + (rows != nullptr ? few.front().size() : 0);
  out.rays += traced * rays;
  out.rays_kept += (places.size() - traced) * rays;
  const std::vector<float> change = fit.solve();
  for (std::size_t i = 0; i < change.size(); ++i) out.vectors[i] += change[i];
  return true;
}

}  // namespace

void dropWithinVoxels(const BakeContext& context, const DensityField& density, const TransferGrid& grid) {
  const std::size_t places = placesIn(density, grid).size();
  for (std::size_t start = 0; start < places; start += kTogether)
    dropStage(context.part("places", start), std::min(kTogether, places - start), kPlacesPerRange);
}

bool bakeIsotropicTransfer(const Medium& medium, const VolumeSettings& settings, const Occluders& occluders,
                           VolumeTransfer& out, const BakeContext& context) {
  const std::size_t samples = out.grid.samples(), columns = out.columns();
  const VolumeScene scene{*medium.density, out.grid, occluders};
  const SphereTable table(settings.rays, settings.order);
  const auto light = lightIn(scene, table, /*outputs=*/1, context.part("light"));
  if (!light) return false;
  out.rays = light->samples_traced * table.size();
  out.rays_kept = samples * table.size() - out.rays;
  for (std::size_t p = 0; p < samples; ++p)
    std::copy_n(&light->transfer[p * columns], columns, &out.vectors[p * out.vectorSize()]);
  const auto fit = [&](const ScatterRows* rows) {
    return !settings.fit_within_voxels ||
           fitWithinVoxels(medium, settings, occluders, rows, out, context.part("within voxels"));
  };
  if (out.full_channels == 0) return fit(nullptr);

  const SphereTable few(std::max(kLeastScatteringRays, settings.rays / kRaysPerScatteringRay), 1);
  ScatterRows rows(scene, few, light->met, settings.memory);
  const auto traced = rows.trace(context.part("rows"));
  if (!traced) return false;
  out.rays += traced->computed * few.size();
  out.rays_kept += traced->found * few.size();
  out.row_bytes = rows.bytes();
  std::vector<float> nodes(out.grid.nodes() * kBlockColumns);
  const auto apply = [&](std::span<const float> x, std::span<float> y) {
    std::copy(x.begin(), x.end(), nodes.begin());
    return rows.apply(nodes, y, context.stop);
  };
  const auto rows_of = [&](double albedo) {
    std::vector<ScatteringSystem::Row> own;
    for (std::size_t p = 0; p < samples; ++p) {
      // This computes 1 - w k_pp without subtracting two numbers near 1.
      const double kept = 1.0 - albedo + albedo * (rows.others(p) + light->out[p]);
      own.push_back({.scale = kept > 1e-30 ? 1.0 / kept : 0.0, .rest = 0.0, .stays = rows.self(p)});
    }
    return own;
  };
  return scatterLight({.apply = apply, .rows = rows_of, .kept_vectors = kMostKeptVectors}, settings, out,
                      context) &&
         fit(&rows);
}

}  // namespace lambent::baker
