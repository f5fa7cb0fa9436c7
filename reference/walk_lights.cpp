#include <cmath>

#include "reference/walk.hpp"
#include "reference/warp.hpp"

namespace lambent::baker::reference {

void Walk::addShadow(std::size_t p, const glm::vec3& dir, float far, const glm::vec3& radiance,
                     std::uint32_t light) {
  if (radiance != glm::vec3(0.0f)) shadows.push_back({{paths[p].at.origin(), dir, far}, p, radiance, light});
}

void Walk::lightFromSky(std::size_t p, bool first) {
  const Path& path = paths[p];
  const glm::vec3 dir = world.environment.sample(draw(path, kChoices).x, draw(path, kSkyPlace));
  const Scattering s = scattering(path, dir, first);
  if (s.value == glm::vec3(0.0f)) return;
  const Environment::Look sky = world.environment.look(dir);
  if (!(sky.pdf > 0.0f)) return;
  addShadow(p, rayFor(path, dir, first), kInfinity,
            path.throughput * sky.radiance * (s.value / sky.pdf * powerHeuristic(sky.pdf, s.pdf)), kToSky);
}

void Walk::lightFromEmissive(std::size_t p, bool first) {
  const Path& path = paths[p];
  const auto sample = world.emissive.sample(draw(path, kChoices).y, draw(path, kEmissivePlace));
  const glm::vec3 origin = path.at.origin(), to = sample.position - origin;
  const float distance2 = glm::dot(to, to);
  if (!(distance2 > 0.0f)) return;
  const glm::vec3 dir = to / std::sqrt(distance2);
  const float facing = -glm::dot(sample.normal, dir);
  if (facing == 0.0f || (facing < 0.0f && !sample.double_sided)) return;
  const float pdf = sample.per_area * distance2 / std::abs(facing);
  const Scattering s = ofRay(path, dir, first);
  addShadow(
      p, to, kShadowReach,
      path.throughput * world.surfaces.emittedAt(sample.hit) * (s.value / pdf * powerHeuristic(pdf, s.pdf)),
      kToEmissive);
}

void Walk::lightFromShapes(std::size_t p, bool first) {
  if (shapesAreSky()) return;
  const Path& path = paths[p];
  for (std::uint32_t i = 0; i < world.shapes.size(); ++i) {
    const glm::vec2 u = draw(path, (i + 1) * kPerShape);
    const auto way = sampleShape(world.shapes[i], path.at.origin(), u);
    if (!way) continue;
    const Scattering s = ofRay(path, way->dir, first);
    addShadow(p, way->dir, way->distance * kShadowReach,
              path.throughput * way->radiance * (s.value / way->pdf * powerHeuristic(way->pdf, s.pdf)),
              kToShapes + i);
  }
}

void Walk::lightFromPunctual(std::size_t p, bool first) {
  const Path& path = paths[p];
  const auto given = [&](const PunctualLight& light, glm::vec3& radiance) -> std::optional<Beam> {
    const auto beam = beamAt(light, path.at.position);
    if (beam)
      radiance = path.throughput * beam->irradiance *
                 (first && limited ? limited->kernel(beam->to_light)
                                   : scattering(path, beam->to_light, first).value);
    return beam;
  };
  float sum = 0.0f;
  glm::vec3 radiance(0.0f);
  for (const PunctualLight& light : world.punctual)
    if (given(light, radiance)) sum += largest(radiance);
  if (!(sum > 0.0f)) return;
  float left = draw(path, kRouletteAndLamp).y * sum;
  for (std::size_t i = 0; i < world.punctual.size(); ++i) {
    const auto beam = given(world.punctual[i], radiance);
    if (!beam) continue;
    const float share = largest(radiance);
    left -= share;
    if (left >= 0.0f || !(share > 0.0f)) continue;
    const bool near = std::isfinite(beam->distance);
    glm::vec3 to = near ? world.punctual[i].position - path.at.origin() : beam->to_light;
    addShadow(p, rayFor(path, to, first), near ? kShadowReach : kInfinity, radiance * (sum / share),
              kToPunctual);
    return;
  }
}

void Walk::gatherLights(bool first) {
  shadows.clear();
  for (std::size_t p = 0; p < paths.size(); ++p) {
    if (!paths[p].alive) continue;
    if (world.environment.sampled()) lightFromSky(p, first);
    if (!world.emissive.empty()) lightFromEmissive(p, first);
    lightFromShapes(p, first);
    if (!world.punctual.empty()) lightFromPunctual(p, first);
  }
  rays.clear();
  for (const Shadow& shadow : shadows) rays.push_back(shadow.ray);
  traceOccluded();
  for (std::size_t i = 0; i < shadows.size(); ++i)
    if (!blocked[i]) paths[shadows[i].path].sum += passedOn(rays[i]) * throughVolumes(shadows[i]);
}

glm::vec3 Walk::throughVolumes(const Shadow& shadow) const {
  if (world.volumes.empty()) return shadow.radiance;
  Stream random = stream(paths[shadow.path], shadow.light);
  return shadow.radiance * static_cast<float>(world.volumes.transmittance(
                               shadow.ray, double{shadow.ray.far} / double{kShadowReach}, random));
}

void Walk::traceOccluded() {
  blocked.resize(rays.size());
  if (!rays.empty()) world.rays.occluded(rays, blocked);
  traced += rays.size();
}

glm::vec3 Walk::passedOn(const Ray& ray) {
  glm::vec3 passed(1.0f);
  if (!world.rays.hasPanes()) return passed;
  world.rays.panesOn(ray, faces);
  PaneWay way(world.surfaces, ray);
  for (const Hit& face : faces) passed *= way.pass(face);
  return passed * way.end();
}

sh::LightVector Walk::shapesFrom(const glm::vec3& point) const {
  sh::LightVector sum{.order = options.band_limit->in};
  for (const spec::LocalLight& shape : world.shapes) sum += shapeLight(shape, sum.order, point);
  return sum;
}

void Walk::takeSky(Path& path, const glm::vec3& share) const {
  path.sum -= share * limited->skyOfAll(path.dir) / path.pdf;
}

void Walk::addSky(Path& path, bool first) {
  if (first && limited) return;
  Environment::Look sky = world.environment.look(path.towards);
  if (shapesAreSky())
    sky.radiance +=
        (first && !path.in_medium ? first_shapes : shapesFrom(path.at.origin())).evaluate(path.towards);
  const float weight = world.environment.sampled() ? powerHeuristic(path.pdf, sky.pdf) : 1.0f;
  path.sum += path.throughput * sky.radiance * weight;
}

void Walk::addShapes(Path& path, float near, float far) const {
  if (shapesAreSky()) return;
  for (const spec::LocalLight& shape : world.shapes)
    if (const auto way = lookAtShape(shape, path.at.origin(), path.dir);
        way && way->distance >= near && way->distance * kShadowReach < far)
      path.sum += path.throughput * way->radiance * powerHeuristic(path.ray_pdf, way->pdf);
}

void Walk::addEmitted(Path& path, const Hit& hit, const SurfacePoint& there) const {
  if (there.emitted == glm::vec3(0.0f)) return;
  const glm::vec3 to = there.position - path.at.origin();
  const float facing = std::abs(glm::dot(there.geometric, path.dir));
  const float per_area = world.emissive.perArea(hit);
  const float weight =
      per_area > 0.0f ? powerHeuristic(path.ray_pdf, per_area * glm::dot(to, to) / std::max(facing, 1e-12f))
                      : 1.0f;
  path.sum += path.throughput * there.emitted * weight;
}

}  // namespace lambent::baker::reference
