// Samples the lights of a scene: emissive triangles, by area in proportion to their power, and punctual
// lights (KHR_lights_punctual). The scene and its surfaces come in; points and directions for next-event
// estimation, with their densities, go out. Surfaces emit from their front, double-sided ones from both
// sides; unlit and blended surfaces emit nothing.
#pragma once

#include <optional>
#include <vector>

#include "reference/surfaces.hpp"

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

}  // namespace lambent::baker::reference
