#include "reference/volumes.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/matrix.hpp>

namespace lambent::baker::reference {

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
