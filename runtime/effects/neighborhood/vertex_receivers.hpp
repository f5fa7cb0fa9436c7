// Receivers with transfer of their own: t_p . dl'(x_p) at every vertex of such draws, in compute, from the
// texture of the neighborhood effect and the receiver's coded transfer. Comes in: draws with the grids that
// reach them. Goes out: a second radiance, E/pi, that the raster adds to the draw's own. Shaded anew where a
// grid's light, the places of draw and body to each other, or the draw's transfer changed; else nothing is
// dispatched. Without such draws nothing is compiled, held or dispatched. Errors: a kernel that does not
// compile on this device.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include <glm/gtc/quaternion.hpp>

#include "runtime/base/result.hpp"
#include "runtime/effects/diffuse/transfer_table.hpp"
#include "runtime/effects/neighborhood/neighborhood.hpp"
#include "runtime/effects/neighborhood/vertex_shared.h"

namespace lambent::effects::neighborhood {

struct VertexDraw {
  struct From {
    std::uint32_t grid = 0;  // of the effect
    mat3x4 grid_from_position{0.0f};
    glm::quat group_from_body{1.0f, 0.0f, 0.0f, 0.0f};
    bool operator==(const From&) const = default;
  };
  std::uint32_t draw = 0;  // of the residency
  std::vector<From> from;
};

// Whether all that is needed of the draw is there, and in one page: a plain draw with rows, whose group's
// plain cells have their transfer of light from the environment, in `order` bands.
bool hasTransfer(const streaming::Residency& residency, std::uint32_t draw, std::uint32_t order);

class VertexReceivers {
 public:
  VertexReceivers();

  // Draws that hasTransfer() in as many bands as their grids have.
  Result<void> update(streaming::Residency& residency, const lighting::GroupLights& lights,
                      diffuse::TransferMode mode, const Neighborhood& effect,
                      std::span<const VertexDraw> draws, gpu::Counters& counters);

  // Where a draw's second radiance lies, in words; kNoChange: it has none.
  std::uint32_t changeWord(std::uint32_t draw) const {
    const auto found = words_.find(draw);
    return found == words_.end() ? kNoChange : found->second;
  }
  void bindStorage(std::uint32_t binding) const { change_.bindStorage(binding); }
  std::uint32_t drawsShadedLast() const { return shaded_; }

 private:
  // What a draw's second radiance was computed from.
  struct Seen {
    std::uint64_t draw = 0, cells = 0;
    std::vector<VertexDraw::From> from;
    std::vector<std::uint64_t> written;
    bool operator==(const Seen&) const = default;
  };
  struct Places {
    std::uint32_t first = 0;    // of the group's samples, in the table of places
    std::uint64_t version = 0;  // of its cells
  };
  void layOut(const streaming::Residency& residency, std::span<const VertexDraw> draws);
  Seen seenNow(const streaming::Residency& residency, const Neighborhood& effect,
               const VertexDraw& draw) const;
  Result<void> findPlaces(streaming::Residency& residency, gpu::Counters& counters);
  Result<const gpu::Program*> program(std::uint32_t order);
  void bindBlock(std::span<const std::byte> bytes);

  std::map<std::uint32_t, gpu::Program> programs_;  // by order; 0: places
  std::map<std::uint32_t, std::uint32_t> words_;    // by draw
  std::map<std::uint32_t, Places> places_;          // by group
  std::map<std::uint32_t, Seen> seen_;              // by draw
  diffuse::TransferMode mode_seen_ = diffuse::TransferMode::Full;
  gpu::Table change_, sample_places_, arrivals_, transfers_, planes_, block_;
  std::uint64_t structure_seen_ = 0;
  std::uint32_t shaded_ = 0;
};

}  // namespace lambent::effects::neighborhood
