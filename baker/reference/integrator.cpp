#include "baker/reference/integrator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "baker/reference/exit_kernel.hpp"
#include "baker/reference/eye_depth.hpp"
#include "baker/reference/phase.hpp"
#include "baker/reference/warp.hpp"

namespace lambent::baker::reference {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::uint32_t kMostVertices = 64;  // where --bounces is not given
// And volumes are about, between which and a white floor light goes to and fro. No matter that absorbs one in
// a hundred lets a path come near; only a closed room of perfect white does.
constexpr std::uint32_t kMostReflections = 4096;
constexpr std::uint32_t kFirstRoulette = 4;   // bounces that always go on
constexpr float kShadowReach = 1.0f - 1e-4f;  // shadow rays end before the light's own surface

// The pairs of dimensions that one vertex draws.
enum Dimension : std::uint32_t {
  kDirection,
  kSkyPlace,
  kEmissivePlace,
  kChoices,
  kRouletteAndLamp,
  kPerVertex
};
constexpr std::uint32_t kPerLayer = kPerVertex * (kMostVertices + 1);
// Shape i draws from dimensions of its own, beyond those of all layers.
constexpr std::uint32_t kPerShape = 1u << 20;
// And so does what part of a glossy surface draws the direction; and where a volume scatters towards the eye.
constexpr std::uint32_t kLobe = 1u << 31, kPlaceInVolume = 1u << 30;
// Vertices beyond the first ones draw from samplers of their own, this many from each.
constexpr std::uint32_t kPage = 1024;

// Which stream a vertex walks through media by: on its way, and towards each light.
enum Way : std::uint32_t { kOnward, kToSky, kToEmissive, kToPunctual, kToShapes };

float largest(const glm::vec3& v) {
  return std::max({std::abs(v.r), std::abs(v.g), std::abs(v.b)});
}

}  // namespace

struct Integrator::Walk {
  const World& world;
  const Options& options;
  std::uint32_t number;  // of the pixel
  std::uint32_t pixel = combine(options.seed, number);
  std::array<Sampler, 2> firsts = samplersOf(options.seed);  // of layers
  std::array<Sampler, 2> samplers = firsts;                  // of the current vertex
  std::uint32_t dimension = 0;                               // and where it draws
  std::vector<Path> paths = {};
  std::vector<Shadow> shadows = {};
  std::vector<Ray> rays = {};
  std::vector<std::size_t> ray_path = {};
  std::vector<Hit> hits = {};
  std::vector<std::optional<Volumes::Collision>> collisions = {};
  std::vector<std::uint8_t> blocked = {};
  sh::LightVector first_shapes = {};     // shapes that are sky, from the first vertex, where all paths stand
  std::optional<FirstHit> limited = {};  // --band-limit IN,OUT: where all paths stand at the first vertex
  std::uint64_t traced = 0;

  std::array<Sampler, 2> samplersOf(std::uint32_t seed) const {
    return {Sampler(seed, number, 0), Sampler(seed, number, 1)};
  }

  // The first vertices of layers draw from one sampler, so that those of few dimensions are spread the best.
  // The others', and those of paths that begin in a volume, from one for each `kPage`.
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

  // What share of the light from dir is reflected, times the cosine, of matte surfaces without the albedo;
  // and the density of dir by the surface's own strategy.
  struct Scattering {
    glm::vec3 value{0.0f};
    float pdf = 0.0f;
  };
  Scattering scattering(const Path& path, const glm::vec3& dir, bool first) const {
    const SurfacePoint& at = path.at;
    if (path.in_medium) return phase(path, glm::dot(path.dir, dir), first);
    if (glm::dot(at.geometric, dir) <= 0.0f) return {};
    if (first && limited) return {limited->kernelOfPair(dir), limited->pdf(dir)};
    if (at.glossy) {
      const glm::vec3 local = at.reflector.toLocal(dir);
      return {at.reflector.value(local), at.reflector.pdf(local)};
    }
    const float value = std::max(glm::dot(at.shading, dir), 0.0f) / kPi;
    return {glm::vec3(value), value};
  }

  // Of the phase function the first OUT bands are as much a kernel as those of a BRDF, and drawn half from
  // the whole, half evenly.
  bool phaseIsLimited(bool first) const { return first && options.band_limit && options.band_limit->out; }
  Scattering phase(const Path& path, float cosine, bool first) const {
    const float whole = phaseValue(path.g, cosine);
    if (!phaseIsLimited(first)) return {glm::vec3(whole), whole};
    return {glm::vec3(phaseValue(path.g, cosine, *options.band_limit->out)), 0.5f * whole + 0.125f / kPi};
  }

