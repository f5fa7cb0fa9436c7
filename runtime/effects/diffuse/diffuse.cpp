#include "runtime/effects/diffuse/diffuse.hpp"

#include <algorithm>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "lambent_effects_diffuse_embedded.hpp"
#include "lambent_transfer_embedded.hpp"

namespace lambent::effects::diffuse {

constexpr gpu::FindText kDiffuseShaders[] = {&embedded::lambent_effects_diffuse::find,
                                             &embedded::lambent_transfer::find};

namespace {

DrawRecord describeDraw(const streaming::Residency& residency, const streaming::ResidentDraw& draw,
                        std::uint32_t light, evaluate::TransferMode mode) {
  const streaming::ResidentGroup& group = residency.groups()[draw.group];
  const streaming::ResidentMesh& mesh = residency.meshes()[draw.mesh];
  DrawRecord record{};
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row)
      record.group_from_mesh_normal[4 * column + row] = draw.group_from_mesh_normal[column][row];
  record.light = light;
  record.order = group.order;
  record.vertex_count = mesh.vertex_count;
  record.normals_word = mesh.normals_word;
  record.rows_word = draw.rows && mode != evaluate::TransferMode::Unshadowed ? draw.rows.word() : kNoRows;
  record.row_entries = draw.row_entries;
  const streaming::SampleStretch samples = group.stretchOf(draw.form());
  record.first_sample = samples.first_sample;
  record.first_output = samples.first_output;
  record.radiance_word = draw.radiance.word();
  record.outputs = draw.outputs;
  if (draw.texel_rows && draw.irradiance) {
    record.texels = draw.texels;
    record.texels_word = mode != evaluate::TransferMode::Unshadowed ? draw.texel_rows.word() : kNoRows;
  }
  return record;
}

}  // namespace

Diffuse::Diffuse()
    : kernels_(kDiffuseShaders), draws_table_("diffuse draws"), work_("diffuse vertices work") {}

Result<void> Diffuse::shade(streaming::Residency& residency, const lighting::GroupLights& lights,
                            evaluate::TransferMode mode, const evaluate::Samples& samples,
                            gpu::Counters& counters, bool shown) {
  const bool other_way = way_changed_.renew(mode, lights.hasKeys(), lights.hasPartedLamps());
  if (other_way) draws_changed_.clear();  // shades everything anew
  if (layout_changed_.renew(residency.version(), lights.groupCount()) || other_way) {
    draws_.clear();
    for (const streaming::ResidentDraw& draw : residency.draws())
      draws_.push_back(describeDraw(residency, draw, lights.firstOf(draw.group), mode));
    draws_table_.assign(draws_);
    draws_changed_.follow(residency.draws(), &streaming::ResidentDraw::id);
  }
  draws_shaded_ = 0;
  work_.clear();
  texel_draws_.clear();
  if (shown) collect(residency, lights, samples);
  if (work_.empty()) return {};
  lights.bindStorage(transfer::kBindLights);
  draws_table_.bindStorage(kBindDraws);
  Result<void> done = evaluate::run(work_, counters, [&](const gpu::BatchKey& key) {
    // A page may not exist if no draw of the batch has anything in it; any buffer can take its place.
    const auto bind = [&](gpu::Arena& arena, std::uint32_t page, std::uint32_t binding) {
      if (page < arena.pageCount() && arena.page(page))
        arena.page(page).bindStorage(binding);
      else
        draws_table_.bindStorage(binding);
    };
    bind(residency.rows(), key[2], kBindRows);
    bind(residency.geometry(), key[3], kBindGeometry);
    bind(residency.samples(), key[4], transfer::kBindSamples);
    bind(residency.radiance(), key[5], kBindRadiance);
    std::vector<gpu::Define> defines = {{"LAMBENT_OUTPUTS", std::to_string(key[1])}};
    if (key[0] != 0) defines.push_back({"LAMBENT_ORDER", std::to_string(key[0])});
    return kernels_.use("diffuse_vertices.comp", std::move(defines));
  });
  if (!done || texel_draws_.empty()) return done;
  return runTexels(residency, counters);
}

