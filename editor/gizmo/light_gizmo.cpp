#include "editor/gizmo/light_gizmo.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>

#include "editor/gizmo/projection.hpp"
#include "runtime/scene/reflection.hpp"

namespace lambent::editor {
namespace {

using Kind = scene::LocalLightComponent::Kind;
constexpr double kHalfPi = 0.5 * std::numbers::pi;
constexpr double kPixelsPerStop = 40.0;  // of Strength; a stop is a factor of two
constexpr float kFaintest = 0.01f;       // strength from which a light that is off is dragged up

// Clamps the value to the field's range.
float fitted(std::string_view field, double value) {
  const auto info = scene::findField("Light", field);
  const auto range = info ? (*info)->range : std::nullopt;
  const auto number = static_cast<float>(value);
  return range ? std::clamp(number, range->least, range->greatest) : number;
}

bool hasHandle(Kind kind, LightHandle handle) {
  if (handle == LightHandle::Radius) return kind == Kind::Sphere || kind == Kind::Disc;
  if (handle == LightHandle::Range) return kind == Kind::Point || kind == Kind::Spot;
  if (handle == LightHandle::Strength) return true;
  return handle != LightHandle::None && kind == Kind::Spot;  // the cones
}

// Returns a unit vector perpendicular to `axis` that lies as much in the picture's plane as possible.
glm::dvec3 acrossInPicture(const glm::dvec3& axis, const Projection& projection) {
  for (const glm::dvec3& candidate : {projection.right(), projection.up()}) {
    const glm::dvec3 side = candidate - glm::dot(candidate, axis) * axis;
    if (glm::length(side) > 0.3) return glm::normalize(side);
  }
  return glm::normalize(glm::cross(axis, projection.back()));
}

}  // namespace

std::string_view lightHandleWord(LightHandle handle) {
  constexpr std::string_view kWords[] = {"none", "radius", "range", "inner_cone", "outer_cone", "strength"};
  return kWords[static_cast<std::size_t>(handle)];
}

void LightGizmo::setLight(const scene::LocalLightComponent& light, const glm::mat4& world_from_node) {
  if (dragging()) return;
  light_ = light;
  center_ = glm::dvec3(world_from_node[3]);
  const glm::dvec3 back(world_from_node[2]);
  const double length = glm::length(back);
  forward_ = length > 0.0 ? -back / length : glm::dvec3(0.0, 0.0, -1.0);
}

void LightGizmo::setView(const spec::View& view, const Viewport& viewport) {
  projection_ = Projection(view, viewport);
}

double LightGizmo::coneLength() const {
  const double pixels = projection_.pixelsPerMetre(center_);
  return pixels > 0.0 ? 1.4 * size_px / pixels : 0.0;
}

// The vector is chosen so that it and forward_ span the plane that faces the viewer best.
glm::dvec3 LightGizmo::coneSide() const {
  const glm::dvec3 side = glm::cross(forward_, projection_.toEye(center_));
  const double length = glm::length(side);
  return length > 0.2 ? side / length : acrossInPicture(forward_, projection_);
}

std::optional<glm::dvec3> LightGizmo::handlePoint(LightHandle handle) const {
  const double pixels = projection_.pixelsPerMetre(center_);
  if (!hasHandle(light_.kind, handle) || !(pixels > 0.0)) return std::nullopt;
  const double size = size_px / pixels;
  switch (handle) {
    case LightHandle::Radius: {
      const glm::dvec3 side =
          light_.kind == Kind::Disc ? acrossInPicture(forward_, projection_) : projection_.right();
      return center_ + std::max(double{light_.radius_m}, 0.25 * size) * side;
    }
    case LightHandle::Range:  // a light without a range has its handle at a default place
      return center_ - (light_.range_m > 0.0f ? double{light_.range_m} : 1.5 * size) * projection_.right();
    case LightHandle::InnerCone:
    case LightHandle::OuterCone: {
      const bool inner = handle == LightHandle::InnerCone;
      const double angle = inner ? light_.inner_cone_rad : light_.outer_cone_rad;
      // The handles are on different sides, so that they never coincide.
      const glm::dvec3 side = inner ? -coneSide() : coneSide();
      return center_ + coneLength() * (std::cos(angle) * forward_ + std::sin(angle) * side);
    }
    case LightHandle::Strength:
      return center_ + size * projection_.up();
    case LightHandle::None:
      break;
  }
  return std::nullopt;
}

std::optional<glm::vec2> LightGizmo::handleScreenPoint(LightHandle handle) const {
  const auto point = handlePoint(handle);
  const auto pixel = point ? projection_.toScreen(*point) : std::nullopt;
  return pixel ? std::optional(glm::vec2(*pixel)) : std::nullopt;
}

LightHandle LightGizmo::hit(glm::vec2 pixel) const {
  LightHandle best = LightHandle::None;
  float nearest = hit_px;
  for (const LightHandle handle : kLightHandles) {
    const auto place = handleScreenPoint(handle);
    if (!place || glm::length(*place - pixel) >= nearest) continue;
    nearest = glm::length(*place - pixel);
    best = handle;
  }
  return best;
}

bool LightGizmo::press(glm::vec2 pixel) {
  return press(hit(pixel), pixel);
}

// Returns the value at the pointer: metres from the centre, or radians from the axis.
std::optional<double> LightGizmo::valueAt(LightHandle handle, const glm::dvec2& pixel) const {
  const Ray ray = projection_.ray(pixel);
  const auto onPlane = [&](const glm::dvec3& point, const glm::dvec3& normal) -> std::optional<glm::dvec3> {
    const auto t = Projection::hitPlane(ray, point, normal);
    if (!t) return std::nullopt;
    return ray.origin + *t * ray.direction - center_;
  };
  if (handle == LightHandle::Radius || handle == LightHandle::Range) {
    const bool disc = handle == LightHandle::Radius && light_.kind == Kind::Disc &&
                      std::abs(glm::dot(forward_, projection_.toEye(center_))) > 0.2;
    const auto offset = onPlane(center_, disc ? forward_ : projection_.back());
    if (!offset) return std::nullopt;
    return glm::length(*offset);
  }
  const bool inner = handle == LightHandle::InnerCone;
  const glm::dvec3 side = inner ? -coneSide() : coneSide(), normal = glm::cross(forward_, side);
  if (std::abs(glm::dot(normal, projection_.toEye(center_))) > 0.2) {
    const auto offset = onPlane(center_, normal);
    if (!offset) return std::nullopt;
    // Across the axis the angle is 0, not an angle on the other side.
    return std::atan2(std::max(glm::dot(*offset, side), 0.0), glm::dot(*offset, forward_));
  }
  // The cone is seen along its axis, so the distance from the axis counts, in the plane at which the cone
  // ends.
  const double angle = inner ? start_.inner_cone_rad : start_.outer_cone_rad;
  const double depth = coneLength() * std::max(std::cos(angle), 0.05);
  const auto offset = onPlane(center_ + depth * forward_, forward_);
  if (!offset) return std::nullopt;
  return std::atan2(glm::length(*offset - glm::dot(*offset, forward_) * forward_), depth);
}

bool LightGizmo::press(LightHandle handle, glm::vec2 pixel) {
  if (dragging() || handle == LightHandle::None || !handleScreenPoint(handle)) return false;
  start_ = light_;
  start_pixel_ = glm::dvec2(pixel);
  active_ = handle;
  if (handle != LightHandle::Strength) start_value_ = valueAt(handle, start_pixel_).value_or(0.0);
  return true;
}

scene::LocalLightComponent LightGizmo::drag(glm::vec2 pixel) {
  if (!dragging()) return light_;
  const glm::dvec2 at(pixel);
  if (active_ == LightHandle::Strength) {
    const double stops = (start_pixel_.y - at.y) / kPixelsPerStop;
    if (at.y != start_pixel_.y)
      light_.strength = fitted("strength", std::max(start_.strength, kFaintest) * std::exp2(stops));
    else
      light_.strength = start_.strength;
    return light_;
  }
  const auto value = valueAt(active_, at);
  if (!value) return light_;
  const double by = *value - start_value_;  // a press alone changes nothing
  switch (active_) {
    case LightHandle::Radius:
      light_.radius_m = fitted("radius", start_.radius_m + by);
      break;
    case LightHandle::Range:
      light_.range_m = fitted("range", start_.range_m > 0.0f ? start_.range_m + by : *value);
      break;
    case LightHandle::InnerCone:
      light_.inner_cone_rad = fitted("inner_cone", start_.inner_cone_rad + by);
      light_.outer_cone_rad = std::max(start_.outer_cone_rad, light_.inner_cone_rad);
      break;
    case LightHandle::OuterCone:
      light_.outer_cone_rad = fitted("outer_cone", std::min(start_.outer_cone_rad + by, kHalfPi));
      light_.inner_cone_rad = std::min(start_.inner_cone_rad, light_.outer_cone_rad);
      break;
    case LightHandle::Strength:
    case LightHandle::None:
      break;
  }
  return light_;
}

Painting LightGizmo::paint() const {
  constexpr std::uint32_t kLine = rgba(255, 225, 130, 170), kFaint = rgba(255, 225, 130, 80);
  constexpr std::uint32_t kDot = rgba(255, 240, 200), kLit = rgba(255, 215, 60);
  Painting painting;
  const auto line = [&](const std::vector<glm::dvec3>& points, std::uint32_t color) {
    painting.push_back({{}, color, 1.5f, false, false});
    for (const glm::dvec3& point : points) {
      const auto pixel = projection_.toScreen(point);
      if (pixel)
        painting.back().points.emplace_back(*pixel);
      else
        painting.push_back({{}, color, 1.5f, false, false});  // points behind the eye interrupt the line
    }
  };
  if (!(projection_.pixelsPerMetre(center_) > 0.0)) return painting;
  const double length = coneLength();
  if (light_.kind == Kind::Sphere || light_.kind == Kind::Disc)
    line(circle(center_, light_.kind == Kind::Disc ? forward_ : projection_.back(), light_.radius_m), kLine);
  if (hasHandle(light_.kind, LightHandle::Range) && light_.range_m > 0.0f)
    line(circle(center_, projection_.back(), light_.range_m), kFaint);
  if (light_.kind == Kind::Spot) {
    for (const auto& [angle, color] :
         {std::pair{light_.inner_cone_rad, kFaint}, {light_.outer_cone_rad, kLine}}) {
      const double half = angle;
      const std::vector<glm::dvec3> rim =
          circle(center_ + length * std::cos(half) * forward_, forward_, length * std::sin(half));
      line(rim, color);
      for (std::size_t i = 0; i < rim.size(); i += rim.size() / 4) line({center_, rim[i]}, color);
    }
  } else if (light_.kind == Kind::Disc || light_.kind == Kind::Directional) {
    line({center_, center_ + length * forward_}, kLine);
  }
  if (const auto end = handlePoint(LightHandle::Strength)) line({center_, *end}, kFaint);
  for (const LightHandle handle : kLightHandles) {
    const bool lit = handle == active_ || (active_ == LightHandle::None && handle == hovered_);
    if (const auto place = handleScreenPoint(handle))
      painting.push_back(dot(glm::dvec2(*place), lit ? 5.5 : 4.0, lit ? kLit : kDot));
  }
  std::erase_if(painting, [](const Stroke& stroke) { return stroke.points.size() < 2; });
  return painting;
}

std::vector<glm::dvec3> LightGizmo::circle(const glm::dvec3& center, const glm::dvec3& normal,
                                           double radius) const {
  constexpr int kParts = 64;
  const glm::dvec3 e1 = acrossInPicture(normal, projection_), e2 = glm::cross(normal, e1);
  std::vector<glm::dvec3> points;
  for (int i = 0; i <= kParts; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kParts;
    points.push_back(center + radius * (std::cos(angle) * e1 + std::sin(angle) * e2));
  }
  return points;
}

}  // namespace lambent::editor
