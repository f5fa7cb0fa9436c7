// The diffuse effect on the GPU: radiance E/pi at every vertex, straight from the quantized transfer. Reads:
// transfer, rows and normals in the residency's arenas, the groups' lights. Writes: the samples and radiance
// arenas. Three stages (cell, sample, vertex), each one indirect dispatch per arena page over what is dirty:
// a cell when its group's light or its own codes changed, a vertex when any cell of its group or its own mesh
// or rows did. Nothing changed: nothing is dispatched. What is not resident shades unshadowed.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/effects/diffuse/diffuse_shared.h"
#include "runtime/gpu/program.hpp"
#include "runtime/gpu/work_list.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/streaming/residency.hpp"

namespace lambent::effects::diffuse {

// Which parts of the transfer count: none, direct light only, all.
enum class TransferMode { Unshadowed, Shadowed, Full };

// The tables that the kernels read, as last uploaded.
struct Tables {
  std::vector<CellRecord> cells;  // index: residency cell
  std::vector<VectorRecord> vectors;
  std::vector<DrawRecord> draws;  // index: residency draw
  std::uint32_t product_count = 0;
};

class Diffuse {
 public:
  Diffuse();

  // Brings every resident draw up to date. Errors: a kernel that does not compile on this device.
  Result<void> shade(streaming::Residency& residency, const lighting::GroupLights& lights, TransferMode mode,
                     gpu::Counters& counters);

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
  void collectCells(const streaming::Residency& residency, const lighting::GroupLights& lights);
  void collectDraws(const streaming::Residency& residency, const lighting::GroupLights& lights);
  Result<const gpu::Program*> program(Stage stage, std::uint32_t order);
  Result<void> runCells(streaming::Residency& residency, const lighting::GroupLights& lights,
                        gpu::Counters& counters);
  Result<void> runDraws(streaming::Residency& residency, const lighting::GroupLights& lights,
                        gpu::Counters& counters);

  std::array<std::map<std::uint32_t, gpu::Program>, kStageCount> programs_;  // by order; 0: any
  Tables tables_;
  gpu::Table cells_table_, vectors_table_, draws_table_, products_;
  gpu::WorkList project_work_, samples_work_, vertices_work_;
  std::vector<Seen> cells_seen_, draws_seen_;
  std::vector<std::uint64_t> group_shaded_;  // rises when a cell of the group was shaded
  std::uint64_t residency_seen_ = 0;
  std::size_t groups_seen_ = 0;
  TransferMode mode_seen_ = TransferMode::Full;
};

}  // namespace lambent::effects::diffuse
