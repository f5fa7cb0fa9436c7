// Samples the lights of a scene: emissive triangles, by area in proportion to their power, and punctual
// lights (KHR_lights_punctual). The scene and its surfaces come in; points and directions for next-event
// estimation, with their densities, go out. Surfaces emit from their front, double-sided ones from both
// sides; unlit and blended surfaces emit nothing.
#pragma once

#include <optional>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "reference/surfaces.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::baker::reference {

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

}  // namespace lambent::baker::reference
