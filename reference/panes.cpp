#include "reference/panes.hpp"

#include <utility>

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>

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

}  // namespace lambent::baker::reference
