#include "reference/integrator.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "reference/panes.hpp"
#include "reference/walk.hpp"

namespace lambent::baker::reference {

PixelSum Integrator::pixel(std::uint32_t x, std::uint32_t y, std::uint32_t first, std::uint32_t count) const {
  Walk walk{.world = world_, .options = options_, .number = y * options_.size.width + x};
  PixelSum out;
  const auto samplesOf = [&](std::uint32_t replica) {
    return (first + count + 1 - replica) / 2 - (first + 1 - replica) / 2;
  };
  const auto addAlike = [&](const glm::dvec3& radiance) {
    for (std::uint32_t replica = 0; replica < 2; ++replica)
      out.replicas[replica] += static_cast<double>(samplesOf(replica)) * radiance;
  };
  const auto beginPaths = [&](const SurfacePoint& point) {
    walk.paths.clear();
    for (std::uint32_t s = first; s < first + count; ++s)
      walk.paths.push_back({.at = point, .index = s / 2, .replica = s % 2});
  };
  const auto addPaths = [&](const glm::dvec3& weight) {
    for (const Path& path : walk.paths) out.replicas[path.replica] += weight * glm::dvec3(path.sum);
  };
  const auto materialOf = [&](const Hit& hit) -> const gltf::Material& {
    return world_.surfaces.surfaces()[hit.surface].material;
  };
  const auto blended = [&](const Hit& hit) { return materialOf(hit).alpha_mode == gltf::AlphaMode::Blend; };
  const Ray ray = world_.eye.through(x, y);
  std::vector<Hit> layers;
  world_.rays.visible(ray, layers);
  out.rays = 1;
  // Depth ignores blended surfaces, panes and volumes, as the runtime's depth buffer does.
  if (!layers.empty() && !blended(layers.back()) && !materialOf(layers.back()).transmits())
    out.depth = world_.eye.depthOf(glm::dvec3(ray.origin) + double{layers.back().t} * glm::dvec3(ray.dir));
  glm::dvec3 through(1.0);
  const auto any = [&] { return through.r > 0.0 || through.g > 0.0 || through.b > 0.0; };
  // Each step adds the volumes in front of layer i, from the previous layer on.
  std::optional<EyeDepth> eye;
  if (!world_.volumes.empty()) eye.emplace(world_.volumes, ray, 0.0, double{kInfinity});
  double depth = 0.0;
  const auto passVolumes = [&](std::uint32_t i) {
    if (!eye) return;
    const double begin =
        std::exchange(depth, eye->to(i < layers.size() ? double{layers[i].t} : double{kInfinity}));
    if (!(depth > begin)) return;
    beginPaths({});
    walk.scatterToEye(*eye, ray, i, begin, depth);
    addPaths(through * -std::expm1(begin - depth));
    through *= std::exp(begin - depth);
  };
  std::uint32_t layer = 0;
  PaneWay panes(world_.surfaces, ray);
  for (; layer < layers.size() && any(); ++layer) {
    passVolumes(layer);
    const SurfacePoint point = world_.surfaces.pointAt(layers[layer], ray.dir);
    glm::dvec3 weight = through;
    if (materialOf(layers[layer]).transmits()) {
      through *= glm::dvec3(panes.pass(layers[layer]));
    } else {
      if (blended(layers[layer])) weight *= std::clamp(double{point.alpha}, 0.0, 1.0);
      through -= weight;
    }
    if (weight == glm::dvec3(0.0)) continue;
    addAlike(weight * glm::dvec3(point.unlit ? point.albedo : point.emitted));
    if (point.unlit) continue;
    beginPaths(point);
    walk.reflect(layer);
    addPaths(weight);
  }
  if (any()) passVolumes(layer);
  if (any())
    addAlike(through * glm::dvec3(world_.environment.shown(glm::vec3(glm::normalize(glm::dvec3(ray.dir))),
                                                           world_.eye.pixelAngle())));
  out.alpha = 1.0 - (through.r + through.g + through.b) / 3.0;
  out.rays += walk.traced;
  return out;
}

}  // namespace lambent::baker::reference
