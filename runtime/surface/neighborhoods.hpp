// Owns neighborhoods in a frame: it chooses which bodies change the light of which groups by their grids
// rather than by captures, and finds what each draw then receives. It reads where groups stand and what is
// resident, and writes the texture of the neighborhood effect and the tables of the surface pass. Without
// grids it holds and runs nothing. Render thread only.
//
// Each ordered pair (body k, receiving group B) has one carrier. It is the grid of k if all of these
// conditions hold, and captures otherwise:
// - The grid has arrived.
// - B has surfaces and is another group than k.
// - B's bounds meet the grid's box. Once the grid carries the pair, B's bounds need only meet the box grown
//   by the distance of two points on every side, so that the carrier does not alternate.
// - k has no lamps of its own, or its grid carries them.
// - k is a volume, or the share of every local light that shadow cubes carry is the same for k and B.
//   Otherwise k's shadow, which the cubes contain, would count twice or not at all.
// The grid of a volume acts on every group with surfaces, including the one that the volume stands within.
//
// A draw receives from a grid at its vertices, through transfer of its own (so that it shades itself under
// the changed light), if the grid has all bands of that transfer, the draw is diffuse without a normal map,
// its edges are on average no longer than the distance of the grid's points, and its transfer is resident
// (effects::neighborhood::hasTransfer). Otherwise it receives per pixel, as an unoccluded surface.
#pragma once

#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "runtime/base/change_gate.hpp"
#include "runtime/base/result.hpp"
#include "runtime/effects/neighborhood/neighborhood.hpp"
#include "runtime/effects/neighborhood/vertex_receivers.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/shadows/lit_scene.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

// A draw receives from at most this many grids, the nearest ones.
inline constexpr std::uint32_t kMaxArrivals = 32;

struct NeighborhoodCounts {
  std::uint32_t grids = 0;                                          // grids that groups have
  std::uint32_t ready = 0;                                          // grids that have arrived
  std::uint32_t written = 0;                                        // grids written in the last step
  std::uint32_t pairs = 0;                                          // pairs (body, group) that grids carry
  std::uint32_t receivers = 0;                                      // draws that receive
  std::uint32_t arrivals = 0;                                       // pairs (draw, grid)
  std::uint32_t left_out = 0;                                       // pairs beyond kMaxArrivals
  std::uint32_t vertex_receivers = 0, vertex_receivers_shaded = 0;  // draws; shaded in the last step
};

class Neighborhoods {
 public:
  Neighborhoods();

  // Returns whether any group has a grid.
  bool any() const { return !effect_.grids().empty(); }
  // Notices new bundles, chooses carriers, and leaves bodies out of captures. Call it before the light is
  // updated. If `on` is false, captures carry all pairs at once.
  void chooseCarriers(const World& world, LitScene& scene, bool on = true);
  // Copies what was shaded into the texture. Call it after the glossy effect.
  Result<void> update(World& world, const lighting::GroupLights& lights, const evaluate::Samples& samples,
                      evaluate::TransferMode mode, gpu::Counters& counters);

  // Returns whether no grid has become ready since carriers were chosen. If one has, the next step shows it.
  bool settled() const { return readyGrids() == ready_when_chosen_; }
  // Return whether the draw receives per pixel, or at its vertices.
  bool receives(std::size_t draw) const { return draw < receivers_.size() && receivers_[draw].count > 0; }
  bool receivesAtVertices(std::size_t draw) const {
    return draw < receivers_.size() && receivers_[draw].change_word != effects::neighborhood::kNoChange;
  }
  // Rises when draws begin or cease to receive.
  std::uint64_t version() const { return version_; }
  // Bind what the surface pass reads. bindVertices() uses a binding that glossy draws use otherwise.
  void bind() const;
  void bindVertices() const;
  const NeighborhoodCounts& counts() const { return counts_; }
  const effects::neighborhood::Neighborhood& effect() const { return effect_; }
  // Returns the pairs that grids carry, as indices of groups in the residency: that of the body, that which
  // receives.
  const std::set<std::pair<std::uint32_t, std::uint32_t>>& pairs() const { return pairs_; }

 private:
  std::size_t readyGrids() const;
  void noticeGrids(const World& world);
  void takeReceivers();
  void findReceivers(const World& world, evaluate::TransferMode mode, bool keys);

  effects::neighborhood::Neighborhood effect_;
  std::set<std::pair<std::uint32_t, std::uint32_t>> pairs_;
  std::vector<effects::neighborhood::Receiver> receivers_, found_;  // indexed by draw; found in this step
  std::vector<effects::neighborhood::Arrival> arrivals_;
  std::vector<effects::neighborhood::VertexDraw> vertex_draws_;
  effects::neighborhood::VertexReceivers vertex_receivers_;
  gpu::Table receivers_table_, arrivals_table_;
  std::vector<std::uint64_t> group_keys_;  // keys of the groups that pairs_ refers to
  std::size_t ready_when_chosen_ = 0;
  ChangeGate<std::uint64_t> structure_changed_;
  // Compares the versions of the residency, transforms and the effect, the mode, and whether key lights are
  // apart.
  ChangeGate<std::uint64_t, std::uint64_t, std::uint64_t, evaluate::TransferMode, bool> receivers_changed_;
  bool on_ = true;
  std::uint32_t left_out_ = 0;
  std::uint64_t version_ = 1;
  NeighborhoodCounts counts_;
};

}  // namespace lambent::frame
