#include "baker/effects/volume/scattering.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/IterativeLinearSolvers>

#include "baker/cache/key.hpp"
#include "baker/jobs/parallel.hpp"
#include "baker/jobs/stage.hpp"

namespace lambent::baker {

std::optional<FirstLights> lightIn(const VolumeScene& scene, const SphereTable& table, std::size_t outputs,
                                   const BakeContext& context) {
  const std::size_t samples = scene.grid.samples(), columns = table.harmonics(0).size();
  const bool phased = outputs > 1;
  FirstLights light{.transfer = std::vector<float>(samples * columns),
                    .clear = std::vector<float>(phased ? samples * outputs : 0),
                    .met = std::vector<double>(samples),
                    .out = std::vector<double>(samples)};
  const auto compute = [&](std::size_t begin, std::size_t end) {
    FirstLight first(scene.density, scene.occluders);
    for (std::size_t p = begin; p < end; ++p) {
      const auto transfer = std::span(light.transfer).subspan(p * columns, columns);
      const auto clear = phased ? std::span(light.clear).subspan(p * outputs, outputs) : std::span<float>();
      const Arrival arrival = first.look(scene.grid.place(p), table, transfer, clear);
      light.met[p] = arrival.met;
      light.out[p] = arrival.out;
    }
  };
  std::vector<Output> writes = {rowsOf(light.transfer, columns)};
  if (phased)
    writes.push_back(rowsOf(light.clear, outputs));
  else
    writes.insert(writes.end(), {rowsOf(light.met), rowsOf(light.out)});
  const auto done = runStage({.name = "light into volumes",
                              .count = samples,
                              .grain = kSamplesPerLight,
                              .writes = std::move(writes),
                              .compute = compute},
                             context);
  if (!done) return std::nullopt;
  light.samples_traced = done->computed;
  return light;
}

namespace {

// Solves linear systems x = G x + b for many right-hand sides at once, each column by itself, by restarted
// GMRES (Saad and Schultz 1986). Rows are unknowns, with kBlockColumns columns side by side. Sums run in a
// fixed order, so the result is the same for any number of threads.

constexpr double kTolerance = 1e-5;   // on the residual relative to b, RMS over all columns
constexpr int kMostIterations = 400;  // applications of G
constexpr std::size_t kRowsPerRange = 64;

struct GmresResult {
  int iterations = 0;
  double residual = 0.0;  // relative, when the solver ended
  bool stopped = false;
};

// A SolvedBlock is a block of columns with its solution. It is kept as soon as it is solved, since the next
// block may take long, too.
struct SolvedBlock {
  GmresResult result;
  std::span<float> x;
};

void write(const SolvedBlock& block, ByteWriter& out) {
  out.add(block.result.iterations), out.add(block.result.residual);
  out.addList(std::span<const float>(block.x));
}

bool read(ByteReader& in, SolvedBlock& block) {
  return in.read(block.result.iterations) && in.read(block.result.residual) && in.readInto(block.x);
}

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

// apply(x, y) computes y = G x and returns false if stopped. `x` is the first guess on entry and the solution
// on return.
GmresResult solveGmres(std::span<const float> b, std::span<float> x,
                       const std::function<bool(std::span<const float>, std::span<float>)>& apply,
                       int restart) {
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
    if (result.residual <= kTolerance || result.iterations >= kMostIterations || stuck) return result;
    before = result.residual;

    for (int j = 0; j < restart && result.iterations < kMostIterations; ++j) {
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
      if (std::sqrt(left) <= kTolerance * wanted) break;
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

// Solves the system for an albedo.
class Scattering {
 public:
  Scattering(const ScatteringSystem& system, double albedo)
      : system_(system), albedo_(albedo), rows_(system.rows(albedo)) {}

  GmresResult solve(std::span<const float> first, std::span<float> result) const {
    std::vector<float> right(first.size());
    for (std::size_t i = 0; i < first.size(); ++i)
      right[i] = static_cast<float>(double{first[i]} * rows_[i / kBlockColumns].scale);
    std::copy(right.begin(), right.end(), result.begin());
    const auto apply = [&](std::span<const float> x, std::span<float> y) {
      if (!system_.apply(x, y)) return false;
      parallelRanges(rows_.size(), kRowsPerRange, {}, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin * kBlockColumns; i < end * kBlockColumns; ++i) {
          const ScatteringSystem::Row& row = rows_[i / kBlockColumns];
          y[i] = static_cast<float>(albedo_ * row.scale * (double{y[i]} + row.rest * double{x[i]}));
        }
      });
      return true;
    };
    return solveGmres(right, result, apply, system_.kept_vectors);
  }

  // Computes so many scatterings one after the other.
  GmresResult repeat(std::span<const float> first, std::span<float> result, int times) const {
    std::copy(first.begin(), first.end(), result.begin());
    std::vector<float> others(first.size());
    for (int k = 0; k < times; ++k) {
      if (!system_.apply(result, others)) return {k, 0.0, true};
      for (std::size_t i = 0; i < first.size(); ++i)
        result[i] = static_cast<float>(
            double{first[i]} +
            albedo_ * (rows_[i / kBlockColumns].stays * double{result[i]} + double{others[i]}));
    }
    return {times, 0.0, false};
  }

 private:
  const ScatteringSystem& system_;
  double albedo_;
  std::vector<ScatteringSystem::Row> rows_;
};

}  // namespace

bool scatterLight(const ScatteringSystem& system, const VolumeSettings& settings, VolumeTransfer& out,
                  const BakeContext& context) {
  context.progress.begin("scattered light", out.columns() * out.full_channels, "columns");
  const std::size_t columns = out.columns(), block_size = out.outputs() * columns,
                    rows = out.grid.samples() * out.outputs();
  // A row is one output of a sample; this returns where its columns start in the vectors.
  const auto at = [&](std::size_t row, std::size_t block) {
    return &out.vectors[row / out.outputs() * out.vectorSize() + block * block_size +
                        row % out.outputs() * columns];
  };
  std::vector<float> first(rows * kBlockColumns), result(first.size());
  for (std::size_t begin = 0; begin < columns; begin += kBlockColumns) {
    const std::size_t width = std::min(kBlockColumns, columns - begin);
    std::fill(first.begin(), first.end(), 0.0f);
    for (std::size_t row = 0; row < rows; ++row)
      std::copy_n(at(row, 0) + begin, width, &first[row * kBlockColumns]);
    for (std::uint32_t channel = 0; channel < out.full_channels; ++channel) {
      const Scattering scattering(system,
                                  std::min(double{out.albedo[static_cast<int>(channel)]}, kLargestAlbedo));
      SolvedBlock solved{{}, result};
      const auto found = findOrMake(context.part("block", begin, channel).part("solved"), solved, [&] {
        solved.result = settings.scatterings < 0 ? scattering.solve(first, result)
                                                 : scattering.repeat(first, result, settings.scatterings);
        return !solved.result.stopped;
      });
      if (!found) return false;
      out.iterations = std::max(out.iterations, solved.result.iterations);
      out.residual = std::max(out.residual, solved.result.residual);
      for (std::size_t row = 0; row < rows; ++row)
        std::copy_n(&result[row * kBlockColumns], width, at(row, 1 + channel) + begin);
      context.progress.add(width);
    }
  }
  return true;
}

namespace {

// This is h relative to a typical voxel's weight: a few places at a voxel's rim do not move it far.
constexpr double kHold = 0.01;
constexpr int kMostSteps = 200;
constexpr double kFitTolerance = 1e-6;  // relative residual

}  // namespace

GridFit::GridFit(const TransferGrid& grid, std::size_t width, std::span<const float> samples)
    : grid_(grid), width_(width), samples_(samples) {
  constexpr int kAround = 27;  // a voxel shares places with those at most one step away along each axis
  const auto count = static_cast<Eigen::Index>(grid.samples());
  matrix_.resize(count, count);
  matrix_.reserve(Eigen::VectorXi::Constant(count, kAround));
  right_ = Eigen::MatrixXd::Zero(count, static_cast<Eigen::Index>(width));
}

void GridFit::add(const glm::vec3& place, double weight, std::span<const float> wanted) {
  const TransferGrid::Stencil at = grid_.stencil(grid_.gridFromGroup(glm::dvec3(place)), /*level=*/0);
  if (at.count == 0 || !(weight > 0.0)) return;
  const auto count = static_cast<std::size_t>(at.count);
  for (std::size_t c = 0; c < width_; ++c) {
    float lacks = wanted[c];
    for (std::size_t k = 0; k < count; ++k)
      lacks -= static_cast<float>(at.weight[k]) * samples_[at.node[k] * width_ + c];
    for (std::size_t k = 0; k < count; ++k)
      right_(at.node[k], static_cast<Eigen::Index>(c)) += weight * at.weight[k] * double{lacks};
  }
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t m = 0; m < count; ++m)
      matrix_.coeffRef(at.node[k], at.node[m]) += weight * at.weight[k] * at.weight[m];
}

