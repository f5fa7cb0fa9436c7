#include "editor/gizmo/sun_gizmo.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "editor/gizmo/projection.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::editor {

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
