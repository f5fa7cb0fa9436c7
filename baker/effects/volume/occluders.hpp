// Holds the surfaces that a volume never moves against, for its rays to hit.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>

#include "baker/transport/ray_scene.hpp"

namespace lambent::baker {

class Occluders {
 public:
  Occluders() = default;  // none
  // `scene_from_group` maps the volume's frame to that of the rays' scene; it is a rotation and a
  // translation.
  Occluders(const RayScene& rays, const glm::mat4& scene_from_group)
      : rays_(&rays), scene_from_group_(scene_from_group) {}

  bool any() const { return rays_ != nullptr; }

  // Computes how far each ray from `origin` gets, in metres; infinity if it hits nothing.
  void reach(const glm::vec3& origin, std::span<const glm::vec3> directions,
             std::span<float> distances) const {
    constexpr float kFar = std::numeric_limits<float>::infinity();
    if (rays_ == nullptr) {
      std::fill(distances.begin(), distances.end(), kFar);
      return;
    }
    const glm::vec3 from(scene_from_group_ * glm::vec4(origin, 1.0f));
    std::vector<RaySegment> segments(directions.size());
    for (std::size_t i = 0; i < segments.size(); ++i)
      segments[i] = {from, glm::vec3(scene_from_group_ * glm::vec4(directions[i], 0.0f)), kFar};
    std::vector<FirstHit> hits(segments.size());
    rays_->firstHits(segments, hits);
    for (std::size_t i = 0; i < hits.size(); ++i) distances[i] = hits[i].distance;
  }

 private:
  const RayScene* rays_ = nullptr;
  glm::mat4 scene_from_group_{1.0f};
};

}  // namespace lambent::baker
