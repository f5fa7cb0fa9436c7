#include "reference/walk.hpp"

#include <cmath>
#include <utility>

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>

#include "reference/sampler.hpp"
#include "reference/volumes.hpp"

namespace lambent::baker::reference {

glm::vec3 PaneWay::pass(const Hit& face) {
  const bool entering = glm::dot(surfaces_.areaVector(face.triangle), glm::dvec3(dir_)) <= 0.0;
  const Hit before = std::exchange(inside_, entering ? face : Hit{});
  glm::vec3 passed = surfaces_.passedAt(face);
  if (before.any())
    passed *= absorbed(before, entering ? thicknessOf(before) : (face.t - before.t) * glm::length(dir_));
  else if (!entering)
    passed *= absorbed(face, thicknessOf(face));
  return passed;
}

glm::vec3 PaneWay::absorbed(const Hit& face, float length_m) const {
  const gltf::Material& material = materialOf(face);
  if (material.thickness_m == 0.0f || material.attenuation_distance_m == 0.0f) return glm::vec3(1.0f);
  return glm::pow(glm::min(material.attenuation_color, glm::vec3(1.0f)),
                  glm::vec3(length_m / material.attenuation_distance_m));
}

namespace {

// Panes reflect at least this share of the paths that meet them from a side that reflects.
constexpr float kLeastReflected = 0.02f;
constexpr std::uint32_t kFirstRoulette = 4;  // bounces before Russian roulette begins
constexpr std::uint32_t kPerLayer = kPerVertex * (kMostVertices + 1);
// Vertices beyond kMostVertices use additional samplers, one for this many vertices.
constexpr std::uint32_t kPage = 1024;

}  // namespace

void Walk::turnTo(bool in_volume, std::uint32_t layer, std::uint32_t vertex) {
  if (vertex <= kMostVertices) {
    if (vertex == 0) samplers = in_volume ? samplersOf(pageSeed(in_volume, layer, 0)) : firsts;
    dimension = (in_volume ? 0 : layer * kPerLayer) + vertex * kPerVertex;
    return;
  }
  const std::uint32_t beyond = vertex - kMostVertices - 1;
  if (beyond % kPage == 0) samplers = samplersOf(pageSeed(in_volume, layer, 1 + beyond / kPage));
  dimension = beyond % kPage * kPerVertex;
}

std::uint32_t Walk::pageSeed(bool in_volume, std::uint32_t layer, std::uint32_t page) const {
  return combine(combine(combine(options.seed, in_volume ? 0x564f4c55u : 0x44454550u), layer), page);
}

Walk::Scattering Walk::scattering(const Path& path, const glm::vec3& dir, bool first) const {
  const SurfacePoint& at = path.at;
  if (path.in_medium) return phase(path, glm::dot(path.dir, dir), first);
  if (at.glossy) {
    const glm::vec3 local = at.reflector.toLocal(dir);
    return {at.reflector.value(local), at.reflector.pdf(local)};
  }
  if (glm::dot(at.geometric, dir) <= 0.0f) return {};
  const float value = std::max(glm::dot(at.shading, dir), 0.0f) / kPi;
  return {glm::vec3(value), value};
}

Walk::Scattering Walk::ofRay(const Path& path, const glm::vec3& ray, bool first) const {
  if (path.in_medium) return scattering(path, ray, first);
  if (glm::dot(path.at.geometric, ray) <= 0.0f) return {};
  if (first && limited) return {limited->kernelOfAll(ray), limited->pdf(ray)};
  if (!path.at.glossy) return scattering(path, ray, first);
  Scattering sum;
  const auto add = [&](const glm::vec3& dir) {
    const Scattering s = scattering(path, dir, first);
    sum.value += s.value, sum.pdf += s.pdf;
  };
  path.at.horizons().forAbove(ray, [&](const glm::vec3& dir) {
    add(dir);
    add(Horizons::mirrored(dir, path.at.smooth));
  });
  return sum;
}

glm::vec3 Walk::rayFor(const Path& path, const glm::vec3& dir, bool first) const {
  return !path.in_medium && (path.at.glossy || (first && limited)) ? path.at.horizons().rayFor(dir) : dir;
}

Walk::Scattering Walk::phase(const Path& path, float cosine, bool first) const {
  const float whole = phaseValue(path.g, cosine);
  if (!phaseIsLimited(first)) return {glm::vec3(whole), whole};
  return {glm::vec3(phaseValue(path.g, cosine, *options.band_limit->out)), 0.5f * whole + 0.125f / kPi};
}

void Walk::reflect(std::uint32_t layer) {
  if (paths.empty()) return;
  if (shapesAreSky()) first_shapes = shapesFrom(paths.front().at.origin());
  limited.reset();
  if (options.band_limit && options.band_limit->out) {
    sh::LightVector light = world.environment.lightVector();
    if (shapesAreSky()) light += first_shapes;
    limited.emplace(paths.front().at, *options.band_limit->out, light, combine(pixel, layer));
    for (Path& path : paths) path.sum += limited->open();
  }
  walk(/*in_volume=*/false, layer);
}

void Walk::scatterToEye(const EyeDepth& eye, const Ray& ray, std::uint32_t layer, double begin, double end) {
  limited.reset();
  turnTo(/*in_volume=*/true, layer, 0);
  const double share = -std::expm1(begin - end);
  for (Path& path : paths) {
    const glm::dvec2 u(draw(path, kPlaceInVolume));
    const double t = eye.place(std::min(begin - std::log1p(-u.x * share), end));
    standInMedium(path, glm::vec3(glm::dvec3(ray.origin) + t * glm::dvec3(ray.dir)),
                  world.scene.volumes.medium(eye.pick(t, u.y)));
    path.dir = glm::vec3(glm::normalize(glm::dvec3(ray.dir)));
  }
  walk(/*in_volume=*/true, layer);
}

void Walk::walk(bool in_volume, std::uint32_t layer) {
  for (std::uint32_t vertex = 0; anyAlive(); ++vertex) {
    turnTo(in_volume, layer, vertex);
    for (Path& path : paths)
      if (!path.at.glossy && !(vertex == 0 && limited)) path.throughput *= path.at.albedo;
    if (vertex > kFirstRoulette) playRoulette();
    gatherLights(vertex == 0);
    scatter(vertex == 0);
    if (world.scene.volumes.empty() && vertex == mostReflections() && !findsLights()) {
      if (!world.environment.dark() || shapesAreSky()) lookAtSky(vertex == 0);
      return;
    }
    advance(vertex == 0);
  }
}

void Walk::scatter(bool first) {
  rays.clear();
  ray_path.clear();
  for (std::size_t p = 0; p < paths.size(); ++p) {
    Path& path = paths[p];
    if (!path.alive) continue;
    const glm::vec2 u = draw(path, kDirection);
    if (path.in_medium) {
      scatterInMedium(path, u, first);
    } else if (first && limited) {
      const glm::vec3 dir = limited->sample(u);
      path.go(dir, limited->pdf(dir));
      path.throughput *= limited->kernelOfAll(path.dir) / path.pdf;
    } else if (path.at.glossy) {
      const Reflector& reflector = path.at.reflector;
      const float choice = draw(path, kLobe).x;
      const glm::vec3 dir = glm::normalize(reflector.world_from_local * reflector.sample(choice, u));
      const Scattering s = scattering(path, dir, first);
      path.go(dir, s.pdf);
      path.throughput *= s.pdf > 0.0f ? s.value / s.pdf : glm::vec3(0.0f);
      path.dir = rayFor(path, dir, first);
      if (findsLights()) path.ray_pdf = ofRay(path, path.dir, first).pdf;
    } else {
      const glm::vec3 local = cosineDirection(u);
      path.go(glm::normalize(frameAbout(path.at.shading) * local), local.z / kPi);
    }
    path.alive = (path.in_medium || glm::dot(path.at.geometric, path.dir) > 0.0f) &&
                 (path.throughput != glm::vec3(0.0f) || (first && limited));
    if (!path.alive) continue;
    rays.push_back({path.at.origin(), path.dir, kInfinity});
    ray_path.push_back(p);
  }
}

void Walk::scatterInMedium(Path& path, const glm::vec2& u, bool first) const {
  glm::vec3 dir(0.0f);
  if (!phaseIsLimited(first))
    dir = samplePhase(path.g, path.dir, u);
  else if (u.x < 0.5f)
    dir = samplePhase(path.g, path.dir, {2.0f * u.x, u.y});
  else
    dir = sphereDirection({2.0f * u.x - 1.0f, u.y});
  const Scattering s = phase(path, glm::dot(path.dir, dir), first);
  path.go(dir, s.pdf);
  path.throughput *= s.value / s.pdf;
}

void Walk::advance(bool first) {
  collide();
  hits.resize(rays.size());
  if (!rays.empty()) world.scene.rays->intersect(rays, hits);
  traced += rays.size();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Path& path = paths[ray_path[i]];
    const glm::vec3 passed = meetPanes(path, rays[i], hits[i]);
    const bool hit = hits[i].any();
    if (!hit && !collisions[i]) {
      addSky(path, first);
      if (first && limited && passed != glm::vec3(1.0f)) takeSky(path, 1.0f - passed);
      path.alive = false;
      continue;
    }
    if (first && limited) takeSky(path, glm::vec3(1.0f));
    if (hit)
      arrive(path, hits[i]);
    else
      enterMedium(path, rays[i], *collisions[i]);
  }
}