std::vector<float> GridFit::solve() const {
  // The typical weight is the mean of the diagonal weighted by itself, since most voxels are dark or in thin
  // air.
  const Eigen::VectorXd diagonal = matrix_.diagonal();
  std::vector<float> out(samples_.size(), 0.0f);
  if (!(diagonal.squaredNorm() > 0.0)) return out;
  Eigen::SparseMatrix<double, Eigen::RowMajor> hold(matrix_.rows(), matrix_.cols());
  hold.setIdentity();
  hold *= kHold * diagonal.squaredNorm() / diagonal.sum();
  const Eigen::SparseMatrix<double, Eigen::RowMajor> held = matrix_ + hold;
  parallelRanges(width_, 1, {}, [&](std::size_t begin, std::size_t end) {
    Eigen::ConjugateGradient<Eigen::SparseMatrix<double, Eigen::RowMajor>, Eigen::Lower | Eigen::Upper>
        solver(held);
    solver.setMaxIterations(kMostSteps).setTolerance(kFitTolerance);
    for (std::size_t c = begin; c < end; ++c) {
      const Eigen::VectorXd change = solver.solve(right_.col(static_cast<Eigen::Index>(c)));
      for (Eigen::Index q = 0; q < change.size(); ++q)
        out[static_cast<std::size_t>(q) * width_ + c] = static_cast<float>(change(q));
    }
  });
  return out;
}

}  // namespace lambent::baker