  // Cut to their bands, spheres and discs shine from all over the sky, as seen from each point, and signed.
  bool shapesAreSky() const { return options.band_limit.has_value() && !world.shapes.empty(); }

  void addShadow(std::size_t p, const glm::vec3& dir, float far, const glm::vec3& radiance,
                 std::uint32_t light) {
    if (radiance != glm::vec3(0.0f))
      shadows.push_back({{paths[p].at.origin(), dir, far}, p, radiance, light});
  }

  // Next-event estimation: towards discs and probes, an emissive triangle, a punctual light.
  void lightFromSky(std::size_t p, bool first) {
    const Path& path = paths[p];
    const glm::vec3 dir = world.environment.sample(draw(path, kChoices).x, draw(path, kSkyPlace));
    const Scattering s = scattering(path, dir, first);
    if (s.value == glm::vec3(0.0f)) return;
    const Environment::Look sky = world.environment.look(dir);
    if (!(sky.pdf > 0.0f)) return;
    addShadow(p, dir, kInfinity,
              path.throughput * sky.radiance * (s.value / sky.pdf * powerHeuristic(sky.pdf, s.pdf)), kToSky);
  }

  void lightFromEmissive(std::size_t p, bool first) {
    const Path& path = paths[p];
    const auto sample = world.emissive.sample(draw(path, kChoices).y, draw(path, kEmissivePlace));
    const glm::vec3 origin = path.at.origin(), to = sample.position - origin;
    const float distance2 = glm::dot(to, to);
    if (!(distance2 > 0.0f)) return;
    const glm::vec3 dir = to / std::sqrt(distance2);
    const float facing = -glm::dot(sample.normal, dir);
    if (facing == 0.0f || (facing < 0.0f && !sample.double_sided)) return;
    const float pdf = sample.per_area * distance2 / std::abs(facing);
    const Scattering s = scattering(path, dir, first);
    addShadow(
        p, to, kShadowReach,
        path.throughput * world.surfaces.emittedAt(sample.hit) * (s.value / pdf * powerHeuristic(pdf, s.pdf)),
        kToEmissive);
  }

  void lightFromShapes(std::size_t p, bool first) {
    if (shapesAreSky()) return;
    const Path& path = paths[p];
    for (std::uint32_t i = 0; i < world.shapes.size(); ++i) {
      const glm::vec2 u = draw(path, (i + 1) * kPerShape);
      const auto way = sampleShape(world.shapes[i], path.at.origin(), u);
      if (!way) continue;
      const Scattering s = scattering(path, way->dir, first);
      addShadow(p, way->dir, way->distance * kShadowReach,
                path.throughput * way->radiance * (s.value / way->pdf * powerHeuristic(way->pdf, s.pdf)),
                kToShapes + i);
    }
  }

