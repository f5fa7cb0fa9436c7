#include "runtime/debug/overlays.hpp"

#include <algorithm>
#include <limits>
#include <span>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
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
#include "runtime/draws/surface_record.hpp"
#include "runtime/draws/surface_shared.h"
#include "runtime/effects/neighborhood/neighborhood_shared.h"
#include "runtime/scene/bounds.hpp"

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

namespace {

// These are the bindings and uniform locations of the shaders.
constexpr GLuint kBindSigns = 1, kBindLights = 2, kBindCubes = 3, kBindDiscs = 4;
constexpr GLint kLightFromWorld = 0, kShares = 1, kDiscCount = 2, kShownCubeSize = 3;
constexpr GLuint kBindPoints = 0, kBindTexels = 1, kBindValues = 2, kBindSlots = 3, kBindGathered = 4;
constexpr GLsizei kVertices = 36 + 6 * 10 * 10 * 6;  // cube and ball
constexpr std::size_t kCubeTexels = 6 * ProbeMarkers::kCubeSize * ProbeMarkers::kCubeSize;

struct DiscRecord {
  glm::vec4 direction_and_radius, radiance;
};

// Returns a radius that is small relative to the scene and to the distance between neighbouring samples of a
// group. It uses the median of these distances, because two samples may stand close together. Cube and ball
// together are three and a half radii high.
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

ProbeMarkers::ProbeMarkers()
    : table_("light probe signs"),
      record_slots_("light probe slots"),
      discs_("light probe discs"),
      no_vertices_("light probe signs") {}

Result<ProbeMarkers> ProbeMarkers::create(const std::vector<gpu::Define>& defines) {
  ProbeMarkers signs;
  Result<gpu::Program> program = gpu::Program::create(
      "light probe signs",
      {{GL_VERTEX_SHADER, "probe_marker.vert"}, {GL_FRAGMENT_SHADER, "probe_marker.frag"}}, kDebugShaders,
      defines);
  if (!program) return failAgain(program.error());
  signs.program_ = std::move(*program);
  Result<gpu::Program> gather = gpu::Program::create(
      "light probe gather", {{GL_COMPUTE_SHADER, "probe_marker_gather.comp"}}, kDebugShaders);
  if (!gather) return failAgain(gather.error());
  signs.gather_program_ = std::move(*gather);
  return signs;
}

Result<void> ProbeMarkers::update(const OverlayOptions& options, const OverlayScene& scene,
                                  gpu::Counters& counters) {
  place(options, scene);
  return capture(scene, counters);
}

void ProbeMarkers::place(const OverlayOptions& options, const OverlayScene& scene) {
  const streaming::Residency& residency = scene.world.residency();
  const auto group_count =
      static_cast<std::uint32_t>(std::min(residency.groups().size(), scene.lit_scene.groups.size()));
  std::size_t count = 0, at = 0;
  for (std::uint32_t g = 0; g < group_count; ++g)
    if (options.shows(g)) count += residency.groups()[g].light_probes.size();
  signs_.clear();
  points_.clear();
  const scene::Box bounds = scene::worldBounds(scene.world.registry());
  const float scene_radius = bounds.empty() || bounds.radius() == 0.0f ? 1.0f : bounds.radius();
  for (std::uint32_t g = 0; g < group_count; ++g) {
    if (!options.shows(g)) continue;
    const lighting::IncidentGroup& group = scene.lit_scene.groups[g];
    const glm::quat group_from_world = glm::conjugate(scene.world.rotationOf(g));
    const float radius = radiusFor(scene_radius, group.samples_ws);
    for (std::size_t s = 0; s < group.samples_ws.size(); ++s, ++at) {
      // If there are too many, the shown ones are spread evenly over all.
      if (count > kMaxSigns && at * kMaxSigns / count == (at + 1) * kMaxSigns / count) continue;
      signs_.push_back({.place_and_radius = glm::vec4(group.samples_ws[s], radius),
                        .group_from_world = {group_from_world.x, group_from_world.y, group_from_world.z,
                                             group_from_world.w},
                        .light = scene.lights.firstOf(g, s),
                        .order = residency.groups()[g].order,
                        .pad = {}});
      points_.push_back({.position_ws = group.samples_ws[s],
                         .own_body = group.body,
                         .queries = {},
                         .left_out = group.left_out});
    }
  }
  table_.assign(std::span<const Sign>(signs_));
}

Result<void> ProbeMarkers::capture(const OverlayScene& scene, gpu::Counters& counters) {
  const streaming::Residency& residency = scene.world.residency();
  if (points_.empty() || scene.lit_scene.bodies.empty() ||
      scene.proxies.groups().size() != residency.groups().size()) {
    cubes_ = {};
    cubes_changed_.forget();
    return {};
  }
  if (!capture_) {
    auto made =
        lighting::Capture::create({.size = kCubeSize, .subsamples = 4, .order = 1}, scene.environment);
    if (!made) return failAgain(made.error());
    capture_ = std::move(*made);
  }
  // Only the texels of the capture are needed, not its light.
  if (capture_->pending() && !capture_->take(/*wait=*/false)) return {};
  std::vector<glm::vec4> seen;
  std::vector<std::uint64_t> shine;
  for (const lighting::CapturePoint& point : points_) {
    seen.emplace_back(point.position_ws, static_cast<float>(point.own_body));
    for (const std::uint32_t body : point.left_out) shine.push_back(body);
  }
  std::vector<lighting::CaptureBody> bodies;
  for (const lighting::IncidentBody& body : scene.lit_scene.bodies) {
    bodies.push_back(body.body);
    for (int column = 0; column < 4; ++column) seen.push_back(body.body.world_from_proxy[column]);
  }
  for (std::size_t g = 0; g < residency.groups().size(); ++g) shine.push_back(scene.proxies.versionOf(g));
  if (!cubes_changed_.renew(seen, shine)) return {};
  if (proxies_changed_.renew(residency.proxiesVersion())) {
    const BodyProxies known = proxiesOf(residency);
    capture_->setProxies(known.proxies, counters, known.keys);
  }
  if (Result<void> done =
          capture_->run(scene.environment, bodies, points_, scene.proxies.radiance(), counters);
      !done)
    return done;
  const std::size_t bytes = points_.size() * kCubeTexels * sizeof(glm::vec4);
  if (cubes_.byteCount() < bytes) cubes_ = gpu::Buffer("light probe cubes", bytes);
  constexpr float kOpen[] = {0.0f, 0.0f, 0.0f, 0.0f};
  glClearNamedBufferData(cubes_.id(), GL_RGBA32F, GL_RGBA, GL_FLOAT, kOpen);
  const lighting::Capture::Texels texels = capture_->texels();
  if (texels.points.empty()) return {};
  record_slots_.assign(std::span<const std::uint32_t>(texels.points));
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  gather_program_.use();
  glUniform1ui(0, static_cast<GLuint>(kCubeTexels));
  texels.records->bindStorage(kBindPoints);
  texels.texels->bindStorage(kBindTexels);
  texels.values->bindStorage(kBindValues);
  record_slots_.bindStorage(kBindSlots);
  cubes_.bindStorage(kBindGathered);
  glDispatchCompute(static_cast<GLuint>(texels.points.size()), 1, 1);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  ++counters.dispatches;
  return {};
}

void ProbeMarkers::draw(const OverlayScene& scene, gpu::Counters& counters) {
  if (signs_.empty()) return;
  std::vector<DiscRecord> discs;
  // Key lights that were found in a picture are already in the sky's cube.
  const glm::mat3 world_from_light = scene.environment.worldFromLight();
  for (std::size_t i = 0; i < lighting::Environment::kSets; ++i)
    for (const lighting::Disc& disc : scene.environment.shownOf(i).discs)
      discs.push_back({glm::vec4(world_from_light * disc.direction, disc.radius_rad),
                       glm::vec4(scene.environment.shareOf(i) * disc.radiance, 0.0f)});
  const auto disc_count = static_cast<GLuint>(discs.size());
  if (discs.empty()) discs.emplace_back();
  discs_.assign(std::span<const DiscRecord>(discs));
  program_.use();
  table_.bindStorage(kBindSigns);
  scene.lights.bindStorage(kBindLights);
  discs_.bindStorage(kBindDiscs);
  if (cubes_)
    cubes_.bindStorage(kBindCubes);
  else
    discs_.bindStorage(kBindCubes);  // bound but not read
  const glm::mat3 light_from_world = glm::transpose(world_from_light);
  glUniformMatrix3fv(kLightFromWorld, 1, GL_FALSE, glm::value_ptr(light_from_world));
  glUniform2f(kShares, scene.environment.shareOf(0), scene.environment.shareOf(1));
  glUniform1ui(kDiscCount, disc_count);
  glUniform1i(kShownCubeSize, cubes_ ? static_cast<GLint>(kCubeSize) : 0);
  for (GLuint i = 0; i < lighting::Environment::kSets; ++i) {
    scene.sky.cube(i).bind(i);
    glBindSampler(i, 0);
  }
  glBindVertexArray(no_vertices_.id());
  glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
  glDisable(GL_BLEND);
  // Faces of a cube map run clockwise as seen from outside. Culling is used because depth is clamped outside
  // the scene.
  glEnable(GL_CULL_FACE);
  glFrontFace(GL_CW);
  glDepthMask(GL_TRUE);
  glDrawArraysInstanced(GL_TRIANGLES, 0, kVertices, static_cast<GLsizei>(signs_.size()));
  glFrontFace(GL_CCW);
  glDisable(GL_CULL_FACE);
  counters.draws += static_cast<std::uint32_t>(signs_.size());
  ++counters.draw_calls;
}

}  // namespace lambent::frame
