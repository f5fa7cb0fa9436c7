#include "runtime/debug/overlays.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <string>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "lambent_debug_embedded.hpp"
#include "lambent_draws_embedded.hpp"
#include "lambent_evaluate_embedded.hpp"
#include "lambent_lighting_embedded.hpp"
#include "lambent_shadows_embedded.hpp"
#include "lambent_surface_embedded.hpp"
#include "lambent_tone_map_embedded.hpp"
#include "lambent_transfer_embedded.hpp"
#include "runtime/draws/surface_record.hpp"
#include "runtime/draws/surface_shared.h"
#include "runtime/scene/bounds.hpp"
#include "runtime/scene/components.hpp"

namespace lambent::frame {

const gpu::FindText kDebugShaders[8] = {&embedded::lambent_debug::find,    &embedded::lambent_draws::find,
                                        &embedded::lambent_surface::find,  &embedded::lambent_shadows::find,
                                        &embedded::lambent_tone_map::find, &embedded::lambent_lighting::find,
                                        &embedded::lambent_evaluate::find, &embedded::lambent_transfer::find};

namespace {

// These are the uniform locations and bindings of the shaders.
constexpr GLint kSizePx = 0, kStrength = 1;
constexpr GLuint kBindLines = 1, kBindSigns = 1, kBindLights = 2, kBindExposure = 7;
constexpr std::size_t kBallVertices = 6 * 10 * 10 * 6;
constexpr float kHiddenStrength = 0.22f;

struct LineRecord {
  glm::vec4 from_and_width, to, color;
};

// Has the layout that probe_marker.glsl reads.
struct Sign {
  glm::vec4 place_and_radius;  // world; w: radius of the ball
  glm::vec4 group_from_world;  // rotation, xyzw
  std::uint32_t light;         // vec4 index of its coefficients
  std::uint32_t order;
  std::uint32_t pad[2];
};

// Returns the radius of the world, in metres; 1 if it has none.
float radiusOf(const World& world) {
  const scene::Box bounds = scene::worldBounds(world.registry());
  return bounds.empty() || !(bounds.radius() > 0.0f) ? 1.0f : bounds.radius();
}

// Returns a radius that is small relative to the scene and to the distance between neighbouring samples of a
// group. It uses the median of these distances, because two samples may stand close together.
float radiusFor(float scene_radius, std::span<const glm::vec3> places) {
  const float radius = 0.022f * scene_radius;
  if (places.size() < 2) return radius;
  std::vector<float> ways;
  for (std::size_t i = 0; i < places.size(); ++i) {
    float nearest = std::numeric_limits<float>::infinity();
    for (std::size_t j = 0; j < places.size(); ++j)
      if (i != j) nearest = std::min(nearest, glm::distance(places[i], places[j]));
    ways.push_back(nearest);
  }
  const auto middle = ways.begin() + static_cast<std::ptrdiff_t>(ways.size() / 2);
  std::nth_element(ways.begin(), middle, ways.end());
  return std::clamp(*middle / 4.0f, 0.2f * radius, radius);
}

// --- lines ---

using Kind = scene::LocalLightComponent::Kind;

constexpr glm::vec4 kGroupColor{1.0f, 0.72f, 0.25f, 0.9f};
constexpr glm::vec4 kVolumeColor{0.35f, 0.85f, 0.95f, 0.95f};
constexpr glm::vec4 kNeighborhoodColor{0.78f, 0.6f, 1.0f, 0.95f};
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

// Starts a glyph of a light that shines along -z, a unit vector.
Glyph glyphAlong(const glm::vec3& z, const glm::vec4& color, std::vector<OverlayLine>& lines) {
  const glm::vec3 beside = std::abs(z.y) < 0.9f ? glm::vec3(0.0f, 1.0f, 0.0f) : glm::vec3(1.0f, 0.0f, 0.0f);
  const glm::vec3 x = glm::normalize(glm::cross(beside, z));
  return {.x = x, .y = glm::cross(z, x), .z = z, .color = color, .lines = lines};
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
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (const std::size_t bit : {1u, 2u, 4u})
      if ((i & bit) == 0) lines.push_back({.from_ws = corners[i], .to_ws = corners[i | bit], .color = color});
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

constexpr float kLeastOutline_rad = 0.0175f;
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

void appendKeys(const OverlayScene& scene, std::vector<OverlayLine>& lines) {
  const scene::Box world = scene::worldBounds(scene.world.registry());
  const std::span<const spec::Disc> keys = scene.environment.keys();
  float most = 0.0f;
  for (const spec::Disc& key : keys) most = std::max(most, fluxOf(key));
  const bool perspective = scene.view.clip_from_view[2][3] != 0.0f;
  const float distance =
      world.empty() ? 1e3f : 1e2f * (world.radius() + glm::distance(world.center(), scene.view.eye_ws));
  for (const spec::Disc& key : keys) {
    const float bright = most > 0.0f ? 0.3f + 0.7f * std::sqrt(std::max(fluxOf(key), 0.0f) / most) : 0.3f;
    const glm::vec4 color(colorOf(glm::max(key.radiance, 0.0f), 0.6f), bright);
    if (perspective) appendRing(key, scene.view, distance, color, lines);
    if (world.empty()) continue;
    const float radius = std::max(world.radius(), 1e-3f);
    glyphAlong(key.direction, color, lines)
        .arrow(world.center() + 1.3f * radius * key.direction, 1.05f * radius, 0.12f * radius,
               0.048f * radius);
  }
}

// Returns the lines for everything that the options ask for and lines can show, including the options' own
// lines. A key light has its outline on the sky, with its angular radius but at least 1 degree (parallel
// views see a single direction and have none), and an arrow into the world along its light. Weak key lights
// are fainter than strong ones, and dark ones are grey.
std::vector<OverlayLine> linesOf(const OverlayOptions& options, const OverlayScene& scene) {
  std::vector<OverlayLine> lines = options.lines;
  const World& world = scene.world;
  const streaming::Residency& residency = world.residency();
  for (std::uint32_t g = 0; g < residency.groups().size(); ++g) {
    const std::int32_t volume = residency.groups()[g].volume;
    if (options.groups && volume < 0)
      appendBox(world.groupBounds(g), world.worldFromGroup(g), kGroupColor, lines);
    if (options.volumes && volume >= 0) {
      const bundle::VolumeGrid& grid = residency.volumes()[static_cast<std::size_t>(volume)].grid;
      appendBox({glm::vec3(0.0f), glm::vec3(grid.size)}, world.worldFromGroup(g) * grid.group_from_grid,
                kVolumeColor, lines);
    }
  }
  if (options.neighborhoods)
    for (const auto& grid : scene.neighborhoods.effect().grids())
      appendBox({grid.points.bounds_min, grid.points.bounds_max}, world.worldFromGroup(grid.group),
                kNeighborhoodColor, lines);
  if (options.lights) {
    const float size = 0.05f * radiusOf(world);
    for (auto [entity, light] : world.registry().view<const scene::LocalLightComponent>()) {
      const auto* place = world.registry().tryGet<scene::WorldTransform>(entity);
      const glm::vec3 color = light.power() != glm::vec3(0.0f) ? colorOf(light.color, 0.5f) : kDark;
      appendLight(light, place ? place->world_from_node : glm::mat4(1.0f), size, glm::vec4(color, 1.0f),
                  lines);
    }
  }
  if (options.keys) appendKeys(scene, lines);
  return lines;
}

}  // namespace

Overlays::Overlays(const gpu::Texture& depth, const spec::Size& size, bool linear)
    : size_(size),
      color_("overlays", {.format = linear ? GLenum{GL_RGBA32F} : GLenum{GL_RGBA16F},
                          .width = size.width,
                          .height = size.height,
                          .samples = depth.desc().samples}),
      target_("overlays", color_, &depth),
      programs_(kDebugShaders),
      lines_("overlay lines"),
      signs_("light probe signs"),
      view_("overlay view"),
      no_vertices_("overlays") {
  if (linear) defines_.push_back({"LAMBENT_LINEAR", "1"});
}

Result<void> Overlays::use(std::string_view file) {
  return programs_.use({{GL_VERTEX_SHADER, file}, {GL_FRAGMENT_SHADER, file}}, defines_);
}

Result<void> Overlays::draw(const OverlayOptions& options, const OverlayScene& scene, DataView* wires,
                            gpu::Counters& counters) {
  target_.bind();
  target_.clearColor({});
  view_.assignOne(ViewBlock{scene.view.view_from_world, scene.view.clip_from_view, {}});
  view_.bindUniform(kBindView);
  scene.tone_mapper.bindExposure(kBindExposure);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glEnable(GL_DEPTH_CLAMP);  // near and far plane fit the surfaces, and markers may lie beyond them
  Result<void> done = drawProbes(options, scene, counters);
  if (done && wires != nullptr) done = wires->drawWires(scene.world, scene.view, counters);
  view_.bindUniform(kBindView);  // wires bind another view
  gpu::blendPremultiplied();
  glDepthMask(GL_FALSE);
  if (done) done = drawLines(options, scene, counters);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_LESS);
  glDisable(GL_DEPTH_CLAMP);
  glDisable(GL_BLEND);
  return done;
}

Result<void> Overlays::drawProbes(const OverlayOptions& options, const OverlayScene& scene,
                                  gpu::Counters& counters) {
  if (!options.light_probes) return {};
  const streaming::Residency& residency = scene.world.residency();
  const auto group_count =
      static_cast<std::uint32_t>(std::min(residency.groups().size(), scene.light_plan.groups.size()));
  const float scene_radius = radiusOf(scene.world);
  std::vector<Sign> signs;
  for (std::uint32_t g = 0; g < group_count; ++g) {
    const std::span<const glm::vec3> places = scene.light_plan.groups[g].samples_ws;
    const glm::quat group_from_world = glm::conjugate(scene.world.rotationOf(g));
    const float radius = radiusFor(scene_radius, places);
    for (std::size_t s = 0; s < places.size(); ++s)
      signs.push_back({.place_and_radius = glm::vec4(places[s], radius),
                       .group_from_world = {group_from_world.x, group_from_world.y, group_from_world.z,
                                            group_from_world.w},
                       .light = scene.lights.firstOf(g, s),
                       .order = residency.groups()[g].order,
                       .pad = {}});
  }
  // If there are too many, those that are shown are spread evenly over all.
  if (const std::size_t count = signs.size(); count > kMaxSigns) {
    std::size_t at = 0;
    std::erase_if(signs, [&](const Sign&) {
      const std::size_t before = at++ * kMaxSigns / count;
      return before == at * kMaxSigns / count;
    });
  }
  if (signs.empty()) return {};
  if (Result<void> done = use("probe_marker.glsl"); !done) return done;
  signs_.assign(signs);
  signs_.bindStorage(kBindSigns);
  scene.lights.bindStorage(kBindLights);
  glDisable(GL_BLEND);
  // Faces of a cube map run clockwise as seen from outside. Culling is used because depth is clamped outside
  // the scene.
  glEnable(GL_CULL_FACE);
  glFrontFace(GL_CW);
  glDepthMask(GL_TRUE);
  no_vertices_.draw(kBallVertices, counters, signs.size());
  glFrontFace(GL_CCW);
  glDisable(GL_CULL_FACE);
  return {};
}

Result<void> Overlays::drawLines(const OverlayOptions& options, const OverlayScene& scene,
                                 gpu::Counters& counters) {
  std::vector<LineRecord> records;
  for (const OverlayLine& line : linesOf(options, scene))
    records.push_back({.from_and_width = glm::vec4(line.from_ws, line.width_px),
                       .to = glm::vec4(line.to_ws, 0.0f),
                       .color = line.color});
  if (records.empty()) return {};
  if (Result<void> done = use("overlay_line.glsl"); !done) return done;
  lines_.assign(records, counters);
  lines_.bindStorage(kBindLines);
  glUniform2f(kSizePx, static_cast<float>(size_.width), static_cast<float>(size_.height));
  glDisable(GL_CULL_FACE);
  // The offset moves lines that lie in a surface in front of it.
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(-1.0f, -4.0f);
  for (const bool hidden : {true, false}) {
    glDepthFunc(hidden ? GL_GREATER : GL_LEQUAL);
    glUniform1f(kStrength, hidden ? kHiddenStrength : 1.0f);
    no_vertices_.draw(6 * records.size(), counters);
  }
  glDisable(GL_POLYGON_OFFSET_FILL);
  return {};
}

Result<void> Overlays::layOver(gpu::Counters& counters) {
  std::vector<gpu::Define> defines;
  if (const std::uint32_t samples = color_.desc().samples; samples > 0)
    defines.push_back({"LAMBENT_SAMPLES", std::to_string(samples)});
  if (Result<void> done = programs_.use(
          {{GL_VERTEX_SHADER, "full_screen.vert"}, {GL_FRAGMENT_SHADER, "overlay_compose.frag"}}, defines);
      !done)
    return done;
  color_.bind(0);
  glDisable(GL_DEPTH_TEST);
  gpu::blendPremultiplied();
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE);  // alpha stays the coverage
  no_vertices_.draw(3, counters);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDisable(GL_BLEND);
  return {};
}

}  // namespace lambent::frame
