// All paths of one pixel, each at a vertex, on a surface or in a medium, and the light that they gather
// there. walk.cpp moves them on.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>

#include "reference/camera.hpp"
#include "reference/exit_kernel.hpp"
#include "reference/film.hpp"
#include "reference/ray_tracer.hpp"
#include "reference/sampler.hpp"

namespace lambent::baker::reference {

// Follows a ray through the faces of panes (KHR_materials_transmission) and says what they pass of the light:
// each face its share (Surfaces::passedAt), and the volume between entry and exit what Beer's law leaves of
// it. Where the other face is missing, KHR_materials_volume's thickness counts.

class PaneWay {
 public:
  PaneWay(const Surfaces& surfaces, const Ray& ray) : surfaces_(surfaces), dir_(ray.dir) {}

  // Passes the next face of the ray. Returns the share of the light that does.
  glm::vec3 pass(const Hit& face) {
    const bool entering = glm::dot(surfaces_.areaVector(face.triangle), glm::dvec3(dir_)) <= 0.0;
    const Hit before = std::exchange(inside_, entering ? face : Hit{});
    glm::vec3 passed = surfaces_.passedAt(face);
    if (before.any())
      passed *= absorbed(before, entering ? thicknessOf(before) : (face.t - before.t) * glm::length(dir_));
    else if (!entering)
      passed *= absorbed(face, thicknessOf(face));
    return passed;
  }
  // Ends the ray. Returns what is left after volumes that it has entered and not left.
  glm::vec3 end() const { return inside_.any() ? absorbed(inside_, thicknessOf(inside_)) : glm::vec3(1.0f); }

 private:
  const gltf::Material& materialOf(const Hit& face) const {
    return surfaces_.surfaces()[face.surface].material;
  }
  float thicknessOf(const Hit& face) const { return materialOf(face).thickness_m; }
  glm::vec3 absorbed(const Hit& face, float length_m) const {
    const gltf::Material& material = materialOf(face);
    if (material.thickness_m == 0.0f || material.attenuation_distance_m == 0.0f) return glm::vec3(1.0f);
    return glm::pow(glm::min(material.attenuation_color, glm::vec3(1.0f)),
                    glm::vec3(length_m / material.attenuation_distance_m));
  }

  const Surfaces& surfaces_;
  glm::vec3 dir_;
  Hit inside_;  // the face by which the ray has entered
};

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();
inline constexpr std::uint32_t kMostVertices = 64;  // maximum number of vertices without --bounces
// The same limit in scenes with volumes, where light can bounce between a volume and a white floor many
// times. If anything absorbs one percent, no path comes near it; only a closed room of perfect white does.
inline constexpr std::uint32_t kMostReflections = 4096;
inline constexpr float kShadowReach = 1.0f - 1e-4f;  // shadow rays end before the light's own surface

// Number the pairs of dimensions that one vertex draws from.
enum Dimension : std::uint32_t {
  kDirection,
  kSkyPlace,
  kEmissivePlace,
  kChoices,
  kRouletteAndLamp,
  kPerVertex
};
inline constexpr std::uint32_t kPerLayer = kPerVertex * (kMostVertices + 1);
// Vertices beyond kMostVertices use additional samplers, one for this many vertices.
inline constexpr std::uint32_t kPage = 1024;
// Light shape i draws from its own dimensions, beyond those of all layers.
inline constexpr std::uint32_t kPerShape = 1u << 20;
// The choice of a glossy lobe, and the point where a volume scatters towards the eye, have their own, too.
inline constexpr std::uint32_t kLobe = 1u << 31, kPlaceInVolume = 1u << 30;

// Number the streams of a vertex for tracking through media: one for its own path, and one towards each kind
// of light.
enum Way : std::uint32_t { kOnward, kToSky, kToEmissive, kToPunctual, kToShapes };
// The choice between passing a pane and being reflected by it has a stream of its own.
inline constexpr std::uint32_t kAtPanes = 0xffffffffu;

struct Path {
  SurfacePoint at;  // in a medium: without normals, and with the medium's albedo
  glm::vec3 throughput{1.0f}, sum{0.0f};
  std::uint32_t index = 0, replica = 0;  // index of the sample within its replica, and the replica
  // In a medium, this is first the direction that led here; after sampling, it is the next one.
  glm::vec3 dir{0.0f};
  // The BRDF is evaluated for this direction: dir, or a direction that is mirrored to dir (Horizons).
  glm::vec3 towards{0.0f};
  float pdf = 0.0f;  // density of `towards` by the BRDF sampling
  // The density of `dir`, summed over all directions that it stands for. It is set only if findsLights().
  float ray_pdf = 0.0f;
  bool alive = true;
  bool in_medium = false;         // the current vertex is in a medium
  float g = 0.0f;                 // of that medium
  bool scattered = false;         // any vertex so far was in a medium
  std::uint32_t reflections = 0;  // number of surface vertices after the first vertex

