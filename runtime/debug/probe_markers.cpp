#include <algorithm>
#include <limits>
#include <span>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>

#include "runtime/debug/overlays.hpp"
#include "runtime/scene/bounds.hpp"

namespace lambent::frame {

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
