// Shades receivers that have transfer of their own: t_p . dl'(x_p) at every vertex of such draws, in compute,
// from the texture of the neighborhood effect and the receiver's coded transfer. It takes draws with the
// grids that reach them, and provides a second radiance, E/pi, that the raster adds to the draw's own. A draw
// is shaded again if a grid's light, the relative placement of draw and body, or the draw's transfer changed.
// Without such draws nothing is compiled, held or dispatched. Render thread only. Fails if a kernel does not
// compile on this device.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include <glm/gtc/quaternion.hpp>

#include "runtime/base/change_gate.hpp"
#include "runtime/base/result.hpp"
#include "runtime/effects/neighborhood/neighborhood.hpp"
#include "runtime/effects/neighborhood/vertex_shared.h"
#include "runtime/evaluate/samples.hpp"

namespace lambent::effects::neighborhood {

struct VertexDraw {
  struct From {
    std::uint32_t grid = 0;  // index in the effect
    mat3x4 grid_from_position{0.0f};
    glm::quat group_from_body{1.0f, 0.0f, 0.0f, 0.0f};
    bool operator==(const From&) const = default;
  };
  std::uint32_t draw = 0;  // index in the residency
  std::vector<From> from;
};

// Returns whether everything that the draw needs is resident, in one page: it must be a plain draw with rows,
// and the plain cells of its group must have their transfer of light from the environment in `order` bands.
bool hasTransfer(const streaming::Residency& residency, std::uint32_t draw, std::uint32_t order);

class VertexReceivers {
 public:
  VertexReceivers();

  // `draws` must fulfil hasTransfer() with as many bands as their grids have.
  Result<void> update(streaming::Residency& residency, const lighting::GroupLights& lights,
                      evaluate::TransferMode mode, const Neighborhood& effect,
                      std::span<const VertexDraw> draws, gpu::Counters& counters);

  // Returns where a draw's second radiance lies, in words; kNoChange if it has none.
  std::uint32_t changeWord(std::uint32_t draw) const {
    const auto found = words_.find(draw);
    return found == words_.end() ? kNoChange : found->second;
  }
  void bindStorage(std::uint32_t binding) const { change_.bindStorage(binding); }
  std::uint32_t drawsShadedLast() const { return shaded_; }

 private:
  // Compares a draw's version, that of its cells, its grids and what is written of them.
  using DrawChanged =
      ChangeGate<std::uint64_t, std::uint64_t, std::vector<VertexDraw::From>, std::vector<std::uint64_t>>;
  struct Places {
    std::uint32_t first = 0;    // index of the group's first sample in the table of places
    std::uint64_t version = 0;  // version of the group's cells
  };
  void layOut(const streaming::Residency& residency, std::span<const VertexDraw> draws);
  bool changed(const streaming::Residency& residency, const Neighborhood& effect, const VertexDraw& draw);
  Result<void> findPlaces(streaming::Residency& residency, gpu::Counters& counters);
  template <typename Record>
  void dispatch(std::span<const Record> records, std::uint32_t largest, gpu::Counters& counters);

  evaluate::Kernels kernels_{kNeighborhoodShaders};
  std::map<std::uint32_t, std::uint32_t> words_;  // keyed by draw
  std::map<std::uint32_t, Places> places_;        // keyed by group
  std::map<std::uint32_t, DrawChanged> changed_;  // keyed by draw
  ChangeGate<evaluate::TransferMode> mode_changed_;
  ChangeGate<std::uint64_t> structure_changed_;
  gpu::Table change_, sample_places_, arrivals_, transfers_, planes_, block_;
  std::uint32_t shaded_ = 0;
};

}  // namespace lambent::effects::neighborhood
