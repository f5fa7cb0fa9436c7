// What the capture proxies of all groups send out: a radiance per triangle, from the shaded samples of its
// group (of glossy ones the first nine outputs) and what the group's lights give now. Reads: the samples
// arena, the groups' lights. Writes: a table of vec4, triangle after triangle through the proxies in the
// order of the residency's groups. Runs for the groups that were shaded anew: one indirect dispatch per page
// of samples. Errors: a kernel that does not compile on this device.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/base/keyed_state.hpp"
#include "runtime/base/result.hpp"
#include "runtime/effects/diffuse/diffuse_shared.h"
#include "runtime/gpu/program.hpp"
#include "runtime/gpu/work_list.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/streaming/residency.hpp"

namespace lambent::effects::diffuse {

// What a group's triangles send out besides: light that reached them per pixel, and not by transfer.
struct AddedRadiance {
  std::span<const glm::vec3> triangles;  // empty: none
  std::uint64_t version = 0;             // another number when it changed
};

class Proxies {
 public:
  Proxies();

  // shaded: per group, a number that rises when samples of it are shaded, by whatever effect. added: per
  // group, or nothing at all.
  Result<void> shade(streaming::Residency& residency, const lighting::GroupLights& lights,
                     std::span<const std::uint64_t> shaded, gpu::Counters& counters,
                     std::span<const AddedRadiance> added = {});

  const gpu::Buffer& radiance() const { return radiance_.buffer(); }
  // Another number when what the group sends out was computed anew; never that of another group.
  std::uint64_t versionOf(std::size_t group) const { return seen_[group].version; }

  // As uploaded, for the CPU twin.
  const std::vector<ProxyGroupRecord>& groups() const { return groups_; }
  const std::vector<ProxyTriangleRecord>& triangles() const { return triangles_; }
  const std::vector<ProxyEntryRecord>& entries() const { return entries_; }

 private:
  struct Seen {
    std::uint64_t samples = 0, light = 0, added = 0, version = 0;
    bool written = false;  // where the table has it now
    // The proxy's, by themselves: entries from 0 on. Made when it comes.
    bool made = false;
    std::vector<ProxyTriangleRecord> triangles;
    std::vector<ProxyEntryRecord> entries;
  };
  static void makeRecords(const streaming::ResidentGroup& group, Seen& seen);
  void rebuildTables(const streaming::Residency& residency, const lighting::GroupLights& lights);
  void writeAdded(std::span<const AddedRadiance> added, gpu::Counters& counters);

  std::optional<gpu::Program> program_;
  std::vector<ProxyGroupRecord> groups_;  // index: residency group
  std::vector<ProxyTriangleRecord> triangles_;
  std::vector<ProxyEntryRecord> entries_;
  KeyedState<Seen> seen_;
  std::uint64_t proxies_seen_ = 0, version_ = 0;
  std::size_t lights_seen_ = 0;
  bool added_ = false;  // whether the table of what is added may hold anything
  gpu::Table groups_table_, triangles_table_, entries_table_, added_table_, radiance_;
  gpu::WorkList work_;
};

}  // namespace lambent::effects::diffuse
