// Changes the radius, range, cones and strength of one light by handles in the picture. The light, its node's
// matrix (whose scale is ignored), a view and pixels come in; the changed light goes out, clamped to the
// ranges of its fields. Gizmo moves and turns lights, SunGizmo drags suns.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>

#include "editor/gizmo/projection.hpp"
#include "runtime/scene/components.hpp"

namespace lambent::editor {

enum class LightHandle : std::uint8_t { None, Radius, Range, InnerCone, OuterCone, Strength };
inline constexpr std::array kLightHandles = {LightHandle::Radius, LightHandle::Range, LightHandle::InnerCone,
                                             LightHandle::OuterCone, LightHandle::Strength};
// Returns the field that the handle sets: "radius", "inner_cone".
std::string_view lightHandleWord(LightHandle handle);

class LightGizmo {
 public:
  float hit_px = 8.0f;
  float size_px = 70.0f;  // length of cones and stalks that have no size in metres

  // Call both every frame. During a drag a new light is ignored.
  void setLight(const scene::LocalLightComponent& light, const glm::mat4& world_from_node);
  void setView(const spec::View& view, const Viewport& viewport);

  LightHandle hit(glm::vec2 pixel) const;
  void hover(glm::vec2 pixel) { hovered_ = hit(pixel); }
  bool press(glm::vec2 pixel);
  bool press(LightHandle handle, glm::vec2 pixel);
  bool dragging() const { return active_ != LightHandle::None; }
  LightHandle active() const { return active_; }
  scene::LocalLightComponent drag(glm::vec2 pixel);
  void release() { active_ = LightHandle::None; }

  // Returns the pixel of the handle, or none if this kind of light does not have it or it is not visible.
  std::optional<glm::vec2> handleScreenPoint(LightHandle handle) const;
  Painting paint() const;

 private:
  std::optional<glm::dvec3> handlePoint(LightHandle handle) const;
  std::optional<double> valueAt(LightHandle handle, const glm::dvec2& pixel) const;
  std::vector<glm::dvec3> circle(const glm::dvec3& center, const glm::dvec3& normal, double radius) const;
  double coneLength() const;
  glm::dvec3 coneSide() const;  // unit vector across the cone, towards its handles

  Projection projection_;
  scene::LocalLightComponent light_, start_;
  glm::dvec3 center_{0.0}, forward_{0.0, 0.0, -1.0};
  LightHandle hovered_ = LightHandle::None, active_ = LightHandle::None;
  glm::dvec2 start_pixel_{0.0};
  double start_value_ = 0.0;  // the value under the pointer when the drag began
};

}  // namespace lambent::editor
