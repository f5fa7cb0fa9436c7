#include "runtime/debug/overlay_lines.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "runtime/world/boxes.hpp"

namespace lambent::frame {

namespace {

using Kind = scene::LocalLightComponent::Kind;

constexpr glm::vec4 kGroupColor{1.0f, 0.72f, 0.25f, 0.9f};
constexpr glm::vec4 kVolumeColor{0.35f, 0.85f, 0.95f, 0.95f};
constexpr glm::vec4 kNeighborhoodColor{0.78f, 0.6f, 1.0f, 0.95f};
constexpr glm::vec4 kFaintNeighborhoodColor{0.78f, 0.6f, 1.0f, 0.25f};
constexpr int kCircleSteps = 48;

struct Glyph {
  glm::vec3 origin, x, y, z;  // unit axes; the light shines along -z
  glm::vec4 color;
  std::vector<OverlayLine>& lines;

  void line(const glm::vec3& from, const glm::vec3& to) const {
    lines.push_back({.from_ws = from, .to_ws = to, .color = color});
  }
  void circle(const glm::vec3& center, const glm::vec3& a, const glm::vec3& b, float radius) const {
    glm::vec3 before = center + radius * a;
    for (int i = 1; i <= kCircleSteps; ++i) {
      const float angle = 2.0f * std::numbers::pi_v<float> * static_cast<float>(i) / kCircleSteps;
      const glm::vec3 next = center + radius * (std::cos(angle) * a + std::sin(angle) * b);
      line(before, next);
      before = next;
    }
  }
  void arrow(const glm::vec3& from, float length) const {
    const glm::vec3 to = from - length * z;
    const float head = 0.22f * length;
    line(from, to);
    for (const glm::vec3& side : {x, -x, y, -y}) line(to, to + head * z + 0.5f * head * side);
  }
  // Draws the outline of a spot's cone at an angle, up to a circle at the given length.
  void cone(float angle_rad, float length, bool sides) const {
    const float along = length * std::cos(angle_rad), radius = length * std::sin(angle_rad);
    const glm::vec3 center = origin - along * z;
    circle(center, x, y, radius);
    if (!sides) return;
    for (const glm::vec3& side : {x, -x, y, -y}) line(origin, center + radius * side);
  }
};

// Appends the outline of a slice through a box.
void appendSlice(const scene::Box& box, const glm::mat4& world_from_box, const NeighborhoodSlice& slice,
                 std::vector<OverlayLine>& lines) {
  const int axis = slice.axis, u = (axis + 1) % 3, v = (axis + 2) % 3;
  const auto corner = [&](bool far_u, bool far_v) {
    glm::vec3 place(0.0f);
    place[axis] = glm::mix(box.min[axis], box.max[axis], slice.position);
    place[u] = far_u ? box.max[u] : box.min[u];
    place[v] = far_v ? box.max[v] : box.min[v];
    return glm::vec3(world_from_box * glm::vec4(place, 1.0f));
  };
  const glm::vec3 corners[] = {corner(false, false), corner(true, false), corner(true, true),
                               corner(false, true)};
  for (std::size_t i = 0; i < 4; ++i)
    lines.push_back({.from_ws = corners[i],
                     .to_ws = corners[(i + 1) % 4],
                     .color = glm::vec4(glm::vec3(kNeighborhoodColor), 0.55f),
                     .width_px = 1.0f});
}

// Returns the unit vector along v, or `otherwise` if v has no direction.
glm::vec3 unitOr(const glm::vec3& v, const glm::vec3& otherwise) {
  const float length = glm::length(v);
  return length > 0.0f && std::isfinite(length) ? v / length : otherwise;
}

}  // namespace

void appendBox(const scene::Box& box, const glm::mat4& world_from_box, const glm::vec4& color,
               std::vector<OverlayLine>& lines) {
  if (box.empty()) return;
  const auto corner = [&](unsigned bits) {
    const glm::vec3 place((bits & 1u) != 0 ? box.max.x : box.min.x, (bits & 2u) != 0 ? box.max.y : box.min.y,
                          (bits & 4u) != 0 ? box.max.z : box.min.z);
    return glm::vec3(world_from_box * glm::vec4(place, 1.0f));
  };
  for (unsigned bits = 0; bits < 8; ++bits)
    for (unsigned axis = 1; axis < 8; axis *= 2)
      if ((bits & axis) == 0)
        lines.push_back({.from_ws = corner(bits), .to_ws = corner(bits | axis), .color = color});
}

void appendLight(const scene::LocalLightComponent& light, const glm::mat4& world_from_node, float size_m,
                 const glm::vec4& color, std::vector<OverlayLine>& lines) {
  const glm::vec3 z = unitOr(glm::vec3(world_from_node[2]), {0.0f, 0.0f, 1.0f});
  const glm::vec3 across = std::abs(z.y) < 0.9f ? glm::vec3(0.0f, 1.0f, 0.0f) : glm::vec3(1.0f, 0.0f, 0.0f);
  const glm::vec3 x = glm::normalize(glm::cross(across, z)), y = glm::cross(z, x);
  const Glyph glyph{
      .origin = glm::vec3(world_from_node[3]), .x = x, .y = y, .z = z, .color = color, .lines = lines};
  const glm::vec3& o = glyph.origin;
  switch (light.kind) {
    case Kind::Sphere:
      glyph.circle(o, x, y, light.radius_m);
      glyph.circle(o, y, z, light.radius_m);
      glyph.circle(o, z, x, light.radius_m);
      break;
    case Kind::Disc:
      glyph.circle(o, x, y, light.radius_m);
      glyph.arrow(o, std::max(light.radius_m, 0.5f * size_m));
      break;
    case Kind::Spot:
      glyph.cone(light.outer_cone_rad, 2.0f * size_m, /*sides=*/true);
      if (light.inner_cone_rad > 0.0f) glyph.cone(light.inner_cone_rad, 2.0f * size_m, /*sides=*/false);
      break;
    case Kind::Directional: {
      glyph.circle(o, x, y, 0.35f * size_m);
      for (const glm::vec3& side : {glm::vec3(0.0f), x, -x, y, -y})
        glyph.arrow(o + 0.35f * size_m * side, side == glm::vec3(0.0f) ? 2.0f * size_m : 1.2f * size_m);
      break;
    }
    case Kind::Point: {
      for (const glm::vec3& axis : {x, y, z}) glyph.line(o - 0.5f * size_m * axis, o + 0.5f * size_m * axis);
      const float corner = 0.3f * size_m / std::numbers::sqrt3_v<float>;
      for (unsigned bits = 0; bits < 4; ++bits) {
        const glm::vec3 axis = ((bits & 1u) != 0 ? x : -x) + ((bits & 2u) != 0 ? y : -y) + z;
        glyph.line(o - corner * axis, o + corner * axis);
      }
      break;
    }
  }
}

float signSize(const World& world) {
  const scene::Box bounds = scene::worldBounds(world.registry());
  const float radius = bounds.empty() ? 1.0f : bounds.radius();
  return radius > 0.0f ? 0.05f * radius : 0.05f;
}

std::vector<bool> drawnWhole(const std::vector<PlacedBox>& boxes, const glm::vec3& eye) {
  const auto distance = [&](const PlacedBox& box) {
    return glm::length(glm::vec3(box.world_from_box * glm::vec4(box.box.center(), 1.0f)) - eye);
  };
  std::vector<bool> whole;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    bool foremost = true;
    for (std::size_t other = 0; other < boxes.size() && foremost; ++other) {
      const PlacedBox &a = boxes[i], &b = boxes[other];
      if (other == i || !meet(a.box, a.world_from_box, b.box, b.world_from_box)) continue;
      // Of two boxes at the same distance, the first counts as nearer.
      foremost = !b.wanted && (other < i ? distance(a) < distance(b) : distance(a) <= distance(b));
    }
    whole.push_back(foremost || boxes[i].wanted);
  }
  return whole;
}

