// A Walk advances the paths of one pixel in step. Every living path stands at a vertex, on a surface or in a
// medium. Lights are sampled from there, a direction is drawn, and all rays travel together to the next
// vertex.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "reference/exit_kernel.hpp"
#include "reference/eye_depth.hpp"
#include "reference/options.hpp"
#include "reference/sampler.hpp"
#include "reference/world.hpp"

namespace lambent::baker::reference {

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();
inline constexpr std::uint32_t kMostVertices = 64;  // limit of vertices without --bounces
// The same limit in scenes with volumes, where light goes to and fro between a volume and a white floor. If
// any matter absorbs one in a hundred, no path comes near it; only a closed room of perfect white does.
inline constexpr std::uint32_t kMostReflections = 4096;
inline constexpr float kShadowReach = 1.0f - 1e-4f;  // shadow rays end before the light's own surface

// These are the pairs of dimensions that one vertex draws from.
enum Dimension : std::uint32_t {
  kDirection,
  kSkyPlace,
  kEmissivePlace,
  kChoices,
  kRouletteAndLamp,
  kPerVertex
};
// Light shape i draws from dimensions of its own, beyond those of all layers.
inline constexpr std::uint32_t kPerShape = 1u << 20;
// So do the choice of a glossy surface's lobe, and the place where a volume scatters towards the eye.
inline constexpr std::uint32_t kLobe = 1u << 31, kPlaceInVolume = 1u << 30;

// These are the streams of a vertex for walks through media: one for its own path, and one towards each
// light.
enum Way : std::uint32_t { kOnward, kToSky, kToEmissive, kToPunctual, kToShapes };

inline float largest(const glm::vec3& v) {
  return std::max({std::abs(v.r), std::abs(v.g), std::abs(v.b)});
}

struct Path {
  SurfacePoint at;  // in a medium: no normals, and the medium's albedo
  glm::vec3 throughput{1.0f}, sum{0.0f};
  std::uint32_t index = 0, replica = 0;  // index of its point, in its replica
  // In a medium, this is the direction that led here; once drawn, it is the one that leads on.
  glm::vec3 dir{0.0f};
  // The BRDF is evaluated for this direction: dir, or its mirror image if the surface would hide that
  // (horizons.hpp).
  glm::vec3 towards{0.0f};
  float pdf = 0.0f;      // of towards, by the BRDF's own strategy
  float ray_pdf = 0.0f;  // of dir, summed over all directions that it stands for; only if findsLights()
  bool alive = true;
  bool in_medium = false;         // at its present vertex
  float g = 0.0f;                 // of the medium
  bool scattered = false;         // in a medium, at any vertex so far
  std::uint32_t reflections = 0;  // surfaces that it has met since its first vertex

  void go(const glm::vec3& where, float density) {
    dir = towards = where;
    pdf = ray_pdf = density;
  }
};
// A Shadow is a light's contribution that counts if nothing is in the way.
struct Shadow {
  Ray ray;
  std::size_t path;
  glm::vec3 radiance;
  std::uint32_t light;  // index of the path's stream
};

struct Walk {
  const World& world;
  const Options& options;
  std::uint32_t number;  // number of the pixel
  std::uint32_t pixel = combine(options.seed, number);
  std::array<Sampler, 2> firsts = samplersOf(options.seed);  // for first vertices of layers
  std::array<Sampler, 2> samplers = firsts;                  // for the current vertex
  std::uint32_t dimension = 0;                               // first dimension of the current vertex
  std::vector<Path> paths = {};
  std::vector<Shadow> shadows = {};
  std::vector<Ray> rays = {};
  std::vector<std::size_t> ray_path = {};
  std::vector<Hit> hits = {};
  std::vector<std::optional<Volumes::Collision>> collisions = {};
  std::vector<std::uint8_t> blocked = {};
  sh::LightVector first_shapes = {};     // light of shapes as sky, at the first vertex, where all paths stand
  std::optional<FirstHit> limited = {};  // with --band-limit IN,OUT: the first vertex, where all paths stand
  std::uint64_t traced = 0;

  std::array<Sampler, 2> samplersOf(std::uint32_t seed) const {
    return {Sampler(seed, number, 0), Sampler(seed, number, 1)};
  }
  // The first vertices of layers draw from one sampler, so that its first few dimensions, which are spread
  // best, go to them. The other vertices, and those of paths that begin in a volume, use one sampler for each
  // `kPage`.
  void turnTo(bool in_volume, std::uint32_t layer, std::uint32_t vertex);
  std::uint32_t pageSeed(bool in_volume, std::uint32_t layer, std::uint32_t page) const;

