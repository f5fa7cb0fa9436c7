// Presents a baked volume as a body: the light that it lets through, and the light that it scatters
// (baker/effects/volume/volume_light.hpp).
#pragma once

#include "baker/effects/neighborhood/body.hpp"
#include "baker/effects/volume/volume_light.hpp"

namespace lambent::baker {

class VolumeBody : public Body {
 public:
  // `light` must outlive this. The bounds are those of the volume, in its group's frame. Without `scatters`
  // it only stops light.
  VolumeBody(const VolumeLight& light, const glm::vec3& bounds_min, const glm::vec3& bounds_max,
             bool scatters);

  int order() const override { return light_.order(); }
  std::uint32_t channels() const override { return scatters_ ? 3 : 0; }
  glm::vec3 centre() const override { return centre_; }
  float radius() const override { return radius_; }
  void look(const glm::vec3& from, const DirectionPacket& along, std::size_t first_ray, bool with_light,
            BodyLook& out) const override;

 private:
  const VolumeLight& light_;
  glm::vec3 centre_;
  float radius_;
  bool scatters_;
};

}  // namespace lambent::baker
