// Numbers of the coded transfer at every sample of every surface, for views of it: DC, the energy of a band,
// what is known of a whole cell, and always the cluster. Comes in: the codes as they are resident, of all
// effects that keep them (diffuse, normal-mapped, glossy). Goes out: a buffer of SampleValue that a raster
// pass gathers by the rows of vertices. Nothing is held or dispatched until update() is called, update() does
// nothing while neither the codes nor the question changed, and release() gives all of it back. What is
// measured: transfer_measures.hpp. Render thread only. Errors: a kernel that does not compile on this device.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/effects/diffuse/transfer_table.hpp"
#include "runtime/effects/diffuse/transfer_values_shared.h"
#include "runtime/gpu/program.hpp"
#include "runtime/gpu/work_list.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/streaming/residency.hpp"

namespace lambent::effects::diffuse {

enum class TransferValue : std::uint8_t { OfCell, Dc, BandEnergy };

struct TransferQuestion {
  TransferValue value = TransferValue::Dc;
  std::uint32_t band = 0;                  // of BandEnergy
  TransferMode mode = TransferMode::Full;  // unshadowed: no transfer counts, no sample has a value
  bool operator==(const TransferQuestion&) const = default;
};

class TransferValues {
 public:
  TransferValues();

  // of_cells: per cell of the residency, for TransferValue::OfCell; else it may be empty.
  Result<void> update(streaming::Residency& residency, const lighting::GroupLights& lights,
                      const TransferQuestion& question, std::span<const float> of_cells,
                      gpu::Counters& counters);
  void release();

  // Of sample 0 of those of the group with so many outputs: what row entries of draws count from.
  std::uint32_t firstOf(const streaming::Residency& residency, const streaming::ResidentDraw& draw) const;
  std::uint32_t firstOf(std::size_t group) const { return first_of_group_[group]; }
  const gpu::Buffer& buffer() const { return values_; }  // empty handle: nothing was asked
  std::uint64_t bytes() const { return values_.byteCount(); }

 private:
  void describe(const streaming::Residency& residency, const lighting::GroupLights& lights,
                std::span<const float> of_cells);
  Result<const gpu::Program*> program(TransferValue value, std::uint32_t visibility);
  void bindProducts(std::uint32_t order);
  Result<void> run(streaming::Residency& residency, gpu::WorkList& work, gpu::Counters& counters);

  std::map<std::array<std::uint32_t, 2>, gpu::Program> programs_;  // by value and bands of visibility
  std::map<std::uint32_t, gpu::Buffer> products_;                  // by bands
  gpu::Table cells_, transfers_, places_;
  gpu::WorkList work_, adding_work_;
  gpu::Buffer values_;
  std::vector<std::uint32_t> first_of_group_;
  TransferQuestion question_;
  std::uint64_t residency_seen_ = 0;
  std::size_t groups_seen_ = 0;
};

}  // namespace lambent::effects::diffuse
