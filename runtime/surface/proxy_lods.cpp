#include "runtime/surface/proxy_lods.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "runtime/light_plan/light_plan.hpp"
#include "runtime/streaming/resident_tables.hpp"
#include "runtime/surface/surfaces.hpp"

namespace lambent::frame {

namespace {

constexpr std::uint64_t kPageBytes = std::uint64_t{1} << 20;
constexpr int kProxyLightBands = 3;  // of the light; higher bands hardly reach a diffuse surface

static_assert(sizeof(ProxyLodTriangle) == streaming::kProxyLodTriangleBytes &&
              sizeof(ProxyLodGroup) == streaming::kProxyLodGroupBytes);

std::uint32_t orderOf(const bundle::Group& group) {
  std::uint32_t order = 1;
  for (const bundle::Cell& cell : group.cells)
    for (const bundle::CellTransfer& transfer : cell.transfers) order = std::max(order, transfer.shape.order);
  return order;
}

ProxyLodTriangle describe(const bundle::CaptureProxy& proxy, const bundle::ProxyTriangle& triangle,
                          const std::vector<glm::vec3>& lamps, std::uint32_t group) {
  ProxyLodTriangle record{.corners = {}, .reflectance = {}, .emission = {}, .group = group};
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

ProxyLods::ProxyLods()
    : programs_(kSurfaceShaders),
      triangles_("proxy levels of detail", kPageBytes, std::make_shared<gpu::Staging>(kPageBytes)),
      groups_table_("proxy level of detail groups"),
      view_("proxy level of detail view") {}

void ProxyLods::write(Body& body, std::uint32_t slot, const bundle::CaptureProxy& proxy,
                      gpu::Counters& counters) {
  const bundle::ProxyLevel& finest = proxy.levels.front();
  std::vector<ProxyLodTriangle> records;
  for (std::uint32_t t = 0; t < finest.triangle_count; ++t)
    records.push_back(describe(proxy, proxy.triangles[finest.first_triangle + t], body.lamps, slot));
  triangles_.write(body.triangles, 0, std::as_bytes(std::span(records)));
  counters.uploaded_bytes += records.size() * sizeof(ProxyLodTriangle);
}

Result<void> ProxyLods::bring(const World& world, const ProxyLod& proxy_lod, bundle::GroupIndex group,
                              gpu::Counters& counters) {
  const bundle::CaptureProxy& proxy = *proxy_lod.proxies[group.value];
  const Result<gpu::Allocation> block =
      triangles_.allocate(sizeof(ProxyLodTriangle) * proxy.levels.front().triangle_count);
  if (!block) return failAgain(block.error());
  auto free = std::ranges::find_if(bodies_, [](const Body& body) { return !body.triangles; });
  if (free == bodies_.end()) free = bodies_.insert(free, Body{});
  const auto slot = static_cast<std::uint32_t>(free - bodies_.begin());
  *free = {.id = proxy_lod.id,
           .bundle = proxy_lod.bundle,
           .group = group,
           .triangles = *block,
           .lamps = world.lampsOf(proxy_lod.bundle, group)};
  slots_.emplace(std::pair(proxy_lod.id, group), slot);
  write(*free, slot, proxy, counters);
  return {};
}

Result<void> ProxyLods::follow(const World& world, gpu::Counters& counters) {
  std::vector<bool> stays(bodies_.size(), false);
  const std::vector<ProxyLod> proxy_lods = world.proxyLods();
  for (const ProxyLod& proxy_lod : proxy_lods)
    for (std::uint32_t g = 0; g < proxy_lod.proxies.size(); ++g) {
      const auto found = slots_.find({proxy_lod.id, bundle::GroupIndex{g}});
      if (found == slots_.end()) continue;
      stays[found->second] = true;
      Body& body = bodies_[found->second];
      if (body.lamps.empty()) continue;
      std::vector<glm::vec3> lamps = world.lampsOf(proxy_lod.bundle, body.group);
      if (lamps == body.lamps) continue;
      body.lamps = std::move(lamps);
      write(body, found->second, *proxy_lod.proxies[g], counters);
    }
  for (std::size_t slot = 0; slot < stays.size(); ++slot) {
    Body& body = bodies_[slot];
    if (stays[slot] || !body.triangles) continue;
    triangles_.release(body.triangles);
    slots_.erase({body.id, body.group});
    body = {};
  }
  for (const ProxyLod& proxy_lod : proxy_lods)
    for (std::uint32_t g = 0; g < proxy_lod.proxies.size(); ++g)
      if (proxy_lod.proxies[g] && !slots_.contains({proxy_lod.id, bundle::GroupIndex{g}}))
        if (Result<void> done = bring(world, proxy_lod, bundle::GroupIndex{g}, counters); !done) return done;
  batches_.clear();
  for (const Body& body : bodies_) {
    if (!body.triangles) continue;
    Batch& batch = batches_[body.triangles.page];
    batch.first.push_back(static_cast<GLint>(3 * (body.triangles.offset / sizeof(ProxyLodTriangle))));
    batch.count.push_back(static_cast<GLsizei>(3 * (body.triangles.byte_count / sizeof(ProxyLodTriangle))));
  }
  return {};
}

void ProxyLods::light(const World& world, const lighting::Environment& environment,
                      std::span<const lighting::LocalLight> lights, const ProxyLodOptions& options,
                      gpu::Counters& counters) {
  std::vector<ProxyLodGroup> groups(bodies_.size());
  // Holds the light of groups on which only the environment shines, once for each order.
  std::array<std::optional<sh::LightVector>, sh::kMaxOrder + 1> windowed{};
  for (std::size_t slot = 0; slot < bodies_.size(); ++slot) {
    const Body& place = bodies_[slot];
    if (!place.triangles) continue;
    const bundle::Group& described = world.description(place.bundle).groups[place.group.value];
    const std::uint32_t order = std::min(orderOf(described), options.order);
    if (!windowed[order]) {
      const sh::LightVector all = environment.light().truncated(static_cast<int>(order));
      windows_[order].follow(all, options.window);
      windowed[order] = sh::applyWeights(all, windows_[order].weights()).truncated(kProxyLightBands);
    }
    sh::LightVector light = *windowed[order];
    ProxyLodGroup& record = groups[slot];
    record.world_from_group = world.worldFromGroup(place.bundle, place.group);
    const scene::Box bounds{described.bounds_min, described.bounds_max};
    if (!bounds.empty()) {
      const glm::vec3 center_ws(record.world_from_group * glm::vec4(bounds.center(), 1.0f));
      for (const lighting::LocalLight& local : lights)
        if (!standsWithin(bounds, record.world_from_group, local))
          light += lighting::lightAt(local, center_ws, kProxyLightBands);
    }
    if (options.diffuse)
      for (std::size_t i = 0; i < std::size(record.light); ++i) record.light[i] = glm::vec4(light.c[i], 0.0f);
  }
  groups_table_.update(groups, counters);
}

Result<void> ProxyLods::prepare(const World& world, const lighting::Environment& environment,
                                std::span<const lighting::LocalLight> lights, const ProxyLodOptions& options,
                                gpu::Counters& counters) {
  const bool others = proxy_lods_changed_.renew(world.proxyLodsVersion());
  // Emissive triangles follow their lamps, even if these are moved away from their place.
  const bool follow_anew =
      scene_changed_.renew(world.lampsVersion(), world.registry().version<scene::LocalLightComponent>(),
                           world.transformsVersion()) ||
      others;
  if (!light_changed_.renew(environment.version(), options) && !follow_anew) return {};
  if (!others && batches_.empty()) return {};
  if (follow_anew)
    if (Result<void> done = follow(world, counters); !done) return done;
  if (batches_.empty()) return {};
  light(world, environment, lights, options, counters);
  return {};
}

Result<void> ProxyLods::draw(const spec::View& view, gpu::Counters& counters) {
  if (batches_.empty()) return {};
  view_.assignOne(ViewBlock{view.view_from_world, view.clip_from_view, {}});
  if (Result<void> done =
          programs_.use({{GL_VERTEX_SHADER, "proxy_lod.glsl"}, {GL_FRAGMENT_SHADER, "proxy_lod.glsl"}});
      !done)
    return done;
  view_.bindUniform(kBindView);
  groups_table_.bindStorage(kBindProxyLodGroups);
  if (!no_vertices_) no_vertices_ = gpu::VertexArray("proxy levels of detail");
  glBindVertexArray(no_vertices_.id());
  glDisable(GL_BLEND);
  glDepthMask(GL_TRUE);
  glEnable(GL_CULL_FACE);
  glFrontFace(GL_CCW);
  for (const auto& [page, batch] : batches_) {
    triangles_.page(page).bindStorage(kBindProxyLodTriangles);
    const auto draws = static_cast<GLsizei>(batch.first.size());
    glMultiDrawArrays(GL_TRIANGLES, batch.first.data(), batch.count.data(), draws);
    counters.draws += static_cast<std::uint32_t>(draws);
    ++counters.draw_calls;
  }
  glDisable(GL_CULL_FACE);
  return {};
}

}  // namespace lambent::frame
