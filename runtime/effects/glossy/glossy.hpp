// The glossy effect on the GPU: transferred light l' = M l in bands at every sample of glossy cells, straight
// from the quantized transfer, and beside it the visibility's own low bands V_i, which no light changes.
// Reads: transfer in the residency's arena, the light at the groups' light probes. Writes: the samples
// arena, a vec4 (l'_i in RGB, V_i) per output. Two stages (cluster, sample), each one indirect dispatch per
// arena page and kernel over the cells whose light or codes changed; what a BRDF makes of l' is done per
// pixel (glossy_kernel.glsl). What is not resident, and all of it when unshadowed, has the light itself.
// Points of neighborhoods are such samples too: theirs is the change of the light, none where unshadowed.
// Without glossy cells nothing is compiled, held or dispatched.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "runtime/base/keyed_state.hpp"
#include "runtime/base/result.hpp"
#include "runtime/effects/diffuse/transfer_table.hpp"
#include "runtime/effects/glossy/glossy_shared.h"
#include "runtime/gpu/program.hpp"
#include "runtime/gpu/work_list.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/streaming/residency.hpp"

namespace lambent::effects::glossy {

using diffuse::ShadedKinds;
using diffuse::TransferMode;
using diffuse::TransferTable;

// As the kernels read the table of products: offsets of outputs, then terms.
std::vector<std::uint32_t> gauntWords(std::uint32_t bands_in, std::uint32_t bands_out);

class Glossy {
 public:
  Glossy();

  // Brings every sample of glossy cells up to date, of those kinds that are asked for.
  // Errors: a kernel that does not compile on this device.
  Result<void> shade(streaming::Residency& residency, const lighting::GroupLights& lights, TransferMode mode,
                     gpu::Counters& counters, const ShadedKinds& kinds = {});

  // Whether the residency had glossy cells when shade() last looked.
  bool any() const { return any_; }
  // Rises when samples of the group were shaded.
  std::uint64_t versionOf(std::size_t group) const {
    return group < group_shaded_.size() ? group_shaded_[group] : 0;
  }
  // Cells that the last call shaded, filled ones among them.
  std::uint32_t cellsShadedLast() const { return cells_shaded_; }
  const TransferTable& tables() const { return tables_; }
  const std::vector<FillRecord>& fills() const { return fills_; }  // index: residency cell

 private:
  // Visibility and dense transfers are projected, then the transfers of a cell are added up one after the
  // other.
  enum Kernel { Visibility, Dense, Samples, Fill, kKernelCount };
  static constexpr std::size_t kMaxTransfers = 3;  // visibility, bounced light, the group's lights
  struct Seen {
    std::uint64_t version = 0, light = 0;
  };

  void rebuildTables(const streaming::Residency& residency, const lighting::GroupLights& lights,
                     TransferMode mode);
  void collect(const streaming::Residency& residency, const lighting::GroupLights& lights,
               const ShadedKinds& kinds);
  Result<const gpu::Program*> program(Kernel kernel, std::uint32_t variant);
  Result<void> fill(streaming::Residency& residency, gpu::Counters& counters);
  Result<void> project(streaming::Residency& residency, gpu::Counters& counters);
  Result<void> shadeSamples(streaming::Residency& residency, gpu::WorkList& work, gpu::Counters& counters);

  std::array<std::map<std::uint32_t, gpu::Program>, kKernelCount> programs_;
  std::map<std::array<std::uint32_t, 2>, gpu::Table> gaunts_;  // by bands in and out
  TransferTable tables_;
  std::vector<FillRecord> fills_;
  gpu::Table transfers_table_, places_table_, products_, fills_table_;
  gpu::WorkList visibility_work_, dense_work_, fill_work_;
  std::array<gpu::WorkList, kMaxTransfers> samples_work_;
  KeyedState<Seen> cells_seen_;
  KeyedState<std::uint64_t> group_shaded_;
  std::uint64_t residency_seen_ = 0;
  std::size_t groups_seen_ = 0;
  TransferMode mode_seen_ = TransferMode::Full;
  bool keys_seen_ = false;
  std::uint32_t cells_shaded_ = 0;
  bool any_ = false;
};

}  // namespace lambent::effects::glossy
