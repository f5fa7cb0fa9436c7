#include "editor/gizmo/light_gizmos.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "editor/gizmo/projection.hpp"
#include "runtime/scene/reflection.hpp"
#include "runtime/spec/light.hpp"

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

namespace {

constexpr float kBorder = 14.0f;  // distance from a handle at the border to the picture's edge, in pixels

// Returns the point where the ray from the box's centre along `way` leaves the box.
glm::vec2 onRim(const glm::vec2& center, const glm::vec2& half, glm::vec2 way) {
  if (glm::length(way) < 1e-4f) way = {0.0f, -1.0f};  // the sun is right behind the eye
  float reach = std::numeric_limits<float>::max();
  for (int axis = 0; axis < 2; ++axis)
    if (way[axis] != 0.0f) reach = std::min(reach, half[axis] / std::abs(way[axis]));
  return center + reach * way;
}

}  // namespace

void SunGizmo::setSuns(std::vector<glm::vec3> towards) {
  towards_ = std::move(towards);
  if (active_ && *active_ >= towards_.size()) active_.reset();
}

std::optional<SunGizmo::Place> SunGizmo::place(std::size_t sun) const {
  if (sun >= towards_.size() || !projection_.perspective()) return std::nullopt;
  const glm::dvec3 way(towards_[sun]);
  const Viewport& viewport = projection_.viewport();
  const glm::vec2 half = glm::max(0.5f * glm::vec2(viewport.width, viewport.height) - kBorder, 1.0f);
  const glm::vec2 center =
      glm::vec2(viewport.x, viewport.y) + 0.5f * glm::vec2(viewport.width, viewport.height);
  if (const auto pixel = projection_.toScreen(projection_.eye() + way)) {
    const glm::vec2 from_center = glm::abs(glm::vec2(*pixel) - center);
    if (from_center.x <= half.x && from_center.y <= half.y) return Place{glm::vec2(*pixel), true};
  }
  const glm::vec2 aside(static_cast<float>(glm::dot(way, projection_.right())),
                        -static_cast<float>(glm::dot(way, projection_.up())));
  return Place{onRim(center, half, aside), false};
}

std::optional<std::size_t> SunGizmo::hit(glm::vec2 pixel) const {
  std::optional<std::size_t> best;
  float nearest = hit_px;
  for (std::size_t sun = 0; sun < towards_.size(); ++sun) {
    const auto at = place(sun);
    if (!at || glm::length(at->pixel - pixel) >= nearest) continue;
    nearest = glm::length(at->pixel - pixel);
    best = sun;
  }
  return best;
}

bool SunGizmo::press(glm::vec2 pixel) {
  const auto sun = hit(pixel);
  if (dragging() || !sun) return false;
  const Place at = *place(*sun);
  active_ = sun;
  offset_ = at.seen ? at.pixel - pixel : glm::vec2(0.0f);
  return true;
}

glm::vec3 SunGizmo::drag(glm::vec2 pixel) const {
  return glm::vec3(projection_.ray(glm::dvec2(pixel + offset_)).direction);
}

Painting SunGizmo::paint() const {
  constexpr std::uint32_t kSun = rgba(255, 225, 130), kLit = rgba(255, 200, 40), kRim = rgba(0, 0, 0, 150);
  constexpr double kDisc = 6.0, kRays = 11.0;
  Painting painting;
  for (std::size_t sun = 0; sun < towards_.size(); ++sun) {
    const auto at = place(sun);
    if (!at) continue;
    const std::uint32_t color = sun == active_ || (!active_ && sun == hovered_) ? kLit : kSun;
    const glm::dvec2 center(at->pixel);
    painting.push_back(dot(center, kDisc + 1.5, kRim));
    if (at->seen) {
      for (int i = 0; i < 8; ++i) {
        const double angle = 0.25 * std::numbers::pi * i;
        const glm::dvec2 way(std::cos(angle), std::sin(angle));
        painting.push_back({{glm::vec2(center + (kDisc + 2.0) * way), glm::vec2(center + kRays * way)},
                            color,
                            1.5f,
                            false,
                            false});
      }
      painting.push_back(dot(center, kDisc, color));
    } else {
      // A hollow ring marks a sun that is out of view.
      painting.push_back(dot(center, kDisc, color));
      painting.back().filled = false;
      painting.back().width_px = 2.0f;
    }
  }
  return painting;
}

SkyDirection skyDirection(const glm::vec3& towards, float rotation_deg) {
  const glm::dvec3 d = glm::normalize(glm::dvec3(towards));
  const double azimuth = glm::degrees(std::atan2(d.x, d.z)) - double{rotation_deg};
  return {static_cast<float>(std::remainder(azimuth, 360.0)),
          static_cast<float>(glm::degrees(std::asin(std::clamp(d.y, -1.0, 1.0))))};
}

glm::vec3 towardsSun(const SkyDirection& direction, float rotation_deg) {
  return spec::directionFromAzimuthElevation(direction.azimuth_deg + rotation_deg, direction.elevation_deg);
}

Result<std::string> withSunDirection(std::string_view word, const SkyDirection& direction) {
  const Result<spec::Light> light = spec::parseLight(word);
  if (!light) return failAgain(light.error());
  if (!std::holds_alternative<spec::SunLight>(*light))
    return fail(fmt::format("light \"{}\"", word), "is no sun", "write sun:AZ,EL,ANGLE,R[,G,B]");
  // Everything but the first two numbers stays as it was written.
  const std::size_t second = word.find(','), rest = word.find(',', second + 1);
  const auto rounded = [](float degrees) { return std::round(degrees * 1000.0f) / 1000.0f; };
  return fmt::format("sun:{},{}{}", rounded(direction.azimuth_deg), rounded(direction.elevation_deg),
                     word.substr(rest));
}

}  // namespace lambent::editor
