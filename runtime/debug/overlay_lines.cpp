// Turns what overlays show of boxes and lights into lines in world space. No GL; empty input adds nothing.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <span>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "runtime/debug/overlays.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/scene/components.hpp"

namespace lambent::frame {

namespace {

using Kind = scene::LocalLightComponent::Kind;

constexpr glm::vec4 kGroupColor{1.0f, 0.72f, 0.25f, 0.9f};
constexpr glm::vec4 kVolumeColor{0.35f, 0.85f, 0.95f, 0.95f};
constexpr glm::vec4 kNeighborhoodColor{0.78f, 0.6f, 1.0f, 0.95f};
constexpr glm::vec4 kFaintNeighborhoodColor{0.78f, 0.6f, 1.0f, 0.25f};
constexpr int kCircleSteps = 48;

struct Glyph {
  glm::vec3 x, y, z;  // unit axes; the light shines along -z
  glm::vec4 color;
  float width_px = 1.5f;
  std::vector<OverlayLine>& lines;

  void line(const glm::vec3& from, const glm::vec3& to) const {
    lines.push_back({.from_ws = from, .to_ws = to, .color = color, .width_px = width_px});
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
    arrow(from, length, 0.22f * length, 0.11f * length);
  }
  void arrow(const glm::vec3& from, float length, float head_length, float head_radius) const {
    const glm::vec3 to = from - length * z;
    line(from, to);
    for (const glm::vec3& side : {x, -x, y, -y}) line(to, to + head_length * z + head_radius * side);
  }
  // Draws the outline of a spot's cone at an angle, up to a circle at the given length.
  void cone(const glm::vec3& origin, float angle_rad, float length, bool sides) const {
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

// Starts a glyph of a light that shines along -z, a unit vector.
Glyph glyphAlong(const glm::vec3& z, const glm::vec4& color, std::vector<OverlayLine>& lines) {
  const glm::vec3 beside = std::abs(z.y) < 0.9f ? glm::vec3(0.0f, 1.0f, 0.0f) : glm::vec3(1.0f, 0.0f, 0.0f);
  const glm::vec3 x = glm::normalize(glm::cross(beside, z));
  return {.x = x, .y = glm::cross(z, x), .z = z, .color = color, .lines = lines};
}

// Appends the twelve edges between corners whose bits 1, 2 and 4 select the far end along an axis.
void appendEdges(const std::array<glm::vec3, 8>& corners, const glm::vec4& color, float width_px,
                 std::vector<OverlayLine>& lines) {
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (const std::size_t bit : {1u, 2u, 4u})
      if ((i & bit) == 0)
        lines.push_back(
            {.from_ws = corners[i], .to_ws = corners[i | bit], .color = color, .width_px = width_px});
}

void appendBox(const scene::Box& box, const glm::mat4& world_from_box, const glm::vec4& color,
               std::vector<OverlayLine>& lines) {
  if (box.empty()) return;
  std::array<glm::vec3, 8> corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::vec3 place((i & 1) != 0 ? box.max.x : box.min.x, (i & 2) != 0 ? box.max.y : box.min.y,
                          (i & 4) != 0 ? box.max.z : box.min.z);
    corners[i] = glm::vec3(world_from_box * glm::vec4(place, 1.0f));
  }
  appendEdges(corners, color, 1.5f, lines);
}

// Appends the outline of a sphere or disc at its size, a cone for a spot, an arrow for a directional light,
// or a star for a point light. size_m is the length used for what has no size of its own. Lights shine along
// the node's -Z.
void appendLight(const scene::LocalLightComponent& light, const glm::mat4& world_from_node, float size_m,
                 const glm::vec4& color, std::vector<OverlayLine>& lines) {
  const glm::vec3 back(world_from_node[2]), o(world_from_node[3]);
  const float length = glm::length(back);
  const Glyph glyph = glyphAlong(
      length > 0.0f && std::isfinite(length) ? back / length : glm::vec3(0.0f, 0.0f, 1.0f), color, lines);
  const glm::vec3 &x = glyph.x, &y = glyph.y, &z = glyph.z;
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
      glyph.cone(o, light.outer_cone_rad, 2.0f * size_m, /*sides=*/true);
      if (light.inner_cone_rad > 0.0f) glyph.cone(o, light.inner_cone_rad, 2.0f * size_m, /*sides=*/false);
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

// Returns the size of glyphs in this world, in metres.
float signSize(const World& world) {
  const scene::Box bounds = scene::worldBounds(world.registry());
  const float radius = bounds.empty() ? 1.0f : bounds.radius();
  return radius > 0.0f ? 0.05f * radius : 0.05f;
}

constexpr float kLeastOutline_rad = 0.0175f;
constexpr std::size_t kMostBoxes = 4;  // of shadow maps, unless one is chosen
constexpr glm::vec3 kDark{0.45f};

float fluxOf(const spec::Disc& key) {
  const float half = std::sin(0.5f * key.radius_rad);
  return half * half * (key.radiance.r + key.radiance.g + key.radiance.b);
}

// Returns a warm white mixed with the light's colour at full brightness, or grey if it gives nothing.
glm::vec3 colorOf(const glm::vec3& light, float share) {
  const float peak = std::max({light.r, light.g, light.b});
  return peak > 0.0f ? glm::mix(glm::vec3(1.0f, 0.93f, 0.6f), light / peak, share) : kDark;
}

// Appends the ring of a key light on the sky. Ticks distinguish it from a round object in the scene.
void appendRing(const spec::Disc& key, const spec::View& view, float distance, const glm::vec4& color,
                std::vector<OverlayLine>& lines) {
  Glyph glyph = glyphAlong(key.direction, color, lines);
  glyph.width_px = 2.0f;
  const float radius = std::max(key.radius_rad, kLeastOutline_rad), outside = radius + kLeastOutline_rad;
  const auto centerAt = [&](float beside) { return view.eye_ws + distance * std::cos(beside) * glyph.z; };
  glyph.circle(centerAt(radius), glyph.x, glyph.y, distance * std::sin(radius));
  for (const glm::vec3& side : {glyph.x, glyph.y, -glyph.x, -glyph.y})
    glyph.line(centerAt(radius) + distance * std::sin(radius) * side,
               centerAt(outside) + distance * std::sin(outside) * side);
}

void appendKeys(const OverlayOptions& options, const OverlayScene& scene, std::vector<OverlayLine>& lines) {
  const scene::Box world = scene::worldBounds(scene.world.registry());
  const std::span<const spec::Disc> keys = scene.environment.keys();
  float most = 0.0f;
  for (const spec::Disc& key : keys) most = std::max(most, fluxOf(key));
  const auto shownAs = [&](const spec::Disc& key, float share) {
    const float bright = most > 0.0f ? 0.3f + 0.7f * std::sqrt(std::max(fluxOf(key), 0.0f) / most) : 0.3f;
    return glm::vec4(colorOf(glm::max(key.radiance, 0.0f), 0.6f), share * bright);
  };
  const bool perspective = scene.view.clip_from_view[2][3] != 0.0f;
  const float distance =
      world.empty() ? 1e3f : 1e2f * (world.radius() + glm::distance(world.center(), scene.view.eye_ws));
  for (const spec::Disc& key : keys) {
    const glm::vec4 color = shownAs(key, 1.0f);
    if (perspective) appendRing(key, scene.view, distance, color, lines);
    if (world.empty()) continue;
    const float radius = std::max(world.radius(), 1e-3f);
    glyphAlong(key.direction, color, lines)
        .arrow(world.center() + 1.3f * radius * key.direction, 1.05f * radius, 0.12f * radius,
               0.048f * radius);
  }
  const bool one = options.key && *options.key < keys.size();
  std::vector<const KeyShadows::Map*> maps;
  for (const KeyShadows::Map& map : scene.key_shadows.maps())
    if (map.drawn && (!one || map.light.direction == keys[*options.key].direction)) maps.push_back(&map);
  std::ranges::stable_sort(maps, std::ranges::greater(),
                           [](const KeyShadows::Map* map) { return fluxOf(map->light); });
  maps.resize(std::min(maps.size(), kMostBoxes));
  for (const KeyShadows::Map* map : maps)
    appendEdges(cornersOf(map->region), shownAs(map->light, 0.7f), 1.0f, lines);
}

}  // namespace

std::vector<std::uint32_t> foremostNeighborhoods(const OverlayOptions& options, const OverlayScene& scene) {
  struct PlacedBox {
    std::uint32_t group;
    scene::Box box;
    glm::mat4 world_from_box;
    float distance;  // of its centre, from the eye
    bool wanted;
  };
  std::vector<PlacedBox> boxes;
  for (const auto& grid : scene.neighborhoods.effect().grids()) {
    if (!options.shows(grid.group)) continue;
    const scene::Box box{grid.points.bounds_min, grid.points.bounds_max};
    const glm::mat4 place = scene.world.worldFromGroup(grid.group);
    boxes.push_back(
        {.group = grid.group,
         .box = box,
         .world_from_box = place,
         .distance = glm::length(glm::vec3(place * glm::vec4(box.center(), 1.0f)) - scene.view.eye_ws),
         .wanted = std::ranges::find(options.foremost_groups, grid.group) != options.foremost_groups.end()});
  }
  std::vector<std::uint32_t> foremost;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const PlacedBox& a = boxes[i];
    bool first = true;
    for (std::size_t other = 0; other < boxes.size() && first; ++other) {
      const PlacedBox& b = boxes[other];
      if (other == i || !meet(a.box, a.world_from_box, b.box, b.world_from_box)) continue;
      // Of two boxes at the same distance, the first counts as nearer.
      first = !b.wanted && (other < i ? a.distance < b.distance : a.distance <= b.distance);
    }
    if (first || a.wanted) foremost.push_back(a.group);
  }
  return foremost;
}

std::vector<OverlayLine> linesOf(const OverlayOptions& options, const OverlayScene& scene) {
  std::vector<OverlayLine> lines = options.lines;
  const World& world = scene.world;
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
    const std::vector<std::uint32_t> foremost = foremostNeighborhoods(options, scene);
    for (const auto& grid : scene.neighborhoods.effect().grids()) {
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
      const glm::vec3 color = light.power() != glm::vec3(0.0f) ? colorOf(light.color, 0.5f) : kDark;
      appendLight(light, place ? place->world_from_node : glm::mat4(1.0f), size, glm::vec4(color, 1.0f),
                  lines);
    }
  }
  if (options.keys) appendKeys(options, scene, lines);
  return lines;
}

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

}  // namespace lambent::frame