glm::vec3 Walk::meetPanes(Path& path, const Ray& ray, Hit& hit) {
  const float far = hit.any() ? hit.t : ray.far * kShadowReach;
  glm::vec3 all(1.0f);
  float near = 0.0f;
  if (world.scene.rays->hasPanes()) {
    Stream random = stream(path, kAtPanes);
    world.scene.rays->panesOn({ray.origin, ray.dir, far}, faces);
    PaneWay way(world.scene.surfaces, ray);
    const auto pass = [&](const glm::vec3& share) {
      path.throughput *= share;
      all *= share;
    };
    for (const Hit& face : faces) {
      addShapes(path, near, face.t);
      near = face.t;
      const glm::vec3 passed = way.pass(face);
      const bool back = world.scene.surfaces.pointAt(face, path.dir).blocked;
      const float reflected = back ? 0.0f : std::max(1.0f - largest(passed), kLeastReflected);
      if (random.next() < double{reflected}) {
        hit = face;
        path.throughput /= reflected;
        return all;
      }
      pass(passed / (1.0f - reflected));
    }
    pass(way.end());
  }
  addShapes(path, near, far);
  return all;
}

void Walk::collide() {
  collisions.assign(rays.size(), std::nullopt);
  if (world.scene.volumes.empty()) return;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Stream random = stream(paths[ray_path[i]], kOnward);
    collisions[i] = world.scene.volumes.collide(rays[i], double{kInfinity}, random);
    if (collisions[i]) rays[i].far = static_cast<float>(collisions[i]->t);
  }
}

