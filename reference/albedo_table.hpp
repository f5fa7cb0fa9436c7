// Directional albedo of the GGX lobe in its two parts, those that F0 and F90 multiply, by view, roughness and
// anisotropy: what the diffuse part of a material must leave to the specular one. Integrated by the reference
// itself, good to 0.1 % (anisotropic: 0.5 %).
#pragma once

#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace lambent::baker::reference {

class AlbedoTable {
 public:
  AlbedoTable() = default;  // none
  static AlbedoTable build(bool anisotropic);

  bool empty() const { return values_.empty(); }
  // Local unit view with z > 0; roughness and strength 0..1.
  glm::vec2 at(const glm::vec3& view, float roughness, float strength) const;

 private:
  std::size_t angles_ = 0, azimuths_ = 1, roughnesses_ = 0, strengths_ = 1;
  std::vector<glm::vec2> values_;  // [strength][roughness][azimuth][angle]
};

}  // namespace lambent::baker::reference
