// Shades the samples of all effects on the GPU, directly from the quantized transfer: E/pi, light of bands
// 0..2 for normal maps, mean radiance in volumes, or transferred light l' = M l in bands. It reads transfer
// in the residency's arena and the light at the groups' light probes, and writes the arena of samples. It has
// two stages (cluster, sample), each one indirect dispatch per arena page and kernel over the cells whose
// light or codes changed; if nothing changed, nothing is dispatched. Samples of vectors whose transfer is not
// resident are left to what reads them. Those of matrices then hold the light itself, also in mode
// Unshadowed; beside l'_i they hold the bands V_i of visibility, which do not depend on light. Grid points of
// neighborhoods are matrices too, but hold the change of the light. Render thread only.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "runtime/base/change_gate.hpp"
#include "runtime/base/result.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/streaming/residency.hpp"
#include "runtime/transfer/transfer_shared.h"

namespace lambent::evaluate {

// The tables of GLSL text that kernels of this room include files from.
extern const gpu::FindText kEvaluateShaders[2];

// Returns the order that is compiled into kernels; 0 selects a kernel that loops over any order.
constexpr std::uint32_t compiledOrder(std::uint32_t order) {
  return order >= 2 && order <= 6 ? order : 0;
}

// Runs all batches of the list, and makes what they wrote visible to what `barriers` names. For each batch
// `prepare` gets its key, and binds its program and its buffers but for the work itself.
template <class Prepare>
Result<void> run(gpu::WorkList& work, gpu::Counters& counters, const Prepare& prepare,
                 GLbitfield barriers = GL_SHADER_STORAGE_BARRIER_BIT) {
  if (work.empty()) return {};
  work.upload(counters);
  std::size_t index = 0;
  for (const auto& [key, items] : work.batches()) {
    if (Result<void> done = prepare(key); !done) return done;
    work.dispatch(index++, transfer::kBindWork, counters);
  }
  glMemoryBarrier(barriers);
  return {};
}

// Selects the block of the transfer that counts: none, light without bounces, or all light where it was
// baked. In mode Unshadowed the groups' own lights are dark, because without transfer it is unknown where
// their light goes.
enum class TransferMode { Unshadowed, Shadowed, Full };

// Selects whose samples are shaded. Others keep their last values, and are updated when they are selected
// again.
struct ShadedKinds {
  bool surfaces = true, volumes = true, neighborhoods = true;
  bool vectors = true, matrices = true;

  bool has(const streaming::ResidentCell& cell) const {
    const bool placed = cell.domain == transfer::Domain::Vertex  ? surfaces
                        : cell.domain == transfer::Domain::Voxel ? volumes
                                                                 : neighborhoods;
    return placed && (cell.matrices() ? matrices : vectors);
  }
};

// Lists the transfers of cells as the kernels read them (transfer_shared.h): the records, and the places of
// planes and lights that they refer to.
struct TransferTable {
  struct Cell {
    std::uint32_t first = 0, count = 0;  // a range of `transfers`
  };
  std::vector<Cell> cells;  // index: residency cell
  std::vector<transfer::TransferRecord> transfers;
  std::vector<std::uint32_t> places;  // of their planes and lights
  std::uint32_t product_count = 0;

  // Adds the resident transfers of the cell, leaving out those without a block for the mode.
  void add(const streaming::ResidentCell& cell, const lighting::GroupLights& lights, TransferMode mode);
};

// Returns the table of products of harmonics as the kernels read it: offsets of outputs, then terms.
std::vector<std::uint32_t> gauntWords(std::uint32_t bands_in, std::uint32_t bands_out);

class Samples {
 public:
  Samples();

  // Updates all samples of the selected kinds. Fails if a kernel does not compile on this device.
  Result<void> shade(streaming::Residency& residency, const lighting::GroupLights& lights, TransferMode mode,
                     gpu::Counters& counters, const ShadedKinds& kinds = {});

  // Rise when samples of the group are shaded that are vectors, or matrices.
  std::uint64_t vectorsVersionOf(std::size_t group) const { return versionOf(group).vectors; }
  std::uint64_t matricesVersionOf(std::size_t group) const { return versionOf(group).matrices; }
  std::uint64_t allVersionOf(std::size_t group) const {
    return versionOf(group).vectors + versionOf(group).matrices;
  }
  // Returns how many cells the last call shaded, including filled ones.
  std::uint32_t cellsShadedLast() const { return cells_shaded_; }
  const TransferTable& tables() const { return tables_; }
  const std::vector<transfer::FillRecord>& fills() const { return fills_; }  // index: residency cell

 private:
  static constexpr std::size_t kMaxTransfers = 3;  // visibility, bounced light, the group's lights
  // The work on vectors or on matrices. A cell's first transfer writes its samples, further ones add to them.
  struct Work {
    explicit Work(std::string_view label)
        : fill(label),
          project(label),
          samples{gpu::WorkList(label), gpu::WorkList(label), gpu::WorkList(label)} {}
    gpu::WorkList fill, project;
    std::array<gpu::WorkList, kMaxTransfers> samples;
  };
  struct Versions {
    std::uint64_t vectors = 0, matrices = 0;
  };

  Versions versionOf(std::size_t group) const {
    return group < versions_.size() ? versions_[group] : Versions{};
  }
  void rebuildTables(const streaming::Residency& residency, const lighting::GroupLights& lights,
                     TransferMode mode);
  void collect(const streaming::Residency& residency, const lighting::GroupLights& lights,
               const ShadedKinds& kinds);
  Result<void> runWork(Work& work, streaming::Residency& residency, gpu::Counters& counters);
  Result<void> project(gpu::WorkList& work, streaming::Residency& residency, gpu::Counters& counters);

  gpu::Programs kernels_;
  std::map<std::array<std::uint32_t, 2>, gpu::Table> gaunts_;  // keyed by bands in and out
  TransferTable tables_;
  std::vector<transfer::FillRecord> fills_;
  gpu::Table transfers_table_, places_table_, products_, fills_table_;
  std::array<Work, 2> works_;
  KeyedState<ChangeGate<std::uint64_t, std::uint64_t>> cells_changed_;  // versions: cell, light
  KeyedState<Versions> versions_;                                       // per group
  // Holds the mode, and whether key lights and lamps stand apart.
  ChangeGate<TransferMode, bool, bool> way_changed_;
  ChangeGate<std::uint64_t, std::size_t> layout_changed_;  // residency, groups
  std::uint32_t cells_shaded_ = 0;
};

}  // namespace lambent::evaluate