void Walk::arrive(Path& path, const Hit& hit) const {
  const SurfacePoint there = world.scene.surfaces.pointAt(hit, path.dir);
  path.alive = !there.blocked && !there.unlit;
  if (!path.alive) return;
  addEmitted(path, hit, there);
  path.at = there;
  // Panes reflect as much less than all as they pass, which is that of a right angle at all angles.
  if (world.scene.surfaces.surfaces()[hit.surface].material.transmits())
    path.at.reflector.f90 = largest(there.reflector.f0);
  path.in_medium = false;
  path.alive = ++path.reflections <= mostReflections();
}

void Walk::enterMedium(Path& path, const Ray& ray, const Volumes::Collision& collision) const {
  standInMedium(path, glm::vec3(glm::dvec3(ray.origin) + collision.t * glm::dvec3(ray.dir)),
                world.scene.volumes.medium(collision.volume));
  path.alive = options.bounces.value_or(1) > 0;
}

void Walk::standInMedium(Path& path, const glm::vec3& position, const SceneVolume& medium) {
  path.at = {};
  path.at.position = position;
  path.at.albedo = medium.albedo;
  path.in_medium = path.scattered = true;
  path.g = medium.g;
}

void Walk::lookAtSky(bool first) {
  traceOccluded();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Path& path = paths[ray_path[i]];
    const glm::vec3 passed = blocked[i] ? glm::vec3(0.0f) : passedOn(rays[i]);
    path.throughput *= passed;
    if (!blocked[i]) addSky(path, first);
    if (first && limited && passed != glm::vec3(1.0f)) takeSky(path, 1.0f - passed);
  }
}

