// The paths of one pixel, in step: every living path stands at its vertex, a surface's or a medium's; lights
// are looked for from there, a direction is drawn, and all rays travel together to the next.
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
inline constexpr std::uint32_t kMostVertices = 64;  // where --bounces is not given
// And volumes are about, between which and a white floor light goes to and fro. No matter that absorbs one in
// a hundred lets a path come near; only a closed room of perfect white does.
inline constexpr std::uint32_t kMostReflections = 4096;
inline constexpr float kShadowReach = 1.0f - 1e-4f;  // shadow rays end before the light's own surface

// The pairs of dimensions that one vertex draws.
enum Dimension : std::uint32_t {
  kDirection,
  kSkyPlace,
  kEmissivePlace,
  kChoices,
  kRouletteAndLamp,
  kPerVertex
};
// Shape i draws from dimensions of its own, beyond those of all layers.
inline constexpr std::uint32_t kPerShape = 1u << 20;
// And so does what part of a glossy surface draws the direction; and where a volume scatters towards the eye.
inline constexpr std::uint32_t kLobe = 1u << 31, kPlaceInVolume = 1u << 30;

// Which stream a vertex walks through media by: on its way, and towards each light.
enum Way : std::uint32_t { kOnward, kToSky, kToEmissive, kToPunctual, kToShapes };

inline float largest(const glm::vec3& v) {
  return std::max({std::abs(v.r), std::abs(v.g), std::abs(v.b)});
}

struct Path {
  SurfacePoint at;  // in a medium: no normals, the medium's albedo
  glm::vec3 throughput{1.0f}, sum{0.0f};
  std::uint32_t index = 0, replica = 0;  // which point of which replica
  glm::vec3 dir{0.0f};                   // that led here, in a medium; that leads on, once it is drawn
  // What the surface takes dir for, which is its mirror image where the surface would hide it (horizons.hpp).
  glm::vec3 towards{0.0f};
  float pdf = 0.0f;      // of towards, by the surface's own strategy
  float ray_pdf = 0.0f;  // of dir, by all that it is taken for; only where findsLights()
  bool alive = true;
  bool in_medium = false;         // where it stands
  float g = 0.0f;                 // of the medium
  bool scattered = false;         // in a medium, at any vertex
  std::uint32_t reflections = 0;  // surfaces that it has met since its first vertex

  void go(const glm::vec3& where, float density) {
    dir = towards = where;
    pdf = ray_pdf = density;
  }
};
// A light's contribution that counts if nothing is in the way.
struct Shadow {
  Ray ray;
  std::size_t path;
  glm::vec3 radiance;
  std::uint32_t light;  // which of the path's
};

struct Walk {
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
  void turnTo(bool in_volume, std::uint32_t layer, std::uint32_t vertex);
  std::uint32_t pageSeed(bool in_volume, std::uint32_t layer, std::uint32_t page) const;

  glm::vec2 draw(const Path& path, std::uint32_t which) const {
    return samplers[path.replica].pair(dimension + which, path.index);
  }
  Stream stream(const Path& path, std::uint32_t way) const {
    return samplers[path.replica].stream(dimension, path.index, way);
  }

  // What share of the light from dir is reflected, times the cosine, of diffuse surfaces without the albedo;
  // and the density of dir by the surface's own strategy.
  struct Scattering {
    glm::vec3 value{0.0f};
    float pdf = 0.0f;
  };
  // Of one direction, by the whole BRDF.
  Scattering scattering(const Path& path, const glm::vec3& dir, bool first) const;
  // Of what stands in the way of a ray: of all directions that see it, at the first vertex with what
  // --band-limit leaves of the BRDF.
  Scattering ofRay(const Path& path, const glm::vec3& ray, bool first) const;
  // The ray that tells what a direction sees, of the same length.
  glm::vec3 rayFor(const Path& path, const glm::vec3& dir, bool first) const;
  // Whether paths can find what shines at a place of its own.
  bool findsLights() const { return !world.emissive.empty() || !(world.shapes.empty() || shapesAreSky()); }
  // Of the phase function the first OUT bands are as much a kernel as those of a BRDF, and drawn half from
  // the whole, half evenly.
  bool phaseIsLimited(bool first) const { return first && options.band_limit && options.band_limit->out; }
  Scattering phase(const Path& path, float cosine, bool first) const;
  // Cut to their bands, spheres and discs shine from all over the sky, as seen from each point, and signed.
  bool shapesAreSky() const { return options.band_limit.has_value() && !world.shapes.empty(); }
  std::uint32_t mostReflections() const {
    return options.bounces.value_or(world.volumes.empty() ? kMostVertices : kMostReflections);
  }
  bool anyAlive() const {
    return std::any_of(paths.begin(), paths.end(), [](const Path& path) { return path.alive; });
  }

  // What shines, in walk_lights.cpp: next-event estimation towards discs and probes, an emissive triangle,
  // shapes, a punctual light; and what a direction finds by itself.
  void gatherLights(bool first);
  void addShadow(std::size_t p, const glm::vec3& dir, float far, const glm::vec3& radiance,
                 std::uint32_t light);
  void lightFromSky(std::size_t p, bool first);
  void lightFromEmissive(std::size_t p, bool first);
  void lightFromShapes(std::size_t p, bool first);
  // One of them, by what it would give without shadows.
  void lightFromPunctual(std::size_t p, bool first);
  glm::vec3 throughVolumes(const Shadow& shadow) const;
  void traceOccluded();
  // Shapes that are sky, as seen from a point.
  sh::LightVector shapesFrom(const glm::vec3& point) const;
  // The sky that a path of the first vertex finds blocked, of what FirstHit::open() has counted.
  void takeSky(Path& path) const;
  void addSky(Path& path, bool first);
  // Shapes that the ray passes before it meets a surface at `far`.
  void addShapes(Path& path, float far) const;
  void addEmitted(Path& path, const Hit& hit, const SurfacePoint& there) const;

  // Steps, in walk.cpp.
  // Reflected light of `layer`, a sum per replica.
  void reflect(std::uint32_t layer);
  // Light that volumes scatter towards the eye, between two depths along its ray: paths begin in proportion
  // to what is lost of the view there.
  void scatterToEye(const EyeDepth& eye, const Ray& ray, std::uint32_t layer, double begin, double end);
  void walk(bool in_volume, std::uint32_t layer);
  // A direction for each path; those below the horizon end there.
  void scatter(bool first);
  void scatterInMedium(Path& path, const glm::vec2& u, bool first) const;
  // To where the directions lead; what shines there is added, and the paths stand at the next vertex.
  void advance(bool first);
  // Rays end where a volume scatters, if nothing is before.
  void collide();
  void arrive(Path& path, const Hit& hit) const;
  void enterMedium(Path& path, const Ray& ray, const Volumes::Collision& collision) const;
  static void standInMedium(Path& path, const glm::vec3& position, const SceneVolume& medium);
  // Where only the sky can be at the end of a ray, whether it is there is all that counts.
  void lookAtSky(bool first);
  void playRoulette();
};

}  // namespace lambent::baker::reference