  void go(const glm::vec3& where, float density) {
    dir = towards = where;
    pdf = ray_pdf = density;
  }
};
// A Shadow is a light's contribution, which counts if its shadow ray is not blocked.
struct Shadow {
  Ray ray;
  std::size_t path;
  glm::vec3 radiance;
  std::uint32_t light;  // kind of light (Way), which selects the stream
};

struct PixelPaths {
  const World& world;
  std::uint32_t number;  // index of the pixel in the picture
  const Options& options = world.options;
  std::uint32_t pixel = combine(options.seed, number);
  std::array<Sampler, 2> firsts = samplersOf(options.seed);  // for the first vertices of layers
  std::array<Sampler, 2> samplers = firsts;                  // for the current vertex
  std::uint32_t dimension = 0;                               // first dimension of the current vertex
  std::vector<Path> paths = {};
  std::vector<Shadow> shadows = {};
  std::vector<Ray> rays = {};
  std::vector<std::size_t> ray_path = {};
  std::vector<Hit> hits = {};
  std::vector<std::optional<Volumes::Collision>> collisions = {};
  std::vector<std::uint8_t> blocked = {};
  std::vector<Hit> faces = {};
  sh::LightVector first_shapes = {};     // light of shapes as SH at the first vertex, where all paths are
  std::optional<FirstHit> limited = {};  // with --band-limit IN,OUT: the first vertex, where all paths are
  std::uint64_t traced = 0;

  std::array<Sampler, 2> samplersOf(std::uint32_t seed) const {
    return {Sampler(seed, number, 0), Sampler(seed, number, 1)};
  }
  // Selects the sampler and dimensions of a vertex. The first vertices of layers use one sampler, so that
  // they get its first dimensions, which are stratified best. Other vertices, and those of paths that begin
  // in a volume, use one sampler for each `kPage` vertices.
  void turnTo(bool in_volume, std::uint32_t layer, std::uint32_t vertex) {
    if (vertex <= kMostVertices) {
      if (vertex == 0) samplers = in_volume ? samplersOf(pageSeed(in_volume, layer, 0)) : firsts;
      dimension = (in_volume ? 0 : layer * kPerLayer) + vertex * kPerVertex;
      return;
    }
    const std::uint32_t beyond = vertex - kMostVertices - 1;
    if (beyond % kPage == 0) samplers = samplersOf(pageSeed(in_volume, layer, 1 + beyond / kPage));
    dimension = beyond % kPage * kPerVertex;
  }
  std::uint32_t pageSeed(bool in_volume, std::uint32_t layer, std::uint32_t page) const {
    return combine(combine(combine(options.seed, in_volume ? 0x564f4c55u : 0x44454550u), layer), page);
  }

  glm::vec2 draw(const Path& path, std::uint32_t which) const {
    return samplers[path.replica].pair(dimension + which, path.index);
  }
  Stream stream(const Path& path, std::uint32_t way) const {
    return samplers[path.replica].stream(dimension, path.index, way);
  }

