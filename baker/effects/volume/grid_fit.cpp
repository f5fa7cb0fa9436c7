#include "baker/effects/volume/grid_fit.hpp"

#include <cmath>

#include <glm/vector_relational.hpp>

#include "baker/jobs/parallel.hpp"

namespace lambent::baker {

namespace {

// This is h relative to a typical voxel's weight: a few places at a voxel's rim do not move it far.
constexpr double kHold = 0.01;
constexpr int kMostSteps = 200;
constexpr double kFitTolerance = 1e-5;  // relative residual

}  // namespace

GridFit::GridFit(const TransferGrid& grid, std::size_t width, std::span<const float> samples)
    : grid_(grid),
      width_(width),
      samples_(samples),
      matrix_(grid.samples()),
      columns_(grid.samples()),
      right_(grid.samples() * width),
      lacks_(width) {
  const glm::uvec3& size = grid.size();
  std::vector<std::int32_t> sample_of(std::size_t{size.x} * size.y * size.z, -1);
  for (std::size_t q = 0; q < grid.samples(); ++q) sample_of[grid.voxels()[q]] = static_cast<std::int32_t>(q);
  for (std::size_t q = 0; q < grid.samples(); ++q) {
    matrix_[q].fill(0.0);
    columns_[q].fill(static_cast<std::uint32_t>(q));
    const glm::ivec3 at = voxelOf(q);
    for (int k = 0; k < static_cast<int>(kAround); ++k) {
      const glm::ivec3 step(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1), other = at + step;
      if (glm::any(glm::lessThan(other, glm::ivec3(0))) ||
          glm::any(glm::greaterThanEqual(other, glm::ivec3(size))))
        continue;
      const std::int32_t r =
          sample_of[static_cast<std::size_t>(other.x) +
                    std::size_t{size.x} * (static_cast<std::size_t>(other.y) +
                                           std::size_t{size.y} * static_cast<std::size_t>(other.z))];
      if (r >= 0) columns_[q][slotOf(step)] = static_cast<std::uint32_t>(r);
    }
  }
}

glm::ivec3 GridFit::voxelOf(std::size_t sample) const {
  const std::uint32_t v = grid_.voxels()[sample];
  const glm::uvec3& size = grid_.size();
  return {v % size.x, v / size.x % size.y, v / (size.x * size.y)};
}

void GridFit::add(const glm::vec3& place, double weight, std::span<const float> wanted) {
  const TransferGrid::Stencil at = grid_.stencil(grid_.gridFromGroup(glm::dvec3(place)), /*level=*/0);
  if (at.count == 0 || !(weight > 0.0)) return;
  std::array<glm::ivec3, 8> voxels;
  const auto count = static_cast<std::size_t>(at.count);
  for (std::size_t c = 0; c < width_; ++c) lacks_[c] = wanted[c];
  for (std::size_t k = 0; k < count; ++k) {
    voxels[k] = voxelOf(at.node[k]);
    for (std::size_t c = 0; c < width_; ++c)
      lacks_[c] -= static_cast<float>(at.weight[k]) * samples_[at.node[k] * width_ + c];
  }
  for (std::size_t k = 0; k < count; ++k) {
    const double share = weight * at.weight[k];
    for (std::size_t m = 0; m < count; ++m)
      matrix_[at.node[k]][slotOf(voxels[m] - voxels[k])] += share * at.weight[m];
    for (std::size_t c = 0; c < width_; ++c) right_[at.node[k] * width_ + c] += share * double{lacks_[c]};
  }
}

std::vector<float> GridFit::solve() const {
  // The typical weight is the mean of the diagonal weighted by itself, since most voxels are dark or in thin
  // air.
  double sum = 0.0, square = 0.0;
  for (const auto& row : matrix_) sum += row[kAround / 2], square += row[kAround / 2] * row[kAround / 2];
  std::vector<float> out(samples_.size(), 0.0f);
  if (!(square > 0.0)) return out;
  const double hold = kHold * square / sum;
  parallelRanges(width_, 1, {}, [&](std::size_t begin, std::size_t end) {
    for (std::size_t column = begin; column < end; ++column) solveColumn(column, hold, out);
  });
  return out;
}

// Runs conjugate gradients, scaled by the diagonal.
void GridFit::solveColumn(std::size_t column, double hold, std::vector<float>& out) const {
  const std::size_t n = matrix_.size();
  std::vector<double> x(n, 0.0), rest(n), along(n), image(n);
  const auto scaled = [&](std::size_t q) { return rest[q] / (matrix_[q][kAround / 2] + hold); };
  double size = 0.0;
  for (std::size_t q = 0; q < n; ++q) {
    rest[q] = right_[q * width_ + column];
    along[q] = scaled(q);
    size += rest[q] * along[q];
  }
  const double enough = kFitTolerance * kFitTolerance * size;
  for (int step = 0; step < kMostSteps && size > enough; ++step) {
    double bend = 0.0;
    for (std::size_t q = 0; q < n; ++q) {
      double sum = hold * along[q];
      for (std::size_t k = 0; k < kAround; ++k) sum += matrix_[q][k] * along[columns_[q][k]];
      image[q] = sum;
      bend += along[q] * sum;
    }
    const double far = size / bend;
    double left = 0.0;
    for (std::size_t q = 0; q < n; ++q) {
      x[q] += far * along[q];
      rest[q] -= far * image[q];
      left += rest[q] * scaled(q);
    }
    for (std::size_t q = 0; q < n; ++q) along[q] = scaled(q) + left / size * along[q];
    size = left;
  }
  for (std::size_t q = 0; q < n; ++q) out[q * width_ + column] = static_cast<float>(x[q]);
}

}  // namespace lambent::baker
