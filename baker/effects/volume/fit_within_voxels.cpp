#include "baker/effects/volume/fit_within_voxels.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/gtc/quaternion.hpp>
#include <glm/vector_relational.hpp>

#include "baker/effects/volume/volume_rays.hpp"
#include "baker/jobs/parallel.hpp"
#include "baker/jobs/stage.hpp"

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

namespace {

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

}  // namespace

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
      std::optional<ScatterRows::Gather> gather;
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

void dropWithinVoxels(const BakeContext& context, const DensityField& density, const TransferGrid& grid) {
  const std::size_t places = placesIn(density, grid).size();
  for (std::size_t start = 0; start < places; start += kTogether)
    dropStage(context.part("places", start), std::min(kTogether, places - start), kPlacesPerRange);
}

}  // namespace lambent::baker
