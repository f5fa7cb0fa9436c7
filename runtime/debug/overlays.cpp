#include "runtime/debug/overlays.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <string>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "lambent_debug_embedded.hpp"
#include "lambent_draws_embedded.hpp"
#include "lambent_effects_neighborhood_embedded.hpp"
#include "lambent_evaluate_embedded.hpp"
#include "lambent_lighting_embedded.hpp"
#include "lambent_shadows_embedded.hpp"
#include "lambent_surface_embedded.hpp"
#include "lambent_tone_map_embedded.hpp"
#include "lambent_transfer_embedded.hpp"
#include "runtime/debug/overlay_slice_shared.h"
#include "runtime/draws/surface_shared.h"
#include "runtime/draws/view.hpp"
#include "runtime/effects/neighborhood/neighborhood_shared.h"
#include "runtime/scene/bounds.hpp"
#include "runtime/spec/numbers.hpp"

namespace lambent::frame {

const gpu::FindText kDebugShaders[9] = {&embedded::lambent_debug::find,
                                        &embedded::lambent_draws::find,
                                        &embedded::lambent_surface::find,
                                        &embedded::lambent_shadows::find,
                                        &embedded::lambent_tone_map::find,
                                        &embedded::lambent_lighting::find,
                                        &embedded::lambent_evaluate::find,
                                        &embedded::lambent_transfer::find,
                                        &embedded::lambent_effects_neighborhood::find};

namespace {

// These are the uniform locations and bindings of the shaders.
constexpr GLint kSizePx = 0, kStrength = 1;
constexpr GLuint kBindLines = 1, kBindSigns = 1, kBindLights = 2, kBindExposure = 7;
constexpr GLsizei kBallVertices = 6 * 10 * 10 * 6;
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

}  // namespace

Overlays::Overlays(std::uint32_t samples, bool linear)
    : samples_(samples),
      linear_(linear),
      lines_("overlay lines"),
      slices_("overlay slices"),
      signs_("light probe signs"),
      view_("overlay view"),
      no_vertices_("overlays") {}

Result<Overlays> Overlays::create(std::uint32_t samples, bool linear) {
  Overlays overlays(samples, linear);
  std::vector<gpu::Define> defines;
  if (samples > 0) defines.push_back({"LAMBENT_SAMPLES", std::to_string(samples)});
  Result<gpu::Program> compose = gpu::Program::create(
      "overlay compose",
      {{GL_VERTEX_SHADER, "full_screen.vert"}, {GL_FRAGMENT_SHADER, "overlay_compose.frag"}}, kDebugShaders,
      defines);
  if (!compose) return failAgain(compose.error());
  overlays.compose_ = std::move(*compose);
  return overlays;
}

Result<void> Overlays::use(std::string_view label, std::string_view file) {
  auto found = programs_.find(label);
  if (found == programs_.end()) {
    std::vector<gpu::Define> defines;
    if (linear_) defines.push_back({"LAMBENT_LINEAR", "1"});
    Result<gpu::Program> made = gpu::Program::create(
        label, {{GL_VERTEX_SHADER, file}, {GL_FRAGMENT_SHADER, file}}, kDebugShaders, defines);
    if (!made) return failAgain(made.error());
    found = programs_.emplace(label, std::move(*made)).first;
  }
  found->second.use();
  glBindVertexArray(no_vertices_.id());
  return {};
}

void Overlays::attach(const gpu::Texture& depth, const spec::Size& size) {
  size_ = size;
  color_ = gpu::Texture("overlays", {.format = linear_ ? GLenum{GL_RGBA32F} : GLenum{GL_RGBA16F},
                                     .width = size.width,
                                     .height = size.height,
                                     .samples = samples_});
  target_ = gpu::Framebuffer("overlays", color_, &depth);
}

Result<void> Overlays::draw(const OverlayOptions& options, const OverlayScene& scene,
                            const std::function<Result<void>()>& wires, gpu::Counters& counters) {
  glBindFramebuffer(GL_FRAMEBUFFER, target_.id());
  glViewport(0, 0, static_cast<GLsizei>(size_.width), static_cast<GLsizei>(size_.height));
  constexpr float kNothing[] = {0.0f, 0.0f, 0.0f, 0.0f};
  glClearNamedFramebufferfv(target_.id(), GL_COLOR, 0, kNothing);
  const ViewBlock block{scene.view.view_from_world, scene.view.clip_from_view, {}};
  view_.assign(std::span<const ViewBlock>(&block, 1));
  glBindBufferBase(GL_UNIFORM_BUFFER, kBindView, view_.buffer().id());
  scene.tone_mapper.bindExposure(kBindExposure);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glEnable(GL_DEPTH_CLAMP);  // near and far plane fit the surfaces, and markers may lie beyond them
  Result<void> done = drawProbes(options, scene, counters);
  if (done) done = wires();
  // wires() binds another view
  glBindBufferBase(GL_UNIFORM_BUFFER, kBindView, view_.buffer().id());
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glDepthMask(GL_FALSE);
  if (done) done = drawSlices(options, scene, counters);
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
      static_cast<std::uint32_t>(std::min(residency.groups().size(), scene.lit_scene.groups.size()));
  std::size_t count = 0, at = 0;
  for (std::uint32_t g = 0; g < group_count; ++g)
    if (options.shows(g)) count += residency.groups()[g].light_probes.size();
  const scene::Box bounds = scene::worldBounds(scene.world.registry());
  const float scene_radius = bounds.empty() || bounds.radius() == 0.0f ? 1.0f : bounds.radius();
  std::vector<Sign> signs;
  for (std::uint32_t g = 0; g < group_count; ++g) {
    if (!options.shows(g)) continue;
    const std::span<const glm::vec3> places = scene.lit_scene.groups[g].samples_ws;
    const glm::quat group_from_world = glm::conjugate(scene.world.rotationOf(g));
    const float radius = radiusFor(scene_radius, places);
    for (std::size_t s = 0; s < places.size(); ++s, ++at) {
      // If there are too many, the shown ones are spread evenly over all.
      if (count > kMaxSigns && at * kMaxSigns / count == (at + 1) * kMaxSigns / count) continue;
      signs.push_back({.place_and_radius = glm::vec4(places[s], radius),
                       .group_from_world = {group_from_world.x, group_from_world.y, group_from_world.z,
                                            group_from_world.w},
                       .light = scene.lights.firstOf(g, s),
                       .order = residency.groups()[g].order,
                       .pad = {}});
    }
  }
  if (signs.empty()) return {};
  if (Result<void> done = use("light probe signs", "probe_marker.glsl"); !done) return done;
  signs_.assign(std::span<const Sign>(signs));
  signs_.bindStorage(kBindSigns);
  scene.lights.bindStorage(kBindLights);
  glDisable(GL_BLEND);
  // Faces of a cube map run clockwise as seen from outside. Culling is used because depth is clamped outside
  // the scene.
  glEnable(GL_CULL_FACE);
  glFrontFace(GL_CW);
  glDepthMask(GL_TRUE);
  glDrawArraysInstanced(GL_TRIANGLES, 0, kBallVertices, static_cast<GLsizei>(signs.size()));
  glFrontFace(GL_CCW);
  glDisable(GL_CULL_FACE);
  counters.draws += static_cast<std::uint32_t>(signs.size());
  ++counters.draw_calls;
  return {};
}

Result<void> Overlays::drawSlices(const OverlayOptions& options, const OverlayScene& scene,
                                  gpu::Counters& counters) {
  if (!options.neighborhoods) return {};
  std::vector<SliceRecord> records;
  const std::vector<std::uint32_t> foremost = foremostNeighborhoods(options, scene);
  for (const effects::neighborhood::Grid& grid : scene.neighborhoods.effect().grids()) {
    if (!grid.ready || grid.place.outputs == 0) continue;
    if (std::ranges::find(foremost, grid.group) == foremost.end()) continue;
    const glm::vec3 size = glm::vec3(grid.points.size) - 1.0f;
    glm::mat4 body_from_place(1.0f);
    for (int axis = 0; axis < 3; ++axis)
      body_from_place[axis][axis] =
          (grid.points.bounds_max[axis] - grid.points.bounds_min[axis]) / size[axis];
    body_from_place[3] = glm::vec4(grid.points.bounds_min, 1.0f);
    const std::uint32_t order = scene.world.residency().groups()[grid.group].order;
    records.push_back(
        {.world_from_place = scene.world.worldFromGroup(grid.group) * body_from_place,
         .normal =
             glm::vec4(glm::conjugate(scene.world.rotationOf(grid.group)) * options.slice.normal_ws, 0.0f),
         .grid = grid.place,
         .axis = static_cast<std::uint32_t>(options.slice.axis),
         .position = options.slice.position,
         .light = scene.lights.firstOf(grid.group),
         .coefficients = order * order});
  }
  if (records.empty()) return {};
  if (Result<void> done = use("overlay slices", "overlay_slice.glsl"); !done) return done;
  slices_.assign(std::span<const SliceRecord>(records));
  slices_.bindStorage(kBindSlices);
  scene.lights.bindStorage(kBindSliceLights);
  scene.neighborhoods.effect().bind();
  glBindSampler(effects::neighborhood::kUnitAtlas, 0);
  glDisable(GL_CULL_FACE);
  glDepthFunc(GL_LEQUAL);
  glDrawArraysInstanced(GL_TRIANGLES, 0, 6, static_cast<GLsizei>(records.size()));
  counters.draws += static_cast<std::uint32_t>(records.size());
  ++counters.draw_calls;
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
  if (Result<void> done = use("overlay lines", "overlay_line.glsl"); !done) return done;
  lines_.assign(std::span<const LineRecord>(records));
  counters.uploaded_bytes += records.size() * sizeof(LineRecord);
  lines_.bindStorage(kBindLines);
  glUniform2f(kSizePx, static_cast<float>(size_.width), static_cast<float>(size_.height));
  glDisable(GL_CULL_FACE);
  // The offset moves lines that lie in a surface in front of it.
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(-1.0f, -4.0f);
  for (const bool hidden : {true, false}) {
    glDepthFunc(hidden ? GL_GREATER : GL_LEQUAL);
    glUniform1f(kStrength, hidden ? kHiddenStrength : 1.0f);
    glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(6 * records.size()));
    ++counters.draws;
    ++counters.draw_calls;
  }
  glDisable(GL_POLYGON_OFFSET_FILL);
  return {};
}

