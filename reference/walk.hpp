// Advances all paths of one pixel together. Every living path is at a vertex, on a surface or in a medium.
// Each step samples the lights from there, draws a direction, and traces all rays to the next vertex.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "reference/camera.hpp"
#include "reference/exit_kernel.hpp"
#include "reference/film.hpp"
#include "reference/options.hpp"
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
  glm::vec3 pass(const Hit& face);
  // Ends the ray. Returns what is left after volumes that it has entered and not left.
  glm::vec3 end() const { return inside_.any() ? absorbed(inside_, thicknessOf(inside_)) : glm::vec3(1.0f); }

 private:
  const gltf::Material& materialOf(const Hit& face) const {
    return surfaces_.surfaces()[face.surface].material;
  }
  float thicknessOf(const Hit& face) const { return materialOf(face).thickness_m; }
  glm::vec3 absorbed(const Hit& face, float length_m) const;

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

struct Walk {
  const World& world;
  const Options& options;
  std::uint32_t number;  // index of the pixel in the picture
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
  void turnTo(bool in_volume, std::uint32_t layer, std::uint32_t vertex);
  std::uint32_t pageSeed(bool in_volume, std::uint32_t layer, std::uint32_t page) const;

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
  Scattering scattering(const Path& path, const glm::vec3& dir, bool first) const;
  // Sums the BRDF over all directions that a ray stands for. At the first vertex the BRDF may be
  // band-limited.
  Scattering ofRay(const Path& path, const glm::vec3& ray, bool first) const;
  // Returns the ray direction for a direction (Horizons), with the same length.
  glm::vec3 rayFor(const Path& path, const glm::vec3& dir, bool first) const;
  // Returns whether paths can hit lights at a finite distance.
  bool findsLights() const {
    return !world.scene.emissive.empty() || !(world.shapes.empty() || shapesAreSky());
  }
  // Returns whether the first OUT bands replace the phase function at this vertex, as they replace the BRDF.
  // Directions are then drawn half from the phase function and half uniformly.
  bool phaseIsLimited(bool first) const { return first && options.band_limit && options.band_limit->out; }
  Scattering phase(const Path& path, float cosine, bool first) const;
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
  void gatherLights(bool first);
  void addShadow(std::size_t p, const glm::vec3& dir, float far, const glm::vec3& radiance,
                 std::uint32_t light);
  void lightFromSky(std::size_t p, bool first);
  void lightFromEmissive(std::size_t p, bool first);
  void lightFromShapes(std::size_t p, bool first);
  // Samples one punctual light in proportion to the unoccluded light of each.
  void lightFromPunctual(std::size_t p, bool first);
  glm::vec3 throughVolumes(const Shadow& shadow) const;
  void traceOccluded();
  // Returns what panes pass of the light along a ray.
  glm::vec3 passedOn(const Ray& ray);
  // Returns the SH of all shapes as seen from a point.
  sh::LightVector shapesFrom(const glm::vec3& point) const;
  // Subtracts the share of the sky that a path of the first vertex does not see, because FirstHit::open() has
  // counted it.
  void takeSky(Path& path, const glm::vec3& share) const;
  void addSky(Path& path, bool first);
  // Adds the shapes that the ray hits between `near` and the surface at `far`.
  void addShapes(Path& path, float near, float far) const;
  void addEmitted(Path& path, const Hit& hit, const SurfacePoint& there) const;

  // The steps are in walk.cpp. This one adds the light that the surface of `layer` reflects to the paths'
  // sums.
  void reflect(std::uint32_t layer);
  // Adds the light that volumes scatter towards the eye between two optical depths along its ray. Paths begin
  // in proportion to the extinction as seen from the eye.
  void scatterToEye(const EyeDepth& eye, const Ray& ray, std::uint32_t layer, double begin, double end);
  void walk(bool in_volume, std::uint32_t layer);
  // Samples a direction for each path. Paths end if it is below the horizon.
  void scatter(bool first);
  void scatterInMedium(Path& path, const glm::vec2& u, bool first) const;
  // Traces the directions, adds the light that they hit, and moves the paths to the next vertex.
  void advance(bool first);
  // Shortens rays to where a volume scatters.
  void collide();
  // Leads a path on its ray, which meets `hit` behind the panes, to one of them that reflects it, or past all
  // of them. Adds the shapes before what the path meets at last. Returns what panes pass.
  glm::vec3 meetPanes(Path& path, const Ray& ray, Hit& hit);
  void arrive(Path& path, const Hit& hit) const;
  void enterMedium(Path& path, const Ray& ray, const Volumes::Collision& collision) const;
  static void standInMedium(Path& path, const glm::vec3& position, const SceneVolume& medium);
  // Only tests whether rays reach the sky, for when they can hit no other light.
  void lookAtSky(bool first);
  void playRoulette();
};

}  // namespace lambent::baker::reference