std::vector<std::uint32_t> foremostNeighborhoods(const World& world, const Neighborhoods& neighborhoods,
                                                 const OverlayOptions& options, const glm::vec3& eye) {
  std::vector<std::uint32_t> groups;
  std::vector<PlacedBox> boxes;
  for (const auto& grid : neighborhoods.effect().grids()) {
    if (!options.shows(grid.group)) continue;
    groups.push_back(grid.group);
    boxes.push_back(
        {.box = {grid.points.bounds_min, grid.points.bounds_max},
         .world_from_box = world.worldFromGroup(grid.group),
         .wanted = std::ranges::find(options.foremost_groups, grid.group) != options.foremost_groups.end()});
  }
  const std::vector<bool> whole = drawnWhole(boxes, eye);
  std::vector<std::uint32_t> foremost;
  for (std::size_t i = 0; i < groups.size(); ++i)
    if (whole[i]) foremost.push_back(groups[i]);
  return foremost;
}

std::vector<OverlayLine> linesOf(const World& world, const Neighborhoods& neighborhoods,
                                 const OverlayOptions& options, const glm::vec3& eye) {
  std::vector<OverlayLine> lines = options.lines;
  const streaming::Residency& residency = world.residency();
  for (std::uint32_t g = 0; g < residency.groups().size(); ++g) {
    if (!options.shows(g)) continue;
    const std::int32_t volume = residency.groups()[g].volume;
    if (options.groups && volume < 0)
      appendBox(world.groupBounds(g), world.worldFromGroup(g), kGroupColor, lines);
    if (options.volumes && volume >= 0) {
      const bundle::VolumeGrid& grid = residency.volumes()[static_cast<std::size_t>(volume)].grid;
      appendBox({glm::vec3(0.0f), glm::vec3(grid.size)}, world.worldFromGroup(g) * grid.group_from_grid,
                kVolumeColor, lines);
    }
  }
  if (options.neighborhoods) {
    const std::vector<std::uint32_t> foremost = foremostNeighborhoods(world, neighborhoods, options, eye);
    for (const auto& grid : neighborhoods.effect().grids()) {
      if (!options.shows(grid.group)) continue;
      const bool whole = std::ranges::find(foremost, grid.group) != foremost.end();
      const scene::Box box{grid.points.bounds_min, grid.points.bounds_max};
      appendBox(box, world.worldFromGroup(grid.group), whole ? kNeighborhoodColor : kFaintNeighborhoodColor,
                lines);
      if (whole) appendSlice(box, world.worldFromGroup(grid.group), options.slice, lines);
    }
  }
  if (options.lights) {
    const float size = signSize(world);
    for (auto [entity, light] : world.registry().view<const scene::LocalLightComponent>()) {
      const auto* place = world.registry().tryGet<scene::WorldTransform>(entity);
      // The line has the light's colour at full brightness, and is dark if the light gives nothing.
      const float peak = std::max({light.color.r, light.color.g, light.color.b});
      const bool on = light.power() != glm::vec3(0.0f) && peak > 0.0f;
      const glm::vec3 color =
          on ? glm::mix(glm::vec3(1.0f, 0.93f, 0.6f), light.color / peak, 0.5f) : glm::vec3(0.45f);
      appendLight(light, place ? place->world_from_node : glm::mat4(1.0f), size, glm::vec4(color, 1.0f),
                  lines);
    }
  }
  return lines;
}

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