void Overlays::layOver(gpu::Counters& counters) {
  compose_.use();
  color_.bind(0);
  glBindSampler(0, 0);
  glBindVertexArray(no_vertices_.id());
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE);  // alpha stays the coverage
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDisable(GL_BLEND);
  ++counters.draws;
  ++counters.draw_calls;
}

namespace {

struct OverlayRow {
  std::string_view name;
  bool OverlayOptions::*flag;
  std::string_view former{};  // its former name, which is still understood; may be empty
};

constexpr std::array<OverlayRow, 6> kRows = {
    {{"light-probes", &OverlayOptions::light_probes, "light-samples"},
     {"neighborhoods", &OverlayOptions::neighborhoods},
     {"volumes", &OverlayOptions::volumes},
     {"groups", &OverlayOptions::groups},
     {"lights", &OverlayOptions::lights},
     {"keys", &OverlayOptions::keys}}};

}  // namespace

std::string knownOverlays() {
  std::string known;
  for (const OverlayRow& row : kRows) {
    if (!known.empty()) known += ", ";
    known += row.name;
    if (row.flag == &OverlayOptions::neighborhoods) known += "[:x|y|z,0..1]";
  }
  return known;
}

bool OverlayOptions::shows(std::uint32_t group) const {
  return selected_groups.empty() || std::ranges::find(selected_groups, group) != selected_groups.end();
}

