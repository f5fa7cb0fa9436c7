// The diffuse effect on the GPU: radiance E/pi at every vertex (for normal maps: light of bands 0..2),
// straight from the quantized transfer. Reads: transfer, rows and normals in the residency's arenas, the
// light at the groups' light probes. Writes: the samples and radiance arenas. Three stages (cluster, sample,
// vertex), each one indirect dispatch per arena page and kernel over what is dirty: a cell when its group's
// light or its own codes changed, a vertex when any cell of its group or its own mesh or rows did. Nothing
// changed: nothing is dispatched. What is not resident shades unshadowed.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "runtime/base/keyed_state.hpp"
#include "runtime/base/result.hpp"
#include "runtime/effects/diffuse/diffuse_shared.h"
#include "runtime/effects/diffuse/transfer_table.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/gpu/work_list.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/streaming/residency.hpp"

namespace lambent::effects::diffuse {

// The tables that the kernels read, as last uploaded.
struct Tables : TransferTable {
  std::vector<DrawRecord> draws;  // index: residency draw
};

class Diffuse {
 public:
  Diffuse();

  // Brings every resident draw up to date. Errors: a kernel that does not compile on this device.
  Result<void> shade(streaming::Residency& residency, const lighting::GroupLights& lights, TransferMode mode,
                     gpu::Counters& counters, const ShadedKinds& kinds = {});

  // Rises when samples of the group were shaded.
  std::uint64_t versionOf(std::size_t group) const {
    return group < group_shaded_.size() ? group_shaded_[group] : 0;
  }
  // What the last call shaded.
  struct Shaded {
    std::uint32_t cells = 0, draws = 0;
  };
  const Shaded& shadedLast() const { return shaded_; }
  // Whether the draw's radiance has been written.
  bool shaded(std::size_t draw) const { return draw < draws_seen_.size() && draws_seen_[draw].version != 0; }
  const Tables& tables() const { return tables_; }

 private:
  enum Stage { Project, Samples, Vertices, kStageCount };
  struct Seen {
    std::uint64_t version = 0, light = 0, cells = 0;
  };

  void rebuildTables(const streaming::Residency& residency, const lighting::GroupLights& lights,
                     TransferMode mode);
  void collectCells(const streaming::Residency& residency, const lighting::GroupLights& lights,
                    const ShadedKinds& kinds);
  void collectDraws(const streaming::Residency& residency, const lighting::GroupLights& lights);
  Result<const gpu::Program*> program(Stage stage, std::uint32_t kind, std::uint32_t outputs);
  Result<void> runSamples(streaming::Residency& residency, const gpu::WorkList& work,
                          gpu::Counters& counters);
  Result<void> runCells(streaming::Residency& residency, const lighting::GroupLights& lights,
                        gpu::Counters& counters);
  Result<void> runDraws(streaming::Residency& residency, const lighting::GroupLights& lights,
                        gpu::Counters& counters);

  // By order (0: any) or, for samples, 1 for several lights; and outputs.
  std::array<std::map<std::array<std::uint32_t, 2>, gpu::Program>, kStageCount> programs_;
  Tables tables_;
  gpu::Table transfers_table_, places_table_, draws_table_, products_;
  // A cell's first transfer writes its samples, the second adds to them.
  gpu::WorkList project_work_, samples_work_, adding_work_, vertices_work_;
  KeyedState<Seen> cells_seen_, draws_seen_;
  KeyedState<std::uint64_t> group_shaded_;  // rises when a cell of the group was shaded
  std::uint64_t residency_seen_ = 0;
  std::size_t groups_seen_ = 0;
  TransferMode mode_seen_ = TransferMode::Full;
  bool keys_seen_ = false;
  Shaded shaded_;
};

}  // namespace lambent::effects::diffuse