void Diffuse::collect(const streaming::Residency& residency, const lighting::GroupLights& lights,
                      const evaluate::Samples& samples) {
  for (std::uint32_t i = 0; i < draws_.size(); ++i) {
    const streaming::ResidentDraw& draw = residency.draws()[i];
    if (!draw.radiance) continue;
    if (!draws_changed_[i].renew(draw.version, lights.versionOf(draw.group),
                                 samples.vectorsVersionOf(draw.group)))
      continue;
    ++draws_shaded_;
    if (draws_[i].texels > 0) texel_draws_.push_back(i);
    const streaming::ResidentGroup& group = residency.groups()[draw.group];
    const streaming::ResidentMesh& mesh = residency.meshes()[draw.mesh];
    work_.add({evaluate::compiledOrder(group.order), draw.outputs, draw.rows.page, mesh.block.page,
               group.samples.page, draw.radiance.page},
              i, mesh.vertex_count, transfer::kWorkGroupSize);
  }
}

// Samples that are not shaded leave their texels empty, as all do in the unshadowed mode, and the vertices
// show.
Result<void> Diffuse::runTexels(streaming::Residency& residency, gpu::Counters& counters) {
  if (Result<void> done = kernels_.use("diffuse_texels.comp"); !done) return done;
  for (const std::uint32_t i : texel_draws_) {
    const streaming::ResidentDraw& draw = residency.draws()[i];
    residency.rows().page(draw.texel_rows.page).bindStorage(kBindRows);
    residency.samples().page(residency.groups()[draw.group].samples.page).bindStorage(transfer::kBindSamples);
    glBindImageTexture(0, draw.irradiance.id(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA16F);
    glUniform1ui(0, i);
    const GLuint groups = (draw.texels + kTexelGroupSize - 1) / kTexelGroupSize;
    glDispatchCompute(groups, groups, 1);
    ++counters.dispatches;
  }
  glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT |
                  GL_TEXTURE_UPDATE_BARRIER_BIT);
  for (const std::uint32_t i : texel_draws_) glGenerateTextureMipmap(residency.draws()[i].irradiance.id());
  return {};
}

namespace {

// A triangle without area may have any normal, since nobody sees it.
glm::vec3 normalOf(const bundle::CaptureProxy& proxy, const bundle::ProxyTriangle& triangle) {
  const glm::vec3 a = proxy.positions[triangle.vertices[0]], b = proxy.positions[triangle.vertices[1]],
                  c = proxy.positions[triangle.vertices[2]];
  const glm::vec3 across = glm::cross(b - a, c - a);
  const float length = glm::length(across);
  return length > 0.0f ? across / length : glm::vec3(0.0f, 1.0f, 0.0f);
}

}  // namespace

Proxies::Proxies()
    : kernels_(kDiffuseShaders),
      groups_table_("proxy groups"),
      triangles_table_("proxy triangles"),
      entries_table_("proxy entries"),
      added_table_("proxy radiance from local lights"),
      radiance_("proxy radiance"),
      work_("proxy work") {}

void Proxies::addRecords(const streaming::ResidentGroup& group) {
  const bundle::CaptureProxy& proxy = *group.proxy;
  const auto first_entry = static_cast<std::uint32_t>(entries_.size());
  for (const bundle::ProxyTriangle& triangle : proxy.triangles) {
    const glm::vec3 normal = normalOf(proxy, triangle);
    triangles_.push_back({.normal = {normal.x, normal.y, normal.z},
                          .first_entry = first_entry + triangle.first_entry,
                          .emission = {triangle.emission.r, triangle.emission.g, triangle.emission.b},
                          .entry_count = triangle.entry_count,
                          .lamp = triangle.light < 0 ? kNoLamp : static_cast<std::uint32_t>(triangle.light),
                          .pad = {}});
  }
  for (const bundle::ProxyEntry& entry : proxy.entries) {
    const streaming::SampleStretch stretch = group.stretchOf(group.formOf(entry.sample));
    entries_.push_back({.reflectance = {entry.reflectance.r, entry.reflectance.g, entry.reflectance.b},
                        .sample_index = stretch.outputOf(entry.sample),
                        .outputs = stretch.outputs,
                        .pad = {}});
  }
}

