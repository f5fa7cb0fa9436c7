#include "runtime/effects/diffuse/proxies.hpp"

#include <algorithm>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "runtime/effects/diffuse/diffuse.hpp"

namespace lambent::effects::diffuse {

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
    : groups_table_("proxy groups"),
      triangles_table_("proxy triangles"),
      entries_table_("proxy entries"),
      added_table_("proxy radiance from local lights"),
      radiance_("proxy radiance"),
      work_("proxy work") {}

void Proxies::makeRecords(const streaming::ResidentGroup& group, Proxy& kept) {
  kept.made = true;
  const bundle::CaptureProxy& proxy = *group.proxy;
  kept.triangles.reserve(proxy.triangles.size());
  for (const bundle::ProxyTriangle& triangle : proxy.triangles) {
    const glm::vec3 normal = normalOf(proxy, triangle);
    kept.triangles.push_back(
        {.normal = {normal.x, normal.y, normal.z},
         .first_entry = triangle.first_entry,
         .emission = {triangle.emission.r, triangle.emission.g, triangle.emission.b},
         .entry_count = triangle.entry_count,
         .lamp = triangle.light < 0 ? kNoLamp : static_cast<std::uint32_t>(triangle.light),
         .pad = {}});
  }
  kept.entries.reserve(proxy.entries.size());
  for (const bundle::ProxyEntry& entry : proxy.entries) {
    const streaming::SampleStretch stretch = group.stretchOf(group.formOf(entry.sample));
    kept.entries.push_back({.reflectance = {entry.reflectance.r, entry.reflectance.g, entry.reflectance.b},
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
    Proxy& kept = kept_[g];
    kept.written = false;
    if (group.proxy && !kept.made) makeRecords(group, kept);
    const auto first = static_cast<std::uint32_t>(triangles_.size());
    const auto first_entry = static_cast<std::uint32_t>(entries_.size());
    triangles_.insert(triangles_.end(), kept.triangles.begin(), kept.triangles.end());
    for (std::size_t t = first; t < triangles_.size(); ++t) triangles_[t].first_entry += first_entry;
    entries_.insert(entries_.end(), kept.entries.begin(), kept.entries.end());
    groups_.push_back({.first_triangle = first,
                       .triangle_count = static_cast<std::uint32_t>(kept.triangles.size()),
                       .light = lights.firstOf(g),
                       .lamps = lights.lampsOf(g),
                       .order = group.order,
                       .lamp_count = group.light_columns,
                       .pad = {}});
  }
  groups_table_.assign(std::span<const ProxyGroupRecord>(groups_));
  triangles_table_.assign(std::span<const ProxyTriangleRecord>(triangles_));
  entries_table_.assign(std::span<const ProxyEntryRecord>(entries_));
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
  added_table_.assign(std::span<const glm::vec4>(values));
  counters.uploaded_bytes += values.size() * sizeof(glm::vec4);
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
  if (!program_) {
    Result<gpu::Program> made = gpu::Program::create(
        "diffuse proxies", {{GL_COMPUTE_SHADER, "diffuse_proxies.comp"}}, kDiffuseShaders, {});
    if (!made) return failAgain(made.error());
    program_ = std::move(*made);
  }
  work_.upload(counters);
  writeAdded(added, counters);
  program_->use();
  lights.bindStorage(transfer::kBindLights);
  groups_table_.bindStorage(kBindProxyGroups);
  triangles_table_.bindStorage(kBindProxyTriangles);
  entries_table_.bindStorage(kBindProxyEntries);
  added_table_.bindStorage(kBindProxyAdded);
  radiance_.bindStorage(kBindProxyRadiance);
  std::size_t index = 0;
  for (const auto& [key, items] : work_.batches()) {
    residency.samples().page(key[0]).bindStorage(transfer::kBindSamples);
    work_.dispatch(index++, transfer::kBindWork, counters);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  return {};
}

}  // namespace lambent::effects::diffuse