  // A Scattering is the BRDF times the cosine (for diffuse surfaces without the albedo), and the density of
  // the direction by BRDF sampling.
  struct Scattering {
    glm::vec3 value{0.0f};
    float pdf = 0.0f;
  };
  // Evaluates the BRDF without band limit for one direction.
  Scattering scattering(const Path& path, const glm::vec3& dir, bool first) const {
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
  // Sums the BRDF over all directions that a ray stands for. At the first vertex the BRDF may be
  // band-limited.
  Scattering ofRay(const Path& path, const glm::vec3& ray, bool first) const {
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
  // Returns the ray direction for a direction (Horizons), with the same length.
  glm::vec3 rayFor(const Path& path, const glm::vec3& dir, bool first) const {
    return !path.in_medium && (path.at.glossy || (first && limited)) ? path.at.horizons().rayFor(dir) : dir;
  }
  // Returns whether paths can hit lights at a finite distance.
  bool findsLights() const {
    return !world.scene.emissive.empty() || !(world.shapes.empty() || shapesAreSky());
  }
  // Returns whether the first OUT bands replace the phase function at this vertex, as they replace the BRDF.
  // Directions are then drawn half from the phase function and half uniformly.
  bool phaseIsLimited(bool first) const { return first && options.band_limit && options.band_limit->out; }
  Scattering phase(const Path& path, float cosine, bool first) const {
    const float whole = phaseValue(path.g, cosine);
    if (!phaseIsLimited(first)) return {glm::vec3(whole), whole};
    return {glm::vec3(phaseValue(path.g, cosine, *options.band_limit->out)), 0.5f * whole + 0.125f / kPi};
  }
  // Returns whether spheres and discs are evaluated as band-limited (signed) light at each point, as the sky
  // is.
  bool shapesAreSky() const { return options.band_limit.has_value() && !world.shapes.empty(); }
  std::uint32_t mostReflections() const {
    return options.bounces.value_or(world.scene.volumes.empty() ? kMostVertices : kMostReflections);
  }
  bool anyAlive() const {
    return std::any_of(paths.begin(), paths.end(), [](const Path& path) { return path.alive; });
  }

  // These gather light: next-event estimation towards discs and environment maps, an emissive
  // triangle, shapes and a punctual light, and the light that a path's own direction hits.
  void gatherLights(bool first) {
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
  void addShadow(std::size_t p, const glm::vec3& dir, float far, const glm::vec3& radiance,
                 std::uint32_t light) {
    if (radiance != glm::vec3(0.0f))
      shadows.push_back({{paths[p].at.origin(), dir, far}, p, radiance, light});
  }
  void lightFromSky(std::size_t p, bool first) {
    const Path& path = paths[p];
    const glm::vec3 dir = world.environment.sample(draw(path, kChoices).x, draw(path, kSkyPlace));
    const Scattering s = scattering(path, dir, first);
    if (s.value == glm::vec3(0.0f)) return;
    const Environment::Look sky = world.environment.look(dir);
    if (!(sky.pdf > 0.0f)) return;
    addShadow(p, rayFor(path, dir, first), kInfinity,
              path.throughput * sky.radiance * (s.value / sky.pdf * powerHeuristic(sky.pdf, s.pdf)), kToSky);
  }
  void lightFromEmissive(std::size_t p, bool first) {
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
  void lightFromShapes(std::size_t p, bool first) {
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
  // Samples one punctual light in proportion to the unoccluded light of each.
  void lightFromPunctual(std::size_t p, bool first) {
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
  glm::vec3 throughVolumes(const Shadow& shadow) const {
    if (world.scene.volumes.empty()) return shadow.radiance;
    Stream random = stream(paths[shadow.path], shadow.light);
    return shadow.radiance * static_cast<float>(world.scene.volumes.transmittance(
                                 shadow.ray, double{shadow.ray.far} / double{kShadowReach}, random));
  }
  void traceOccluded() {
    blocked.resize(rays.size());
    if (!rays.empty()) world.scene.rays->occluded(rays, blocked);
    traced += rays.size();
  }
  // Returns what panes pass of the light along a ray.
  glm::vec3 passedOn(const Ray& ray) {
    glm::vec3 passed(1.0f);
    if (!world.scene.rays->hasPanes()) return passed;
    world.scene.rays->panesOn(ray, faces);
    PaneWay way(world.scene.surfaces, ray);
    for (const Hit& face : faces) passed *= way.pass(face);
    return passed * way.end();
  }
  // Returns the SH of all shapes as seen from a point.
  sh::LightVector shapesFrom(const glm::vec3& point) const {
    sh::LightVector sum{.order = options.band_limit->in};
    for (const spec::LocalLight& shape : world.shapes) sum += shapeLight(shape, sum.order, point);
    return sum;
  }
  // Subtracts the share of the sky that a path of the first vertex does not see, because FirstHit::open() has
  // counted it.
  void takeSky(Path& path, const glm::vec3& share) const {
    path.sum -= share * limited->skyOfAll(path.dir) / path.pdf;
  }
  void addSky(Path& path, bool first) {
    if (first && limited) return;
    Environment::Look sky = world.environment.look(path.towards);
    if (shapesAreSky())
      sky.radiance +=
          (first && !path.in_medium ? first_shapes : shapesFrom(path.at.origin())).evaluate(path.towards);
    const float weight = world.environment.sampled() ? powerHeuristic(path.pdf, sky.pdf) : 1.0f;
    path.sum += path.throughput * sky.radiance * weight;
  }
  // Adds the shapes that the ray hits between `near` and the surface at `far`.
  void addShapes(Path& path, float near, float far) const {
    if (shapesAreSky()) return;
    for (const spec::LocalLight& shape : world.shapes)
      if (const auto way = lookAtShape(shape, path.at.origin(), path.dir);
          way && way->distance >= near && way->distance * kShadowReach < far)
        path.sum += path.throughput * way->radiance * powerHeuristic(path.ray_pdf, way->pdf);
  }
  void addEmitted(Path& path, const Hit& hit, const SurfacePoint& there) const {
    if (there.emitted == glm::vec3(0.0f)) return;
    const glm::vec3 to = there.position - path.at.origin();
    const float facing = std::abs(glm::dot(there.geometric, path.dir));
    const float per_area = world.scene.emissive.perArea(hit);
    const float weight =
        per_area > 0.0f ? powerHeuristic(path.ray_pdf, per_area * glm::dot(to, to) / std::max(facing, 1e-12f))
                        : 1.0f;
    path.sum += path.throughput * there.emitted * weight;
  }
};

}  // namespace lambent::baker::reference
