#include "runtime/debug/overlays.hpp"

#include <algorithm>

#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

#include "lambent_debug_embedded.hpp"
#include "lambent_draws_embedded.hpp"
#include "lambent_effects_neighborhood_embedded.hpp"
#include "lambent_evaluate_embedded.hpp"
#include "lambent_lighting_embedded.hpp"
#include "lambent_shadows_embedded.hpp"
#include "lambent_surface_embedded.hpp"
#include "lambent_tone_map_embedded.hpp"
#include "lambent_transfer_embedded.hpp"
#include "runtime/debug/overlay_lines.hpp"
#include "runtime/debug/overlay_slice_shared.h"
#include "runtime/draws/surface_shared.h"
#include "runtime/draws/view.hpp"
#include "runtime/effects/neighborhood/neighborhood_shared.h"

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
constexpr GLuint kBindLines = 1, kBindExposure = 7;
constexpr float kHiddenStrength = 0.22f;

struct LineRecord {
  glm::vec4 from_and_width, to, color;
};

}  // namespace

Overlays::Overlays(std::uint32_t samples, bool linear)
    : samples_(samples),
      linear_(linear),
      lines_("overlay lines"),
      slices_("overlay slices"),
      view_("overlay view"),
      no_vertices_("overlays") {}

std::vector<gpu::Define> Overlays::defines() const {
  std::vector<gpu::Define> defines;
  if (samples_ > 0) defines.push_back({"LAMBENT_SAMPLES", std::to_string(samples_)});
  if (linear_) defines.push_back({"LAMBENT_LINEAR", "1"});
  return defines;
}

Result<Overlays> Overlays::create(std::uint32_t samples, bool linear) {
  Overlays overlays(samples, linear);
  Result<gpu::Program> compose = gpu::Program::create(
      "overlay compose",
      {{GL_VERTEX_SHADER, "full_screen.vert"}, {GL_FRAGMENT_SHADER, "overlay_compose.frag"}}, kDebugShaders,
      overlays.defines());
  if (!compose) return failAgain(compose.error());
  overlays.compose_ = std::move(*compose);
  return overlays;
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
  if (options.light_probes) {
    if (!light_probes_) {
      Result<ProbeMarkers> made = ProbeMarkers::create(defines());
      if (!made) return failAgain(made.error());
      light_probes_ = std::move(*made);
    }
    if (Result<void> done = light_probes_->update(options, scene, counters); !done) return done;
  }
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
  if (options.light_probes) light_probes_->draw(scene, counters);
  Result<void> done = wires();
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

Result<void> Overlays::drawSlices(const OverlayOptions& options, const OverlayScene& scene,
                                  gpu::Counters& counters) {
  if (!options.neighborhoods) return {};
  std::vector<SliceRecord> records;
  const std::vector<std::uint32_t> foremost =
      foremostNeighborhoods(scene.world, scene.neighborhoods, options, scene.view.eye_ws);
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
  if (!slices_program_) {
    Result<gpu::Program> made = gpu::Program::create(
        "overlay slices",
        {{GL_VERTEX_SHADER, "overlay_slice.vert"}, {GL_FRAGMENT_SHADER, "overlay_slice.frag"}}, kDebugShaders,
        defines());
    if (!made) return failAgain(made.error());
    slices_program_ = std::move(*made);
  }
  slices_.assign(std::span<const SliceRecord>(records));
  slices_program_->use();
  slices_.bindStorage(kBindSlices);
  scene.lights.bindStorage(kBindSliceLights);
  scene.neighborhoods.effect().bind();
  glBindSampler(effects::neighborhood::kUnitAtlas, 0);
  glBindVertexArray(no_vertices_.id());
  glDisable(GL_CULL_FACE);
  glDepthFunc(GL_LEQUAL);
  glUniform1f(kStrength, 1.0f);
  glDrawArraysInstanced(GL_TRIANGLES, 0, 6, static_cast<GLsizei>(records.size()));
  counters.draws += static_cast<std::uint32_t>(records.size());
  ++counters.draw_calls;
  return {};
}

Result<void> Overlays::drawLines(const OverlayOptions& options, const OverlayScene& scene,
                                 gpu::Counters& counters) {
  std::vector<LineRecord> records;
  std::vector<OverlayLine> lines = linesOf(scene.world, scene.neighborhoods, options, scene.view.eye_ws);
  if (options.keys)
    appendKeys(scene.environment.keys(), scene.key_shadows.regions(), options.key,
               scene::worldBounds(scene.world.registry()), scene.view, lines);
  for (const OverlayLine& line : lines)
    records.push_back({.from_and_width = glm::vec4(line.from_ws, line.width_px),
                       .to = glm::vec4(line.to_ws, 0.0f),
                       .color = line.color});
  if (records.empty()) return {};
  if (!lines_program_) {
    Result<gpu::Program> made = gpu::Program::create(
        "overlay lines", {{GL_VERTEX_SHADER, "overlay_line.vert"}, {GL_FRAGMENT_SHADER, "overlay_line.frag"}},
        kDebugShaders, defines());
    if (!made) return failAgain(made.error());
    lines_program_ = std::move(*made);
  }
  lines_.assign(std::span<const LineRecord>(records));
  counters.uploaded_bytes += records.size() * sizeof(LineRecord);
  lines_program_->use();
  lines_.bindStorage(kBindLines);
  glUniform2f(kSizePx, static_cast<float>(size_.width), static_cast<float>(size_.height));
  glBindVertexArray(no_vertices_.id());
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

}  // namespace lambent::frame