void Walk::playRoulette() {
  for (Path& path : paths) {
    if (!path.alive || (options.bounces && !path.scattered)) continue;
    const float survival = std::min(1.0f, largest(path.throughput));
    path.alive = survival > 0.0f && draw(path, kRouletteAndLamp).x < survival;
    path.throughput /= std::max(survival, 1e-20f);
  }
}

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
  const auto sample = world.scene.emissive.sample(draw(path, kChoices).y, draw(path, kEmissivePlace));
  const glm::vec3 origin = path.at.origin(), to = sample.position - origin;
  const float distance2 = glm::dot(to, to);
  if (!(distance2 > 0.0f)) return;
  const glm::vec3 dir = to / std::sqrt(distance2);
  const float facing = -glm::dot(sample.normal, dir);
  if (facing == 0.0f || (facing < 0.0f && !sample.double_sided)) return;
  const float pdf = sample.per_area * distance2 / std::abs(facing);
  const Scattering s = ofRay(path, dir, first);
  addShadow(p, to, kShadowReach,
            path.throughput * world.scene.surfaces.emittedAt(sample.hit) *
                (s.value / pdf * powerHeuristic(pdf, s.pdf)),
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
  for (const PunctualLight& light : world.scene.punctual)
    if (given(light, radiance)) sum += largest(radiance);
  if (!(sum > 0.0f)) return;
  float left = draw(path, kRouletteAndLamp).y * sum;
  for (std::size_t i = 0; i < world.scene.punctual.size(); ++i) {
    const auto beam = given(world.scene.punctual[i], radiance);
    if (!beam) continue;
    const float share = largest(radiance);
    left -= share;
    if (left >= 0.0f || !(share > 0.0f)) continue;
    const bool near = std::isfinite(beam->distance);
    glm::vec3 to = near ? world.scene.punctual[i].position - path.at.origin() : beam->to_light;
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
    if (!world.scene.emissive.empty()) lightFromEmissive(p, first);
    lightFromShapes(p, first);
    if (!world.scene.punctual.empty()) lightFromPunctual(p, first);
  }
  rays.clear();
  for (const Shadow& shadow : shadows) rays.push_back(shadow.ray);
  traceOccluded();
  for (std::size_t i = 0; i < shadows.size(); ++i)
    if (!blocked[i]) paths[shadows[i].path].sum += passedOn(rays[i]) * throughVolumes(shadows[i]);
}

glm::vec3 Walk::throughVolumes(const Shadow& shadow) const {
  if (world.scene.volumes.empty()) return shadow.radiance;
  Stream random = stream(paths[shadow.path], shadow.light);
  return shadow.radiance * static_cast<float>(world.scene.volumes.transmittance(
                               shadow.ray, double{shadow.ray.far} / double{kShadowReach}, random));
}

void Walk::traceOccluded() {
  blocked.resize(rays.size());
  if (!rays.empty()) world.scene.rays->occluded(rays, blocked);
  traced += rays.size();
}

glm::vec3 Walk::passedOn(const Ray& ray) {
  glm::vec3 passed(1.0f);
  if (!world.scene.rays->hasPanes()) return passed;
  world.scene.rays->panesOn(ray, faces);
  PaneWay way(world.scene.surfaces, ray);
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
  const float per_area = world.scene.emissive.perArea(hit);
  const float weight =
      per_area > 0.0f ? powerHeuristic(path.ray_pdf, per_area * glm::dot(to, to) / std::max(facing, 1e-12f))
                      : 1.0f;
  path.sum += path.throughput * there.emitted * weight;
}

}  // namespace lambent::baker::reference