  glm::vec2 draw(const Path& path, std::uint32_t which) const {
    return samplers[path.replica].pair(dimension + which, path.index);
  }
  Stream stream(const Path& path, std::uint32_t way) const {
    return samplers[path.replica].stream(dimension, path.index, way);
  }

  // The share of the light from dir that is reflected, times the cosine (for diffuse surfaces without the
  // albedo), and the density of dir by the BRDF's own strategy.
  struct Scattering {
    glm::vec3 value{0.0f};
    float pdf = 0.0f;
  };
  // Evaluates the whole BRDF for one direction.
  Scattering scattering(const Path& path, const glm::vec3& dir, bool first) const;
  // Sums over all directions that a ray stands for. At the first vertex this uses what --band-limit leaves of
  // the BRDF.
  Scattering ofRay(const Path& path, const glm::vec3& ray, bool first) const;
  // Returns the ray that shows what a direction sees; it has the same length.
  glm::vec3 rayFor(const Path& path, const glm::vec3& dir, bool first) const;
  // Returns whether paths can find light sources that are at a finite distance.
  bool findsLights() const { return !world.emissive.empty() || !(world.shapes.empty() || shapesAreSky()); }
  // The first OUT bands of the phase function are a kernel just like those of a BRDF; directions are then
  // drawn half from the whole phase function and half evenly.
  bool phaseIsLimited(bool first) const { return first && options.band_limit && options.band_limit->out; }
  Scattering phase(const Path& path, float cosine, bool first) const;
  // With a band limit, spheres and discs shine from all over the sky, as seen from each point, and signed.
  bool shapesAreSky() const { return options.band_limit.has_value() && !world.shapes.empty(); }
  std::uint32_t mostReflections() const {
    return options.bounces.value_or(world.volumes.empty() ? kMostVertices : kMostReflections);
  }
  bool anyAlive() const {
    return std::any_of(paths.begin(), paths.end(), [](const Path& path) { return path.alive; });
  }

  // These are in walk_lights.cpp: next-event estimation towards discs and environment maps, an emissive
  // triangle, shapes and a punctual light; and light that a path's own direction finds.
  void gatherLights(bool first);
  void addShadow(std::size_t p, const glm::vec3& dir, float far, const glm::vec3& radiance,
                 std::uint32_t light);
  void lightFromSky(std::size_t p, bool first);
  void lightFromEmissive(std::size_t p, bool first);
  void lightFromShapes(std::size_t p, bool first);
  // Samples one punctual light by what each would give without shadows.
  void lightFromPunctual(std::size_t p, bool first);
  glm::vec3 throughVolumes(const Shadow& shadow) const;
  void traceOccluded();
  // Returns the light of shapes that count as sky, as seen from a point.
  sh::LightVector shapesFrom(const glm::vec3& point) const;
  // Subtracts the sky that a path of the first vertex finds blocked, since FirstHit::open() has counted it.
  void takeSky(Path& path) const;
  void addSky(Path& path, bool first);
  // Adds shapes that the ray passes before it meets a surface at `far`.
  void addShapes(Path& path, float far) const;
  void addEmitted(Path& path, const Hit& hit, const SurfacePoint& there) const;

  // The steps are in walk.cpp. This one adds the reflected light of `layer`, one sum per replica.
  void reflect(std::uint32_t layer);
  // Adds light that volumes scatter towards the eye between two depths along its ray. Paths begin in
  // proportion to the extinction of the view there.
  void scatterToEye(const EyeDepth& eye, const Ray& ray, std::uint32_t layer, double begin, double end);
  void walk(bool in_volume, std::uint32_t layer);
  // Draws a direction for each path; paths end if it is below the horizon.
  void scatter(bool first);
  void scatterInMedium(Path& path, const glm::vec2& u, bool first) const;
  // Follows the directions, adds the light that they find, and moves the paths to the next vertex.
  void advance(bool first);
  // Ends rays where a volume scatters.
  void collide();
  void arrive(Path& path, const Hit& hit) const;
  void enterMedium(Path& path, const Ray& ray, const Volumes::Collision& collision) const;
  static void standInMedium(Path& path, const glm::vec3& position, const SceneVolume& medium);
  // Only tests whether rays reach the sky, when nothing else can be at their end.
  void lookAtSky(bool first);
  void playRoulette();
};

}  // namespace lambent::baker::reference