Result<OverlayOptions> parseOverlays(std::string_view list) {
  OverlayOptions options;
  const auto unknown = [&](std::string_view word, std::string_view problem) {
    return fail("overlay", fmt::format("\"{}\" {}", word, problem), "give a list of " + knownOverlays());
  };
  while (!list.empty()) {
    std::size_t end = std::min(list.find(','), list.size());
    std::string_view word = list.substr(0, end);
    const std::size_t colon = word.find(':');
    const std::string_view name = word.substr(0, colon);
    const auto row = std::ranges::find_if(kRows, [&](const OverlayRow& known) {
      return !name.empty() && (name == known.name || name == known.former);
    });
    if (row == kRows.end()) return unknown(word, "is not known");
    options.*row->flag = true;
    if (colon != std::string_view::npos) {
      // The argument has a comma of its own.
      end = std::min(list.find(',', end + 1), list.size());
      word = list.substr(0, end);
      if (row->flag != &OverlayOptions::neighborhoods) return unknown(word, "has no slice");
      const std::string_view place = word.substr(colon + 1);
      const std::size_t axis =
          place.empty() ? std::string_view::npos : std::string_view("xyz").find(place[0]);
      if (axis == std::string_view::npos || place.size() < 3 || place[1] != ',')
        return unknown(word, "is not an axis and a position");
      const std::optional<float> position = spec::parseNumber(std::string(place.substr(2)));
      if (!position || *position < 0.0f || *position > 1.0f)
        return unknown(word, "is not an axis and a position");
      options.slice.axis = static_cast<int>(axis);
      options.slice.position = *position;
    }
    list.remove_prefix(std::min(end + 1, list.size()));
  }
  return options;
}

}  // namespace lambent::frame
