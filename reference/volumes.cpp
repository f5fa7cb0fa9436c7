#include "reference/volumes.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace lambent::baker::reference {

GridMedium::GridMedium(const SceneVolume& volume, const glm::dmat4& world_from_grid)
    : volume_(&volume), density_(volume.density), size_(volume.size), last_(volume.size - glm::uvec3(1)) {
  const glm::dmat4 inverse = glm::inverse(world_from_grid);
  linear_ = glm::dmat3(inverse);
  shift_ = glm::dvec3(inverse[3]);
  boundDensity(glm::dmat3(world_from_grid));
  blocks_ = (glm::ivec3(size_) + (kBlock - 1)) / kBlock;
  // Points of a block lie between centres of its own voxels and of the adjacent ones.
  for (int z = 0; z < blocks_.z; ++z)
    for (int y = 0; y < blocks_.y; ++y)
      for (int x = 0; x < blocks_.x; ++x) {
        const glm::ivec3 first = kBlock * glm::ivec3(x, y, z);
        const glm::uvec3 from(glm::max(first - 1, glm::ivec3(0)));
        const glm::uvec3 to(glm::min(first + kBlock, glm::ivec3(size_) - 1));
        float least = std::numeric_limits<float>::infinity(), most = 0.0f;
        for (std::uint32_t k = from.z; k <= to.z; ++k)
          for (std::uint32_t j = from.y; j <= to.y; ++j) {
            const float* row = density_.data() + volume.index(0, j, k);
            for (std::uint32_t i = from.x; i <= to.x; ++i) {
              least = std::min(least, row[i]);
              most = std::max(most, row[i]);
            }
          }
        most_ = std::max(most_, most);
        // The bounds are widened for rounding errors of the interpolation.
        bounds_.emplace_back(least * (1.0f - 1e-6f), most * (1.0f + 1e-6f));
      }
}

void GridMedium::boundDensity(const glm::dmat3& world_from_grid) {
  // Tracking takes as many steps through a block as its densest voxel has mean free paths. A voxel with so
  // many lets no light through, and more of them would change nothing but the time.
  constexpr double kMostFreePaths = 256.0;
  const double voxel_m = std::min(
      {glm::length(world_from_grid[0]), glm::length(world_from_grid[1]), glm::length(world_from_grid[2])});
  const auto most =
      static_cast<float>(std::min(kMostFreePaths / voxel_m, double{std::numeric_limits<float>::max()}));
  if (std::ranges::none_of(density_, [&](float density) { return density > most; })) return;
  densest_ = most;
  bounded_.assign(density_.begin(), density_.end());
  for (float& density : bounded_) density = std::min(density, most);
  density_ = bounded_;
}

std::optional<GridRay> GridMedium::clipped(const Ray& ray, double begin, double end) const {
  GridRay out{.origin = linear_ * glm::dvec3(ray.origin) + shift_,
              .dir = linear_ * glm::dvec3(ray.dir),
              .metres = glm::length(glm::dvec3(ray.dir)),
              .begin = begin,
              .end = end};
  for (int a = 0; a < 3; ++a) {
    const double size = size_[a];
    if (out.dir[a] == 0.0) {
      if (!(out.origin[a] >= 0.0 && out.origin[a] <= size)) return std::nullopt;
      continue;
    }
    const double low = -out.origin[a] / out.dir[a], high = (size - out.origin[a]) / out.dir[a];
    out.begin = std::max(out.begin, std::min(low, high));
    out.end = std::min(out.end, std::max(low, high));
  }
  if (!(out.begin < out.end)) return std::nullopt;
  return out;
}

namespace {

// Returns t of the first collision with this volume, or `far`.
double collideWith(const GridMedium& grid, const Ray& ray, double far, Stream& random) {
  const auto inside = grid.clipped(ray, 0.0, far);
  if (!inside) return far;
  double found = far, depth = random.exponential();
  grid.visitBlocks(*inside, [&](double t, double end, double /*least*/, double bound) {
    while (bound > 0.0) {
      // Delta tracking: collisions are sampled for the bound's density, and null collisions are skipped.
      const double step = depth / bound;
      if (t + step >= end) {
        depth -= (end - t) * bound;
        return true;
      }
      t += step;
      if (random.next() * bound < double{grid.at(inside->at(t))} * inside->metres) {
        found = t;
        return false;
      }
      depth = random.exponential();
    }
    return true;
  });
  return found;
}

double transmittanceOf(const GridMedium& grid, const Ray& ray, double far, Stream& random) {
  // Below this transmittance, Russian roulette saves work without bias.
  constexpr double kLittle = 0.1;
  const auto inside = grid.clipped(ray, 0.0, far);
  if (!inside) return 1.0;
  double through = 1.0, depth = random.exponential();
  const auto playRoulette = [&] {
    if (through < kLittle) through = random.next() * kLittle < through ? kLittle : 0.0;
    return through > 0.0;
  };
  grid.visitBlocks(*inside, [&](double t, double end, double least, double most) {
    // The minimum density attenuates exactly; ratio tracking handles the rest.
    through *= std::exp(-least * (end - t));
    if (!playRoulette()) return false;
    const double above = most - least;
    while (above > 0.0) {
      const double step = depth / above;
      if (t + step >= end) {
        depth -= (end - t) * above;
        return true;
      }
      t += step;
      depth = random.exponential();
      const double density = double{grid.at(inside->at(t))} * inside->metres;
      through *= std::clamp((most - density) / above, 0.0, 1.0);
      if (!playRoulette()) return false;
    }
    return true;
  });
  return through;
}

}  // namespace

Volumes Volumes::build(const Scene& scene, std::vector<std::string>& notices) {
  Volumes out;
  if (scene.volumes.empty()) return out;
  const std::vector<glm::mat4> world = gltf::worldTransforms(scene.nodes);
  for (const SceneVolume& volume : scene.volumes) {
    const glm::dmat4 world_from_grid = glm::dmat4(world[volume.node]) * glm::dmat4(volume.node_from_grid);
    const double determinant = glm::determinant(glm::dmat3(world_from_grid));
    if (determinant == 0.0 || !std::isfinite(1.0 / determinant)) {
      notices.push_back(volume.name + ": its node is flat; the volume is left out");
      continue;
    }
    GridMedium grid(volume, world_from_grid);
    if (std::isfinite(grid.densest()))
      notices.push_back(
          fmt::format("{}: densities above {:.3g} per metre, at which a voxel lets no light through, "
                      "count as that",
                      volume.name, grid.densest()));
    if (!grid.dark()) out.grids_.push_back(std::move(grid));
  }
  return out;
}

std::optional<Volumes::Collision> Volumes::collide(const Ray& ray, double far, Stream& random) const {
  // The earliest of independent collisions has the distribution of the summed media, and belongs to each in
  // proportion to its extinction.
  std::optional<Collision> first;
  for (std::uint32_t v = 0; v < grids_.size(); ++v) {
    const double limit = first ? first->t : far, t = collideWith(grids_[v], ray, limit, random);
    if (t < limit) first = Collision{.t = t, .volume = v};
  }
  return first;
}

double Volumes::transmittance(const Ray& ray, double far, Stream& random) const {
  double through = 1.0;
  for (std::size_t v = 0; v < grids_.size() && through > 0.0; ++v)
    through *= transmittanceOf(grids_[v], ray, far, random);
  return through;
}

}  // namespace lambent::baker::reference
