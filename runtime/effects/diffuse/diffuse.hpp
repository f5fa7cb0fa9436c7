// Runs the diffuse effect on the GPU: it computes radiance E/pi at every vertex (for normal maps, light in
// bands 0..2) directly from the quantized transfer. It reads transfer, rows and normals in the residency's
// arenas and the light at the groups' light probes, and writes the arenas of samples and radiance. It has
// three stages (cluster, sample, vertex), each one indirect dispatch per arena page and kernel over what is
// dirty (and one dispatch per texture of texels, which takes the place of interpolated vertices and gets its
// mip levels anew): a cell if its group's light or its own codes changed, a vertex if any cell of its group
// or its own mesh or rows did. If nothing changed, nothing is dispatched. What is not resident is shaded
// unshadowed. Render thread only.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "runtime/base/change_gate.hpp"
#include "runtime/base/result.hpp"
#include "runtime/effects/diffuse/diffuse_shared.h"
#include "runtime/evaluate/transfer_table.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/streaming/residency.hpp"

namespace lambent::effects::diffuse {

// The tables of GLSL text that programs of this room include files from.
extern const gpu::FindText kDiffuseShaders[2];

// Holds the tables that the kernels read, as last uploaded.
struct Tables : evaluate::TransferTable {
  std::vector<DrawRecord> draws;  // index: residency draw
};

class Diffuse {
 public:
  Diffuse();

  // Updates every resident draw. Fails if a kernel does not compile on this device.
  Result<void> shade(streaming::Residency& residency, const lighting::GroupLights& lights,
                     evaluate::TransferMode mode, gpu::Counters& counters,
                     const evaluate::ShadedKinds& kinds = {});

  // Rises when samples of the group are shaded.
  std::uint64_t versionOf(std::size_t group) const {
    return group < group_shaded_.size() ? group_shaded_[group] : 0;
  }
  // Counts what the last call shaded.
  struct Shaded {
    std::uint32_t cells = 0, draws = 0;
  };
  const Shaded& shadedLast() const { return shaded_; }
  // Returns whether the draw's radiance has been written.
  bool shaded(std::size_t draw) const { return draw < draws_changed_.size() && draws_changed_[draw].known(); }
  const Tables& tables() const { return tables_; }

 private:
  enum Stage { Project, Samples, Vertices, kStageCount };

  void rebuildTables(const streaming::Residency& residency, const lighting::GroupLights& lights,
                     evaluate::TransferMode mode);
  void collectCells(const streaming::Residency& residency, const lighting::GroupLights& lights,
                    evaluate::TransferMode mode, const evaluate::ShadedKinds& kinds);
  void collectDraws(const streaming::Residency& residency, const lighting::GroupLights& lights);
  Result<const gpu::Program*> program(Stage stage, std::uint32_t kind, std::uint32_t outputs);
  Result<void> runSamples(streaming::Residency& residency, const gpu::WorkList& work,
                          gpu::Counters& counters);
  Result<void> runCells(streaming::Residency& residency, const lighting::GroupLights& lights,
                        gpu::Counters& counters);
  Result<void> runDraws(streaming::Residency& residency, const lighting::GroupLights& lights,
                        gpu::Counters& counters);
  Result<void> runTexels(streaming::Residency& residency, gpu::Counters& counters);

  // The key holds the order (0: any order; for the Samples stage, 1 if there are several lights) and the
  // number of outputs.
  std::array<std::map<std::array<std::uint32_t, 2>, gpu::Program>, kStageCount> programs_;
  Tables tables_;
  gpu::Table transfers_table_, places_table_, draws_table_, products_;
  // A cell's first transfer writes its samples, the second one adds to them.
  gpu::WorkList project_work_, samples_work_, adding_work_, vertices_work_;
  gpu::Program texels_program_;
  std::vector<std::uint32_t> texel_draws_;  // draws whose textures are shaded in this frame
  KeyedState<ChangeGate<std::uint64_t, std::uint64_t>> cells_changed_;  // versions: cell, light
  KeyedState<ChangeGate<std::uint64_t, std::uint64_t, std::uint64_t>> draws_changed_;  // draw, light, cells
  KeyedState<std::uint64_t> group_shaded_;  // rises when a cell of the group was shaded
  // Holds the mode, and whether key lights and lamps stand apart.
  ChangeGate<evaluate::TransferMode, bool, bool> way_changed_;
  ChangeGate<std::uint64_t, std::size_t> layout_changed_;  // residency, groups
  Shaded shaded_;
};

}  // namespace lambent::effects::diffuse
