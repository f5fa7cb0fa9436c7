// Runs the glossy effect on the GPU: it computes transferred light l' = M l in bands at every sample of
// glossy cells directly from the quantized transfer, and the low bands V_i of the visibility itself, which do
// not depend on light. It reads transfer in the residency's arena and the light at the groups' light probes,
// and writes a vec4 (l'_i in RGB, V_i) per output into the samples arena. It has two stages (cluster,
// sample), each one indirect dispatch per arena page and kernel over the cells whose light or codes changed;
// the BRDF is applied to l' per pixel (glossy_kernel.glsl). What is not resident, and in mode Unshadowed
// everything, holds the light itself. Grid points of neighborhoods are such samples too; they hold the change
// of the light, which is 0 in mode Unshadowed. Without glossy cells nothing is compiled, held or dispatched.
// Render thread only.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "runtime/base/change_gate.hpp"
#include "runtime/base/result.hpp"
#include "runtime/effects/glossy/glossy_shared.h"
#include "runtime/evaluate/transfer_table.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/streaming/residency.hpp"

namespace lambent::effects::glossy {

using evaluate::ShadedKinds;
using evaluate::TransferMode;
using evaluate::TransferTable;

// Returns the table of products as the kernels read it: offsets of outputs, then terms.
std::vector<std::uint32_t> gauntWords(std::uint32_t bands_in, std::uint32_t bands_out);

class Glossy {
 public:
  Glossy();

  // Updates every sample of glossy cells of the selected kinds. Fails if a kernel does not compile on this
  // device.
  Result<void> shade(streaming::Residency& residency, const lighting::GroupLights& lights,
                     evaluate::TransferMode mode, gpu::Counters& counters,
                     const evaluate::ShadedKinds& kinds = {});

  // Returns whether the residency had glossy cells at the last shade().
  bool any() const { return any_; }
  // Rises when samples of the group are shaded.
  std::uint64_t versionOf(std::size_t group) const {
    return group < group_shaded_.size() ? group_shaded_[group] : 0;
  }
  // Returns how many cells the last call shaded, including filled ones.
  std::uint32_t cellsShadedLast() const { return cells_shaded_; }
  const evaluate::TransferTable& tables() const { return tables_; }
  const std::vector<FillRecord>& fills() const { return fills_; }  // index: residency cell

 private:
  // Visibility and dense transfers are projected; then the transfers of a cell are added one after the other.
  enum Kernel { Visibility, Dense, Samples, Fill, kKernelCount };
  static constexpr std::size_t kMaxTransfers = 3;  // visibility, bounced light, the group's lights

  void rebuildTables(const streaming::Residency& residency, const lighting::GroupLights& lights,
                     evaluate::TransferMode mode);
  void collect(const streaming::Residency& residency, const lighting::GroupLights& lights,
               const evaluate::ShadedKinds& kinds);
  Result<const gpu::Program*> program(Kernel kernel, std::uint32_t variant);
  Result<void> fill(streaming::Residency& residency, gpu::Counters& counters);
  Result<void> project(streaming::Residency& residency, gpu::Counters& counters);
  Result<void> shadeSamples(streaming::Residency& residency, gpu::WorkList& work, gpu::Counters& counters);

  std::array<std::map<std::uint32_t, gpu::Program>, kKernelCount> programs_;
  std::map<std::array<std::uint32_t, 2>, gpu::Table> gaunts_;  // keyed by bands in and out
  evaluate::TransferTable tables_;
  std::vector<FillRecord> fills_;
  gpu::Table transfers_table_, places_table_, products_, fills_table_;
  gpu::WorkList visibility_work_, dense_work_, fill_work_;
  std::array<gpu::WorkList, kMaxTransfers> samples_work_;
  KeyedState<ChangeGate<std::uint64_t, std::uint64_t>> cells_changed_;  // its version, its light
  KeyedState<std::uint64_t> group_shaded_;
  // Holds the mode, and whether key lights and lamps stand apart.
  ChangeGate<evaluate::TransferMode, bool, bool> way_changed_;
  ChangeGate<std::uint64_t, std::size_t> layout_changed_;  // residency, groups
  std::uint32_t cells_shaded_ = 0;
  bool any_ = false;
};

}  // namespace lambent::effects::glossy
