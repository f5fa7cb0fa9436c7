// Computes what the vertices of smooth dielectrics see of the sky, so that their mirrors can show it and what
// hides it (runtime/surface/layer.glsl): the first bands of transfer without bounces, at the vertices'
// normals. They depend on the transfer alone, so they are computed when it has arrived, and not when light
// changes: at first when enough is there to shade a cell, and again when all is. The words lie behind the
// radiance of each draw (ResidentDraw::seenWord). Render thread only. Fails if a kernel does not compile on
// this device.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "runtime/base/change_gate.hpp"
#include "runtime/base/result.hpp"
#include "runtime/evaluate/seen_sky_kernels.h"
#include "runtime/evaluate/transfer_table.hpp"
#include "runtime/gpu/program.hpp"

namespace lambent::evaluate {

class SeenSky {
 public:
  SeenSky();

  Result<void> update(streaming::Residency& residency, const lighting::GroupLights& lights,
                      gpu::Counters& counters);
  // Returns whether the words of the draw have been written.
  bool known(std::size_t draw) const { return draw < draws_changed_.size() && draws_changed_[draw].known(); }
  // Binds the weights by which the bands tell how much of the sky a mirror sees, once update() was called.
  void bindKernel(GLuint unit) const;
  // Rises when known() changes for any draw.
  std::uint64_t version() const { return version_; }

 private:
  struct Tables;
  // Lists what has to be written anew; returns whether there is anything.
  bool collect(const streaming::Residency& residency);
  Tables describe(const streaming::Residency& residency, const lighting::GroupLights& lights);
  Result<void> run(streaming::Residency& residency, gpu::Counters& counters);
  Result<const gpu::Program*> program(const char* file, std::uint32_t outputs);

  std::map<std::pair<std::string, std::uint32_t>, gpu::Program> programs_;  // keyed by file and outputs
  gpu::Texture kernel_;                                                     // see lighting/seen_kernel.hpp
  gpu::Table cells_, transfers_, places_, draws_;
  gpu::WorkList samples_work_, vertices_work_;
  std::vector<std::uint32_t> due_;               // draws to write
  ChangeGate<std::uint64_t> residency_changed_;  // version
  // Versions of the draw, and how much of its group's transfer has arrived.
  KeyedState<ChangeGate<std::uint64_t, std::uint64_t>> draws_changed_;
  std::uint64_t version_ = 0;
};

}  // namespace lambent::evaluate
