#include "runtime/debug/overlay_keys.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace lambent::frame {

namespace {

constexpr int kOutlineSteps = 48;
constexpr float kLeastOutline_rad = 0.0175f;
constexpr glm::vec3 kDark{0.45f};

float fluxOf(const spec::Disc& key) {
  const float half = std::sin(0.5f * key.radius_rad);
  return half * half * (key.radiance.r + key.radiance.g + key.radiance.b);
}

// Returns the light's colour at full brightness.
glm::vec3 colorOf(const spec::Disc& key) {
  const float peak = std::max({key.radiance.r, key.radiance.g, key.radiance.b});
  if (!(peak > 0.0f)) return kDark;
  return glm::mix(glm::vec3(1.0f, 0.93f, 0.6f), glm::max(key.radiance, 0.0f) / peak, 0.6f);
}

struct Frame3 {
  glm::vec3 x, y, z;
};
Frame3 frameAlong(const glm::vec3& z) {
  const glm::vec3 beside = std::abs(z.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
  const glm::vec3 x = glm::normalize(glm::cross(beside, z));
  return {x, glm::cross(z, x), z};
}

void appendOutline(const spec::Disc& key, const spec::View& view, float distance, const glm::vec4& color,
                   std::vector<OverlayLine>& lines) {
  const Frame3 frame = frameAlong(key.direction);
  const auto at = [&](float angle, float beside_rad) {
    const glm::vec3 way = std::cos(beside_rad) * frame.z +
                          std::sin(beside_rad) * (std::cos(angle) * frame.x + std::sin(angle) * frame.y);
    return view.eye_ws + distance * way;
  };
  constexpr float kTurn = 2.0f * std::numbers::pi_v<float>;
  const float radius = std::max(key.radius_rad, kLeastOutline_rad);
  for (int i = 0; i < kOutlineSteps; ++i) {
    const float from = kTurn * static_cast<float>(i) / kOutlineSteps;
    const float to = kTurn * static_cast<float>(i + 1) / kOutlineSteps;
    lines.push_back({.from_ws = at(from, radius), .to_ws = at(to, radius), .color = color, .width_px = 2.0f});
  }
  // Ticks distinguish the outline from a round object in the scene.
  for (int i = 0; i < 4; ++i) {
    const float angle = kTurn * static_cast<float>(i) / 4.0f;
    lines.push_back({.from_ws = at(angle, radius),
                     .to_ws = at(angle, radius + kLeastOutline_rad),
                     .color = color,
                     .width_px = 2.0f});
  }
}

void appendArrow(const spec::Disc& key, const scene::Box& world, const glm::vec4& color,
                 std::vector<OverlayLine>& lines) {
  constexpr float kFrom = 1.3f, kTo = 0.25f, kHead = 0.12f;  // of the world's radius, from its centre
  const Frame3 frame = frameAlong(key.direction);
  const float radius = std::max(world.radius(), 1e-3f);
  const glm::vec3 to = world.center() + kTo * radius * frame.z;
  lines.push_back({.from_ws = world.center() + kFrom * radius * frame.z, .to_ws = to, .color = color});
  for (const glm::vec3& side : {frame.x, -frame.x, frame.y, -frame.y})
    lines.push_back({.from_ws = to, .to_ws = to + kHead * radius * (frame.z + 0.4f * side), .color = color});
}

}  // namespace

std::array<glm::vec3, 8> cornersOf(const KeyRegion& region) {
  std::array<glm::vec3, 8> corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const double x = (i & 1) != 0 ? region.max.x : region.min.x;
    const double y = (i & 2) != 0 ? region.max.y : region.min.y;
    const double z = (i & 4) != 0 ? region.top : region.top - region.range;
    corners[i] = glm::vec3(x * region.right + y * region.up + z * region.towards);
  }
  return corners;
}

void appendKeys(std::span<const spec::Disc> keys, std::span<const KeyShadows::ShownRegion> regions,
                std::optional<std::size_t> chosen, const scene::Box& world, const spec::View& view,
                std::vector<OverlayLine>& lines) {
  float most = 0.0f;
  for (const spec::Disc& key : keys) most = std::max(most, fluxOf(key));
  const auto alphaOf = [&](const spec::Disc& key) {
    return most > 0.0f ? 0.3f + 0.7f * std::sqrt(std::max(fluxOf(key), 0.0f) / most) : 0.3f;
  };
  const bool perspective = view.clip_from_view[2][3] != 0.0f;
  const float distance =
      world.empty() ? 1e3f : 1e2f * (world.radius() + glm::distance(world.center(), view.eye_ws));
  for (const spec::Disc& key : keys) {
    const glm::vec4 color(colorOf(key), alphaOf(key));
    if (perspective) appendOutline(key, view, distance, color, lines);
    if (!world.empty()) appendArrow(key, world, color, lines);
  }
  std::vector<KeyShadows::ShownRegion> boxes(regions.begin(), regions.end());
  if (chosen && *chosen < keys.size())
    std::erase_if(boxes, [&](const KeyShadows::ShownRegion& shown) {
      return shown.light.direction != keys[*chosen].direction;
    });
  std::ranges::stable_sort(boxes, std::ranges::greater(),
                           [](const KeyShadows::ShownRegion& shown) { return fluxOf(shown.light); });
  boxes.resize(std::min(boxes.size(), kMostBoxes));
  for (const KeyShadows::ShownRegion& shown : boxes) {
    const std::array<glm::vec3, 8> corners = cornersOf(shown.region);
    const glm::vec4 color(colorOf(shown.light), 0.7f * alphaOf(shown.light));
    for (std::size_t i = 0; i < corners.size(); ++i)
      for (const std::size_t bit : {1u, 2u, 4u})
        if ((i & bit) == 0)
          lines.push_back(
              {.from_ws = corners[i], .to_ws = corners[i | bit], .color = color, .width_px = 1.0f});
  }
}

}  // namespace lambent::frame
