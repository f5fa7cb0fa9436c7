#include "reference/walk.hpp"

namespace lambent::baker::reference {

namespace {

// Panes reflect at least this share of the paths that meet them from a side that reflects.
constexpr float kLeastReflected = 0.02f;
constexpr std::uint32_t kFirstRoulette = 4;  // bounces before Russian roulette begins

// Moves all paths of a pixel together. Each step gathers light at the paths' vertices, draws a direction, and
// traces all rays to the next vertex.
struct Walk : PixelPaths {
  // Adds the light that the surface of `layer` reflects to the paths' sums.
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
  // Adds the light that volumes scatter towards the eye between two optical depths along its ray. Paths begin
  // in proportion to the extinction as seen from the eye.
  void scatterToEye(const EyeDepth& eye, const Ray& ray, std::uint32_t layer, double begin, double end) {
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
  void walk(bool in_volume, std::uint32_t layer) {
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
  // Samples a direction for each path. Paths end if it is below the horizon.
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
  void scatterInMedium(Path& path, const glm::vec2& u, bool first) const {
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
  // Traces the directions, adds the light that they hit, and moves the paths to the next vertex.
  void advance(bool first) {
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
  // Shortens rays to where a volume scatters.
  void collide() {
    collisions.assign(rays.size(), std::nullopt);
    if (world.scene.volumes.empty()) return;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      Stream random = stream(paths[ray_path[i]], kOnward);
      collisions[i] = world.scene.volumes.collide(rays[i], double{kInfinity}, random);
      if (collisions[i]) rays[i].far = static_cast<float>(collisions[i]->t);
    }
  }
  // Leads a path on its ray, which meets `hit` behind the panes, to one of them that reflects it, or past all
  // of them. Adds the shapes before what the path meets at last. Returns what panes pass.
  glm::vec3 meetPanes(Path& path, const Ray& ray, Hit& hit) {
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
  void arrive(Path& path, const Hit& hit) const {
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
  void enterMedium(Path& path, const Ray& ray, const Volumes::Collision& collision) const {
    standInMedium(path, glm::vec3(glm::dvec3(ray.origin) + collision.t * glm::dvec3(ray.dir)),
                  world.scene.volumes.medium(collision.volume));
    path.alive = options.bounces.value_or(1) > 0;
  }
  static void standInMedium(Path& path, const glm::vec3& position, const SceneVolume& medium) {
    path.at = {};
    path.at.position = position;
    path.at.albedo = medium.albedo;
    path.in_medium = path.scattered = true;
    path.g = medium.g;
  }
  // Only tests whether rays reach the sky, for when they can hit no other light.
  void lookAtSky(bool first) {
    traceOccluded();
    for (std::size_t i = 0; i < rays.size(); ++i) {
      Path& path = paths[ray_path[i]];
      const glm::vec3 passed = blocked[i] ? glm::vec3(0.0f) : passedOn(rays[i]);
      path.throughput *= passed;
      if (!blocked[i]) addSky(path, first);
      if (first && limited && passed != glm::vec3(1.0f)) takeSky(path, 1.0f - passed);
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
};

}  // namespace

PixelSum tracePixel(const World& world, std::uint32_t x, std::uint32_t y, std::uint32_t first,
                    std::uint32_t count) {
  Walk walk{{.world = world, .number = y * world.options.size.width + x}};
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
    return world.scene.surfaces.surfaces()[hit.surface].material;
  };
  const auto blended = [&](const Hit& hit) { return materialOf(hit).alpha_mode == gltf::AlphaMode::Blend; };
  const Ray ray = world.eye.through(x, y);
  std::vector<Hit> layers;
  world.scene.rays->visible(ray, layers);
  out.rays = 1;
  // Depth ignores blended surfaces, panes and volumes, as the runtime's depth buffer does.
  if (!layers.empty() && !blended(layers.back()) && !materialOf(layers.back()).transmits())
    out.depth = world.eye.depthOf(glm::dvec3(ray.origin) + double{layers.back().t} * glm::dvec3(ray.dir));
  glm::dvec3 through(1.0);
  const auto any = [&] { return through.r > 0.0 || through.g > 0.0 || through.b > 0.0; };
  // Each step adds the volumes in front of layer i, from the previous layer on.
  std::optional<EyeDepth> eye;
  if (!world.scene.volumes.empty()) eye.emplace(world.scene.volumes, ray, 0.0, double{kInfinity});
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
  PaneWay panes(world.scene.surfaces, ray);
  for (; layer < layers.size() && any(); ++layer) {
    passVolumes(layer);
    const SurfacePoint point = world.scene.surfaces.pointAt(layers[layer], ray.dir);
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
    addAlike(through * glm::dvec3(world.environment.shown(glm::vec3(glm::normalize(glm::dvec3(ray.dir))),
                                                          world.eye.pixelAngle())));
  out.alpha = 1.0 - (through.r + through.g + through.b) / 3.0;
  out.rays += walk.traced;
  return out;
}

}  // namespace lambent::baker::reference
