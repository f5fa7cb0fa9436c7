#include "runtime/frame/stand_ins.hpp"

#include <algorithm>
#include <array>

#include "lambent_frame_embedded.hpp"
#include "runtime/frame/lit_scene.hpp"
#include "runtime/sh/window.hpp"
#include "runtime/streaming/sizes.hpp"

namespace lambent::frame {

namespace {

constexpr gpu::FindText kShaders[] = {&embedded::lambent_frame::find};
constexpr int kBands = 3;  // of the light: more hardly reach a matte surface

static_assert(sizeof(StandInTriangle) == streaming::kStandInTriangleBytes &&
              sizeof(StandInGroup) == streaming::kStandInGroupBytes);

struct ViewBlock {
  glm::mat4 view_from_world, clip_from_view;
};

std::uint32_t orderOf(const bundle::Group& group) {
  std::uint32_t order = 1;
  for (const bundle::Cell& cell : group.cells)
    for (const bundle::CellTransfer& transfer : cell.transfers) order = std::max(order, transfer.shape.order);
  return order;
}

StandInTriangle describe(const bundle::CaptureProxy& proxy, const bundle::ProxyTriangle& triangle,
                         const std::vector<glm::vec3>& lamps, std::uint32_t group) {
  StandInTriangle record{.corners = {}, .reflectance = {}, .emission = {}, .group = group};
  glm::vec3 reflectance(0.0f), emission(0.0f);
  for (std::uint32_t e = 0; e < triangle.entry_count; ++e)
    reflectance += proxy.entries[triangle.first_entry + e].reflectance;
  if (triangle.light >= 0) emission = triangle.emission * lamps[static_cast<std::size_t>(triangle.light)];
  for (int axis = 0; axis < 3; ++axis) {
    for (int corner = 0; corner < 3; ++corner)
      record.corners[3 * corner + axis] =
          proxy.positions[triangle.vertices[static_cast<std::size_t>(corner)]][axis];
    record.reflectance[axis] = reflectance[axis];
    record.emission[axis] = emission[axis];
  }
  return record;
}

}  // namespace

StandIns::StandIns()
    : groups_table_("stand-in groups"), triangles_table_("stand-in triangles"), view_("stand-in view") {}

void StandIns::collect(const World& world) {
  places_.clear();
  triangles_.clear();
  for (const StandIn& stand_in : world.standIns())
    for (std::uint32_t g = 0; g < stand_in.proxies.size(); ++g) {
      if (!stand_in.proxies[g]) continue;
      const bundle::CaptureProxy& proxy = *stand_in.proxies[g];
      const bundle::ProxyLevel& finest = proxy.levels.front();
      const std::vector<glm::vec3> lamps = world.lampsOf(stand_in.bundle, g);
      for (std::uint32_t t = 0; t < finest.triangle_count; ++t)
        triangles_.push_back(describe(proxy, proxy.triangles[finest.first_triangle + t], lamps,
                                      static_cast<std::uint32_t>(places_.size())));
      places_.push_back({stand_in.bundle, g});
    }
}

void StandIns::light(const World& world, const lighting::Environment& environment,
                     std::span<const lighting::LocalLight> lights, const FrameSettings& settings) {
  groups_.clear();
  // As groups have it that nothing else shines on, once for each order.
  std::array<std::optional<sh::LightVector>, sh::kMaxOrder + 1> windowed;
  for (const Place& place : places_) {
    const bundle::Group& described = world.description(place.bundle).groups[place.group];
    const std::uint32_t order = std::min(orderOf(described), settings.order);
    if (!windowed[order])
      windowed[order] =
          sh::applyWindow(environment.light().truncated(static_cast<int>(order)), settings.window)
              .truncated(kBands);
    sh::LightVector light = *windowed[order];
    StandInGroup record{.world_from_group = world.worldFromGroup(place.bundle, place.group), .light = {}};
    const scene::Box bounds{described.bounds_min, described.bounds_max};
    if (!bounds.empty()) {
      const glm::vec3 center_ws(record.world_from_group * glm::vec4(bounds.center(), 1.0f));
      for (const lighting::LocalLight& local : lights)
        if (!standsWithin(bounds, record.world_from_group, local))
          light += lighting::lightAt(local, center_ws, kBands);
    }
    if (settings.diffuse)
      for (std::size_t i = 0; i < std::size(record.light); ++i) record.light[i] = glm::vec4(light.c[i], 0.0f);
    groups_.push_back(record);
  }
}

Result<void> StandIns::prepare(const World& world, const lighting::Environment& environment,
                               std::span<const lighting::LocalLight> lights, const FrameSettings& settings,
                               gpu::Counters& counters) {
  const Seen now{.stand_ins = world.standInsVersion(),
                 .lamps = world.lampsVersion(),
                 .local_lights = world.registry().version<scene::LocalLightComponent>(),
                 .transforms = world.transformsVersion(),
                 .environment = environment.version(),
                 .settings = settings};
  if (seen_ == now) return {};
  const bool others = !seen_ || seen_->stand_ins != now.stand_ins;
  // Emissive triangles follow their lamps, also where these are moved out of their place.
  const bool collect_anew = others || seen_->lamps != now.lamps || seen_->local_lights != now.local_lights ||
                            seen_->transforms != now.transforms;
  seen_ = now;
  if (!others && places_.empty()) return {};
  if (collect_anew) collect(world);
  light(world, environment, lights, settings);
  if (triangles_.empty()) return {};
  if (!program_) {
    Result<gpu::Program> made = gpu::Program::create(
        "stand-ins", {{GL_VERTEX_SHADER, "stand_in.vert"}, {GL_FRAGMENT_SHADER, "stand_in.frag"}}, kShaders,
        {});
    if (!made) return failAgain(made.error());
    program_ = std::move(*made);
    no_vertices_ = gpu::VertexArray("stand-ins");
  }
  if (collect_anew) {
    triangles_table_.assign(std::span<const StandInTriangle>(triangles_));
    counters.uploaded_bytes += triangles_.size() * sizeof(StandInTriangle);
  }
  groups_table_.assign(std::span<const StandInGroup>(groups_));
  counters.uploaded_bytes += groups_.size() * sizeof(StandInGroup);
  return {};
}

void StandIns::draw(const spec::View& view, gpu::Counters& counters) {
  if (triangles_.empty()) return;
  const ViewBlock block{view.view_from_world, view.clip_from_view};
  view_.assign(std::span<const ViewBlock>(&block, 1));
  program_->use();
  glBindBufferBase(GL_UNIFORM_BUFFER, kBindStandInView, view_.buffer().id());
  groups_table_.bindStorage(kBindStandInGroups);
  triangles_table_.bindStorage(kBindStandInTriangles);
  glBindVertexArray(no_vertices_.id());
  glDisable(GL_BLEND);
  glDepthMask(GL_TRUE);
  glEnable(GL_CULL_FACE);
  glFrontFace(GL_CCW);
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(3 * triangles_.size()));
  glDisable(GL_CULL_FACE);
  ++counters.draws;
  ++counters.draw_calls;
}

}  // namespace lambent::frame
