// An Environment is the distant light as paths see it. The distant lights, their rotation and the band limit
// come in. Without a band limit the light consists of a constant, discs with sharp edges, and environment
// maps whose texels are constant over their area; discs and environment maps can be sampled in proportion to
// their radiance. Band-limited light is given by its signed spherical harmonics and can only be evaluated.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "reference/reference.hpp"
#include "reference/surfaces.hpp"
#include "runtime/base/change_gate.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/spec/distant_lights.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::baker::reference {

class Environment {
 public:
  // `band_limit` is the number of SH bands, or 0 for no limit.
  Environment(spec::DistantLights lights, float turn_degrees, int band_limit);

  // Returns the radiance that an eye ray sees, as the runtime draws its sky: environment maps are
  // interpolated bilinearly, and the edges of discs are smoothed over a pixel.
  glm::vec3 shown(const glm::vec3& dir, float pixel_angle_rad) const;

  // Returns whether directions can be sampled, which is the case for discs and environment maps but not for
  // constant and band-limited light.
  bool sampled() const { return !parts_.empty(); }
  // Returns a unit direction in world space, or occasionally (at the border of an angular map) a zero vector.
  // `choice` selects a light, `u` a direction within it.
  glm::vec3 sample(float choice, const glm::vec2& u) const;
  // A Look is the radiance from dir, and the density per steradian with which sample() draws dir.
  struct Look {
    glm::vec3 radiance{0.0f};
    float pdf = 0.0f;
  };
  Look look(const glm::vec3& dir) const;
  bool dark() const { return dark_; }
  const spec::DistantLights& lights() const { return lights_; }
  // Returns the light as spherical harmonics in world space, rotated, and cut to the band limit if there is
  // one.
  const sh::LightVector& lightVector() const { return vector_; }

 private:
  // Samples texels by a cumulative distribution over rows and one within each row, which preserves
  // stratification.
  struct Distribution {
    std::vector<float> rows, columns;  // both begin with 0 and end with 1; columns do so in each row
    std::vector<glm::vec4> texels;     // radiance, and the probability of the texel
  };
  struct Part {
    double probability = 0.0;
    std::size_t environment_map = 0;  // index of the environment map, unless is_disc
    std::size_t disc = 0;
    bool is_disc = false;
  };
  struct Cone {
    glm::mat3 frame{1.0f};  // in the lights' frame; z is the centre
    float cap = 0.0f;       // 1 - cos of the radius
  };

  Look lookAtEnvironmentMap(std::size_t environment_map, const glm::dvec3& dir) const;
  bool inside(const Cone& cone, const glm::vec3& dir) const;
  void addEnvironmentMap(std::size_t environment_map);

  spec::DistantLights lights_;
  glm::mat3 world_from_light_{1.0f};
  int band_limit_ = 0;
  sh::LightVector vector_;
  bool dark_ = true;
  std::vector<Cone> cones_;
  std::vector<Distribution> distributions_;
  std::vector<Part> parts_;
};

// Samples the lights of a scene: emissive triangles, by area in proportion to their power, and punctual
// lights (KHR_lights_punctual). The scene and its surfaces come in; points and directions for next-event
// estimation, with their densities, go out. Surfaces emit from their front, double-sided ones from both
// sides; unlit and blended surfaces emit nothing.

class EmissiveTriangles {
 public:
  explicit EmissiveTriangles(const Surfaces& surfaces);

  bool empty() const { return triangles_.empty(); }

  struct Sample {
    Hit hit;  // a point on the triangle
    glm::vec3 position{0.0f};
    glm::vec3 normal{0.0f};  // unit normal of the front side
    bool double_sided = false;
    float per_area = 0.0f;  // density of the sample per square metre
  };
  Sample sample(float choice, const glm::vec2& u) const;
  // Returns the density per square metre with which sample() finds a point on this triangle.
  float perArea(const Hit& hit) const;

 private:
  const Surfaces& surfaces_;
  std::vector<std::uint32_t> triangles_, surface_of_;
  std::vector<double> cumulated_;  // cumulative distribution over triangles_, from 0 to 1
  std::vector<float> per_area_;    // per triangle of all surfaces; empty if nothing emits
};

struct PunctualLight {
  gltf::Light light;
  glm::vec3 position{0.0f};
  glm::vec3 along{0.0f, 0.0f, -1.0f};  // unit direction of the light's axis
};

std::vector<PunctualLight> punctualLights(const Scene& scene);

// A Beam is what a punctual light sends to a point, as the irradiance of a surface that faces it.
struct Beam {
  glm::vec3 to_light{0.0f};  // unit direction
  float distance = 0.0f;     // in metres; infinite for directional lights
  glm::vec3 irradiance{0.0f};
};
// Returns nothing if no light arrives at the position.
std::optional<Beam> beamAt(const PunctualLight& light, const glm::vec3& position);

// Samples the sphere and disc lights of uniform radiance that light words add to a scene. They are no
// surfaces: eye rays pass through them and they cast no shadow, but surfaces in front of them block their
// light. A light, a point, and two random numbers or a direction come in. A direction to the light with its
// density per steradian goes out: uniform over the cone of a sphere, or uniform over the area of a disc.
// Inside a sphere there is no such density, because it fills all directions. A light of radius 0 is never
// hit.

// A WayToLight is a direction from a point towards a light.
struct WayToLight {
  glm::vec3 dir{0.0f};  // unit
  float distance = 0.0f;
  glm::vec3 radiance{0.0f};
  float pdf = 0.0f;  // density with which sampleShape() draws dir; 0 if it cannot
};

// Samples a direction towards the light. Returns nothing if no light arrives, and inside a sphere.
std::optional<WayToLight> sampleShape(const spec::LocalLight& light, const glm::vec3& point,
                                      const glm::vec2& u);

// Returns what the unit direction dir sees, or nothing if it misses the light or hits the back of a disc.
std::optional<WayToLight> lookAtShape(const spec::LocalLight& light, const glm::vec3& point,
                                      const glm::vec3& dir);

// Returns the first SH bands of the unoccluded light at the point, as a light probe there would store it.
sh::LightVector shapeLight(const spec::LocalLight& light, int order, const glm::vec3& point);

// Caches the last distant light, because loading environment maps and preparing them for sampling is slow and
// successive pictures mostly have the same light. Use it from one thread.
class LightCache {
 public:
  // Returns the environment of these lights. Lights are compared by their words, so an environment map that
  // changed on disk is not loaded again. `factors` and `more` are as in Request; with factors of 1 the light
  // has the bits of loadDistantLights(). Errors: an environment map cannot be loaded.
  Result<std::shared_ptr<const Environment>> environment(
      const std::vector<spec::Light>& lights, const std::vector<float>& factors, const Options& options,
      const std::shared_ptr<const spec::DistantLights>& more = {});
  // Returns what was repaired in the environment maps, one sentence each.
  const std::vector<std::string>& notices() const { return notices_; }

 private:
  ChangeGate<std::vector<spec::Light>> loaded_from_;  // the distant ones
  std::vector<spec::DistantLights> loaded_;           // one per light
  std::vector<std::string> notices_;
  // Factors, more light, rotation and band limit.
  ChangeGate<std::vector<float>, std::shared_ptr<const spec::DistantLights>, float, int> made_from_;
  std::shared_ptr<const Environment> environment_;
};

}  // namespace lambent::baker::reference
