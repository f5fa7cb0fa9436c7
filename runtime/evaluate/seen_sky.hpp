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

#include <glm/vec4.hpp>

#include "runtime/base/change_gate.hpp"
#include "runtime/base/result.hpp"
#include "runtime/evaluate/samples.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/transfer/seen_sky_shared.h"

namespace lambent::evaluate {

// Computes how much of the sky a rough mirror sees, from the first bands t_k = (1/pi) ∫ V max(n·s, 0) y_k ds
// of transfer without bounces. For a mirrored direction r at an angle to the normal, weights b make
//   Σ_k b_k t_k = ∫ V(s) K(s) ds,   K(s) = Σ_k b_k y_k(s) max(n·s, 0)/pi,
// with K as near to the lobe about r as it gets (least squares over the hemisphere), and 1 where all is open.
// Bands of V alone would be better, but bundles do not have them; reading them off at r would mix in what
// stands higher, which the cosine favours. K is symmetric about the plane of the normal and r, so it is
// stored by weights of zonal functions (sh/zonal.hpp) over cosine and roughness. No GL.

inline constexpr std::uint32_t kSeenCosines = 24, kSeenRoughnesses = 9;
inline constexpr std::uint32_t kSeenLayers = (transfer::kSeenWeights + 3) / 4;

struct SeenKernel {
  // Four weights to a vec4: [layer][roughness][cosine], with roughness 0..1 and bundle::angleAxis(cosine) in
  // even steps. The last of sixteen is unused.
  std::vector<glm::vec4> texels;
};

SeenKernel makeSeenKernel();

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

  gpu::Programs kernels_{kEvaluateShaders};
  gpu::Texture kernel_;  // see SeenKernel
  gpu::Table cells_, transfers_, places_, draws_;
  gpu::WorkList samples_work_, vertices_work_;
  std::vector<std::uint32_t> due_;               // draws to write
  ChangeGate<std::uint64_t> residency_changed_;  // version
  // Versions of the draw, and how much of its group's transfer has arrived.
  KeyedState<ChangeGate<std::uint64_t, std::uint64_t>> draws_changed_;
  std::uint64_t version_ = 0;
};

}  // namespace lambent::evaluate
