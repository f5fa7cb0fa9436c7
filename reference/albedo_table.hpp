// Tabulates the directional albedo of the GGX lobe by view direction, roughness and anisotropy, as the two
// factors of F0 and F90. The diffuse part of a material is reduced by this albedo. The reference integrates
// the table itself, with an error of 0.1 % (anisotropic: 0.5 %).
#pragma once

#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace lambent::baker::reference {

class AlbedoTable {
 public:
  AlbedoTable() = default;
  static AlbedoTable build(bool anisotropic);

  bool empty() const { return values_.empty(); }
  // Returns the factors of F0 and F90. `view` is a unit vector in local space with z > 0; roughness and
  // strength are 0..1.
  glm::vec2 at(const glm::vec3& view, float roughness, float strength) const;

 private:
  std::size_t angles_ = 0, azimuths_ = 1, roughnesses_ = 0, strengths_ = 1;
  std::vector<glm::vec2> values_;  // [strength][roughness][azimuth][angle]
};

}  // namespace lambent::baker::reference