void Proxies::rebuildTables(const streaming::Residency& residency, const lighting::GroupLights& lights) {
  groups_.clear();
  triangles_.clear();
  entries_.clear();
  kept_.follow(residency.groups(), &streaming::ResidentGroup::id);
  for (std::size_t g = 0; g < residency.groups().size(); ++g) {
    const streaming::ResidentGroup& group = residency.groups()[g];
    kept_[g].written = false;
    const auto first = static_cast<std::uint32_t>(triangles_.size());
    if (group.proxy) addRecords(group);
    groups_.push_back({.first_triangle = first,
                       .triangle_count = static_cast<std::uint32_t>(triangles_.size()) - first,
                       .light = lights.firstOf(g),
                       .lamps = lights.lampsOf(g),
                       .order = group.order,
                       .lamp_count = group.light_columns,
                       .pad = {}});
  }
  groups_table_.assign(groups_);
  triangles_table_.assign(triangles_);
  entries_table_.assign(entries_);
  radiance_.reserve(triangles_.size() * sizeof(glm::vec4));
  added_ = true;  // makes the table be written again
}

void Proxies::writeAdded(std::span<const AddedRadiance> added, gpu::Counters& counters) {
  const bool any =
      std::ranges::any_of(added, [](const AddedRadiance& one) { return !one.triangles.empty(); });
  if (!any && !added_) return;  // the table is 0 already
  added_ = any;
  std::vector<glm::vec4> values(triangles_.size(), glm::vec4(0.0f));
  for (std::size_t g = 0; g < std::min(added.size(), groups_.size()); ++g)
    for (std::size_t t = 0; t < std::min<std::size_t>(added[g].triangles.size(), groups_[g].triangle_count);
         ++t)
      values[groups_[g].first_triangle + t] = glm::vec4(added[g].triangles[t], 0.0f);
  added_table_.assign(values, counters);
}

Result<void> Proxies::shade(streaming::Residency& residency, const lighting::GroupLights& lights,
                            std::span<const std::uint64_t> shaded, gpu::Counters& counters,
                            std::span<const AddedRadiance> added) {
  if (layout_changed_.renew(residency.proxiesVersion(), lights.coefficients().size()))
    rebuildTables(residency, lights);
  work_.clear();
  for (std::uint32_t g = 0; g < groups_.size(); ++g) {
    const streaming::ResidentGroup& group = residency.groups()[g];
    if (groups_[g].triangle_count == 0 || !group.samples) continue;
    Proxy& kept = kept_[g];
    const std::uint64_t brought = g < added.size() ? added[g].version : 0;
    const bool changed = kept.changed.renew(shaded[g], lights.versionOf(g), brought);
    if (changed) kept.version = ++version_;
    if (std::exchange(kept.written, true) && !changed) continue;
    work_.add({group.samples.page}, g, groups_[g].triangle_count, transfer::kWorkGroupSize);
  }
  if (work_.empty()) return {};
  writeAdded(added, counters);
  lights.bindStorage(transfer::kBindLights);
  groups_table_.bindStorage(kBindProxyGroups);
  triangles_table_.bindStorage(kBindProxyTriangles);
  entries_table_.bindStorage(kBindProxyEntries);
  added_table_.bindStorage(kBindProxyAdded);
  radiance_.bindStorage(kBindProxyRadiance);
  return evaluate::run(work_, counters, [&](const gpu::BatchKey& key) {
    residency.samples().page(key[0]).bindStorage(transfer::kBindSamples);
    return kernels_.use("diffuse_proxies.comp");
  });
}

}  // namespace lambent::effects::diffuse
