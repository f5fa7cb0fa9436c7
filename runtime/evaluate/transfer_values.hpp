// Computes numbers of the coded transfer at every sample of every surface, for views of it: DC, a number per
// cell, and always the cluster. Values that are known without codes can be given. It takes the resident codes
// of all effects that keep them (diffuse, normal-mapped, glossy), and provides a buffer of SampleValue that a
// raster pass gathers by the rows of vertices. Nothing is held or dispatched until update() is called;
// update() does nothing if neither the codes nor the question changed.
// transfer_values.comp defines the numbers. Render thread only. Fails if a kernel does not compile on this
// device.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "runtime/base/change_gate.hpp"
#include "runtime/base/result.hpp"
#include "runtime/evaluate/samples.hpp"
#include "runtime/evaluate/transfer_values_shared.h"
#include "runtime/gpu/program.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/streaming/residency.hpp"

namespace lambent::evaluate {

enum class TransferValue : std::uint8_t { OfCell, Dc, Given };

struct TransferQuestion {
  TransferValue value = TransferValue::Dc;
  TransferMode mode = TransferMode::Full;  // Unshadowed: no sample has a value
  bool operator==(const TransferQuestion&) const = default;
};

// Returns the values of all samples, in the order of SampleValue.
using GiveValues = std::function<Result<std::vector<SampleValue>>()>;

class TransferValues {
 public:
  TransferValues();

  // `give` is called for TransferValue::Given only, when values are due.
  // `of_cells` holds a number per cell of the residency for TransferValue::OfCell; otherwise it may be empty.
  Result<void> update(streaming::Residency& residency, const lighting::GroupLights& lights,
                      const TransferQuestion& question, std::span<const float> of_cells,
                      const GiveValues& give, gpu::Counters& counters);

  // Returns the index of the value of the group's first sample.
  std::uint32_t firstOf(std::size_t group) const { return first_of_group_[group]; }
  const gpu::Buffer& buffer() const { return values_; }  // null handle: update() was not called
  std::uint64_t bytes() const { return values_.byteCount(); }

 private:
  void describe(const streaming::Residency& residency, const lighting::GroupLights& lights,
                std::span<const float> of_cells);
  Result<void> run(streaming::Residency& residency, gpu::WorkList& work, gpu::Counters& counters);

  gpu::Programs kernels_{kEvaluateShaders};
  gpu::Table cells_, transfers_, places_;
  gpu::WorkList work_, adding_work_;
  gpu::Buffer values_;
  std::vector<std::uint32_t> first_of_group_;
  TransferQuestion question_;
  ChangeGate<TransferQuestion, std::uint64_t, std::size_t> changed_;  // question, residency, groups
};

}  // namespace lambent::evaluate
