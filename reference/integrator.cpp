#include "reference/integrator.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

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
  const auto addPaths = [&](double weight) {
    for (const Path& path : walk.paths) out.replicas[path.replica] += weight * glm::dvec3(path.sum);
  };
  const auto blended = [&](const Hit& hit) {
    return world_.surfaces.surfaces()[hit.surface].material.alpha_mode == gltf::AlphaMode::Blend;
  };
  const Ray ray = world_.eye.through(x, y);
  std::vector<Hit> layers;
  world_.rays.visible(ray, layers);
  out.rays = 1;
  // Depth ignores blended surfaces and volumes, as the runtime's depth buffer does.
  if (!layers.empty() && !blended(layers.back()))
    out.depth = world_.eye.depthOf(glm::dvec3(ray.origin) + double{layers.back().t} * glm::dvec3(ray.dir));
  double through = 1.0;
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
  for (; layer < layers.size() && through > 0.0; ++layer) {
    passVolumes(layer);
    const SurfacePoint point = world_.surfaces.pointAt(layers[layer], ray.dir);
    const double weight =
        through * (blended(layers[layer]) ? std::clamp(double{point.alpha}, 0.0, 1.0) : 1.0);
    through -= weight;
    if (weight <= 0.0) continue;
    addAlike(weight * glm::dvec3(point.unlit ? point.albedo : point.emitted));
    if (point.unlit) continue;
    beginPaths(point);
    walk.reflect(layer);
    addPaths(weight);
  }
  if (through > 0.0) passVolumes(layer);
  if (through > 0.0)
    addAlike(through * glm::dvec3(world_.environment.shown(glm::vec3(glm::normalize(glm::dvec3(ray.dir))),
                                                           world_.eye.pixelAngle())));
  out.alpha = 1.0 - through;
  out.rays += walk.traced;
  return out;
}

}  // namespace lambent::baker::reference
