// Runs the diffuse effect on the GPU: it computes radiance E/pi at every vertex (for normal maps, light in
// bands 0..2) from the samples that evaluate::Samples has shaded. It reads samples, rows and normals in the
// residency's arenas and the light at the groups' light probes, and writes the arena of radiance. It takes
// one indirect dispatch per arena page and kernel over the draws that are dirty (and one dispatch per texture
// of texels, which takes the place of interpolated vertices and gets its mip levels anew): those whose
// group's light, samples, mesh or rows changed. If nothing changed, nothing is dispatched. What is not
// resident is shaded unshadowed. Render thread only.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/base/change_gate.hpp"
#include "runtime/base/result.hpp"
#include "runtime/effects/diffuse/diffuse_shared.h"
#include "runtime/evaluate/samples.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/streaming/residency.hpp"

namespace lambent::effects::diffuse {

class Diffuse {
 public:
  Diffuse();

  // Updates every resident draw, or none if they are not shown. Fails if a kernel does not compile on this
  // device.
  Result<void> shade(streaming::Residency& residency, const lighting::GroupLights& lights,
                     evaluate::TransferMode mode, const evaluate::Samples& samples, gpu::Counters& counters,
                     bool shown = true);

  // Returns how many draws the last call shaded.
  std::uint32_t drawsShadedLast() const { return draws_shaded_; }
  // Returns whether the draw's radiance has been written.
  bool shaded(std::size_t draw) const { return draw < draws_changed_.size() && draws_changed_[draw].known(); }
  const std::vector<DrawRecord>& draws() const { return draws_; }  // index: residency draw

 private:
  void collect(const streaming::Residency& residency, const lighting::GroupLights& lights,
               const evaluate::Samples& samples);
  Result<void> runTexels(streaming::Residency& residency, gpu::Counters& counters);

  gpu::Programs kernels_;
  std::vector<DrawRecord> draws_;
  gpu::Table draws_table_;
  gpu::WorkList work_;
  std::vector<std::uint32_t> texel_draws_;  // draws whose textures are shaded in this frame
  KeyedState<ChangeGate<std::uint64_t, std::uint64_t, std::uint64_t>> draws_changed_;  // draw, light, samples
  // Holds the mode, and whether key lights and lamps stand apart.
  ChangeGate<evaluate::TransferMode, bool, bool> way_changed_;
  ChangeGate<std::uint64_t, std::size_t> layout_changed_;  // residency, groups
  std::uint32_t draws_shaded_ = 0;
};

// Adds radiance to what a group's triangles send out: light that reaches them per pixel and not by transfer.
struct AddedRadiance {
  std::span<const glm::vec3> triangles;  // one per triangle; empty: none
  std::uint64_t version = 0;             // changes when the radiance does
};

// Computes what the capture proxies of all groups send out: a radiance per triangle, from the shaded samples
// of its group (for glossy samples, their first nine outputs) and the current strength of the group's lights.
// It reads the samples arena and the groups' lights, and writes a table of vec4 with all triangles of all
// proxies, in the order of the residency's groups. It runs for groups that were shaded again, with one
// indirect dispatch per page of samples. Render thread only. Fails if a kernel does not compile on this
// device.
class Proxies {
 public:
  Proxies();

  // `shaded` holds per group a number that rises when any effect shades its samples. `added` is indexed by
  // group, or empty.
  Result<void> shade(streaming::Residency& residency, const lighting::GroupLights& lights,
                     std::span<const std::uint64_t> shaded, gpu::Counters& counters,
                     std::span<const AddedRadiance> added = {});

  const gpu::Buffer& radiance() const { return radiance_.buffer(); }
  // Changes when what the group sends out was computed anew; no two groups ever return the same number.
  std::uint64_t versionOf(std::size_t group) const { return kept_[group].version; }

  // Return what was uploaded, for tests that run the kernel on the CPU.
  const std::vector<ProxyGroupRecord>& groups() const { return groups_; }
  const std::vector<ProxyTriangleRecord>& triangles() const { return triangles_; }
  const std::vector<ProxyEntryRecord>& entries() const { return entries_; }

 private:
  struct Proxy {
    ChangeGate<std::uint64_t, std::uint64_t, std::uint64_t> changed;  // samples, light, added radiance
    std::uint64_t version = 0;
    bool written = false;  // whether the table holds it where it stands now
  };
  void addRecords(const streaming::ResidentGroup& group);
  void rebuildTables(const streaming::Residency& residency, const lighting::GroupLights& lights);
  void writeAdded(std::span<const AddedRadiance> added, gpu::Counters& counters);

  gpu::Programs kernels_;
  std::vector<ProxyGroupRecord> groups_;  // indexed by group of the residency
  std::vector<ProxyTriangleRecord> triangles_;
  std::vector<ProxyEntryRecord> entries_;
  KeyedState<Proxy> kept_;
  ChangeGate<std::uint64_t, std::size_t> layout_changed_;  // proxies, lights
  std::uint64_t version_ = 0;
  bool added_ = false;  // whether the table of added radiance may hold anything but 0
  gpu::Table groups_table_, triangles_table_, entries_table_, added_table_, radiance_;
  gpu::WorkList work_;
};

}  // namespace lambent::effects::diffuse
