// Follows a ray through the faces of panes (KHR_materials_transmission) and says what they pass of the light:
// each face its share (Surfaces::passedAt), and the volume between entry and exit what Beer's law leaves of
// it. Where the other face is missing, KHR_materials_volume's thickness counts.
#pragma once

#include "reference/ray_tracer.hpp"

namespace lambent::baker::reference {

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

}  // namespace lambent::baker::reference