  // One of them, by what it would give without shadows.
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
      // Below the plane what stands in the mirrored direction is in the way.
      if (first && limited && glm::dot(path.at.geometric, to) < 0.0f) to = limited->mirrored(to);
      addShadow(p, to, near ? kShadowReach : kInfinity, radiance * (sum / share), kToPunctual);
      return;
    }
  }

  void gatherLights(bool first) {
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
      if (!blocked[i]) paths[shadows[i].path].sum += throughVolumes(shadows[i]);
  }

  glm::vec3 throughVolumes(const Shadow& shadow) const {
    if (world.volumes.empty()) return shadow.radiance;
    Stream random = stream(paths[shadow.path], shadow.light);
    return shadow.radiance * static_cast<float>(world.volumes.transmittance(
                                 shadow.ray, double{shadow.ray.far} / double{kShadowReach}, random));
  }

  void traceOccluded() {
    blocked.resize(rays.size());
    if (!rays.empty()) world.rays.occluded(rays, blocked);
    traced += rays.size();
  }

  // A direction for each path; those below the horizon end there.
  void scatter(bool first) {
    rays.clear();
    ray_path.clear();
    for (std::size_t p = 0; p < paths.size(); ++p) {
      Path& path = paths[p];
      if (!path.alive) continue;
      const glm::vec2 u = draw(path, kDirection);
      if (path.in_medium) {
        scatterInMedium(path, u, first);
      } else if (first && limited) {
        path.dir = limited->sample(u);
        path.pdf = limited->pdf(path.dir);
        path.throughput *= limited->kernelOfPair(path.dir) / path.pdf;
      } else if (path.at.glossy) {
        const Reflector& reflector = path.at.reflector;
        const float choice = draw(path, kLobe).x;
        path.dir = glm::normalize(reflector.world_from_local * reflector.sample(choice, u));
        const Scattering s = scattering(path, path.dir, first);
        path.pdf = s.pdf;
        path.throughput *= s.pdf > 0.0f ? s.value / s.pdf : glm::vec3(0.0f);
      } else {
        const glm::vec3 local = cosineDirection(u);
        path.dir = glm::normalize(frameAbout(path.at.shading) * local);
        path.pdf = local.z / kPi;
      }
      path.alive = (path.in_medium || glm::dot(path.at.geometric, path.dir) > 0.0f) &&
                   (path.throughput != glm::vec3(0.0f) || (first && limited));
      if (!path.alive) continue;
      rays.push_back({path.at.origin(), path.dir, kInfinity});
      ray_path.push_back(p);
    }
  }

  void scatterInMedium(Path& path, const glm::vec2& u, bool first) const {
    glm::vec3 dir(0.0f);
    if (!phaseIsLimited(first))
      dir = samplePhase(path.g, path.dir, u);
    else if (u.x < 0.5f)
      dir = samplePhase(path.g, path.dir, {2.0f * u.x, u.y});
    else
      dir = sphereDirection({2.0f * u.x - 1.0f, u.y});
    const Scattering s = phase(path, glm::dot(path.dir, dir), first);
    path.dir = dir;
    path.pdf = s.pdf;
    path.throughput *= s.value / s.pdf;
  }

  // Shapes that are sky, as seen from a point.
  sh::LightVector shapesFrom(const glm::vec3& point) const {
    sh::LightVector sum{.order = options.band_limit->in};
    for (const spec::LocalLight& shape : world.shapes) sum += shapeLight(shape, sum.order, point);
    return sum;
  }

  // The sky that a path of the first vertex finds blocked, of what FirstHit::open() has counted.
  void takeSky(Path& path) const { path.sum -= limited->skyOfPair(path.dir) / path.pdf; }

  void addSky(Path& path, bool first) {
    if (first && limited) return;
    Environment::Look sky = world.environment.look(path.dir);
    if (shapesAreSky())
      sky.radiance +=
          (first && !path.in_medium ? first_shapes : shapesFrom(path.at.origin())).evaluate(path.dir);
    const float weight = world.environment.sampled() ? powerHeuristic(path.pdf, sky.pdf) : 1.0f;
    path.sum += path.throughput * sky.radiance * weight;
  }

  // Shapes that the ray passes before it meets a surface at `far`.
  void addShapes(Path& path, float far) const {
    if (shapesAreSky()) return;
    for (const spec::LocalLight& shape : world.shapes)
      if (const auto way = lookAtShape(shape, path.at.origin(), path.dir);
          way && way->distance * kShadowReach < far)
        path.sum += path.throughput * way->radiance * powerHeuristic(path.pdf, way->pdf);
  }

  void addEmitted(Path& path, const Hit& hit, const SurfacePoint& there) const {
    if (there.emitted == glm::vec3(0.0f)) return;
    const glm::vec3 to = there.position - path.at.origin();
    const float facing = std::abs(glm::dot(there.geometric, path.dir));
    const float per_area = world.emissive.perArea(hit);
    const float weight =
        per_area > 0.0f ? powerHeuristic(path.pdf, per_area * glm::dot(to, to) / std::max(facing, 1e-12f))
                        : 1.0f;
    path.sum += path.throughput * there.emitted * weight;
  }

  // To where the directions lead; what shines there is added, and the paths stand at the next vertex.
  void advance(bool first) {
    collide();
    hits.resize(rays.size());
    if (!rays.empty()) world.rays.intersect(rays, hits);
    traced += rays.size();
    for (std::size_t i = 0; i < rays.size(); ++i) {
      Path& path = paths[ray_path[i]];
      const bool hit = hits[i].any();
      addShapes(path, hit ? hits[i].t : rays[i].far * kShadowReach);
      if (!hit && !collisions[i]) {
        addSky(path, first);
        path.alive = false;
        continue;
      }
      if (first && limited) takeSky(path);
      if (hit)
        arrive(path, hits[i]);
      else
        enterMedium(path, rays[i], *collisions[i]);
    }
  }

  // Rays end where a volume scatters, if nothing is before.
  void collide() {
    collisions.assign(rays.size(), std::nullopt);
    if (world.volumes.empty()) return;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      Stream random = stream(paths[ray_path[i]], kOnward);
      collisions[i] = world.volumes.collide(rays[i], double{kInfinity}, random);
      if (collisions[i]) rays[i].far = static_cast<float>(collisions[i]->t);
    }
  }

  void arrive(Path& path, const Hit& hit) const {
    const SurfacePoint there = world.surfaces.pointAt(hit, path.dir);
    path.alive = !there.blocked && !there.unlit;
    if (!path.alive) return;
    addEmitted(path, hit, there);
    path.at = there;
    path.in_medium = false;
    path.alive = ++path.reflections <= mostReflections();
  }

  void enterMedium(Path& path, const Ray& ray, const Volumes::Collision& collision) const {
    standInMedium(path, glm::vec3(glm::dvec3(ray.origin) + collision.t * glm::dvec3(ray.dir)),
                  world.volumes.medium(collision.volume));
    path.alive = options.bounces.value_or(1) > 0;
  }

  static void standInMedium(Path& path, const glm::vec3& position, const SceneVolume& medium) {
    path.at = {};
    path.at.position = position;
    path.at.albedo = medium.albedo;
    path.in_medium = path.scattered = true;
    path.g = medium.g;
  }

  std::uint32_t mostReflections() const {
    return options.bounces.value_or(world.volumes.empty() ? kMostVertices : kMostReflections);
  }

  // Where only the sky can be at the end of a ray, whether it is there is all that counts.
  void lookAtSky(bool first) {
    traceOccluded();
    for (std::size_t i = 0; i < rays.size(); ++i) {
      Path& path = paths[ray_path[i]];
      if (!blocked[i])
        addSky(path, first);
      else if (first && limited)
        takeSky(path);
    }
  }

  void playRoulette() {
    for (Path& path : paths) {
      if (!path.alive || (options.bounces && !path.scattered)) continue;
      const float survival = std::min(1.0f, largest(path.throughput));
      path.alive = survival > 0.0f && draw(path, kRouletteAndLamp).x < survival;
      path.throughput /= std::max(survival, 1e-20f);
    }
  }

  bool anyAlive() const {
    return std::any_of(paths.begin(), paths.end(), [](const Path& path) { return path.alive; });
  }

  // Reflected light of `layer`, a sum per replica.
  void reflect(std::uint32_t layer) {
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

  // Light that volumes scatter towards the eye, between two depths along its ray: paths begin in proportion
  // to what is lost of the view there.
  void scatterToEye(const EyeDepth& eye, const Ray& ray, std::uint32_t layer, double begin, double end) {
    limited.reset();
    turnTo(/*in_volume=*/true, layer, 0);
    const double share = -std::expm1(begin - end);
    for (Path& path : paths) {
      const glm::dvec2 u(draw(path, kPlaceInVolume));
      const double t = eye.place(std::min(begin - std::log1p(-u.x * share), end));
      standInMedium(path, glm::vec3(glm::dvec3(ray.origin) + t * glm::dvec3(ray.dir)),
                    world.volumes.medium(eye.pick(t, u.y)));
      path.dir = glm::vec3(glm::normalize(glm::dvec3(ray.dir)));
    }
    walk(/*in_volume=*/true, layer);
  }

  void walk(bool in_volume, std::uint32_t layer) {
    const bool emission_later = !world.emissive.empty() || !(world.shapes.empty() || shapesAreSky());
    for (std::uint32_t vertex = 0; anyAlive(); ++vertex) {
      turnTo(in_volume, layer, vertex);
      for (Path& path : paths)
        if (!path.at.glossy && !(vertex == 0 && limited)) path.throughput *= path.at.albedo;
      if (vertex > kFirstRoulette) playRoulette();
      gatherLights(vertex == 0);
      scatter(vertex == 0);
      if (world.volumes.empty() && vertex == mostReflections() && !emission_later) {
        if (!world.environment.dark() || shapesAreSky()) lookAtSky(vertex == 0);
        return;
      }
      advance(vertex == 0);
    }
  }
};

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
  const Ray ray = world_.eye.through(x, y);
  std::vector<Hit> layers;
  world_.rays.visible(ray, layers);
  out.rays = 1;
  double through = 1.0;
  // Volumes before layer i, from where the one before left off.
  std::optional<EyeDepth> eye;
  if (!world_.volumes.empty()) eye.emplace(world_.volumes, ray, world_.eye.eye(x, y), double{kInfinity});
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
    const bool blend =
        world_.surfaces.surfaces()[layers[layer].surface].material.alpha_mode == gltf::AlphaMode::Blend;
    const double weight = through * (blend ? std::clamp(double{point.alpha}, 0.0, 1.0) : 1.0);
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
