// Neighborhoods in a frame: which bodies change whose light by their grids rather than by captures, and what
// each draw then receives per pixel.
//
// One carrier for each ordered pair (k -> B). By the grid of k, where all of this holds: the grid has
// arrived; B has surfaces and is another group than k; B's bounds meet the grid's box (once carried, they
// need only meet the box grown by a point's distance all around, so that nothing flips to and fro); k has no
// lamps of its own, or the grid carries them; of no lamp do k and B have other shares per pixel, with shadow
// cubes in which k stands (its shadow would count twice, or not at all). Otherwise by capture. A volume's
// grid acts on every group with surfaces, the one that it stands within included.
//
// A draw receives from a grid at its vertices, through transfer of its own (so that it shades itself under
// the changed light), where the grid has all bands of that transfer, the draw is diffuse without a normal
// map, its edges are at most as long, in the mean, as the grid's points are apart, and its transfer is there
// (effects::neighborhood::hasTransfer). Otherwise per pixel, as an open surface.
//
// Reads where groups stand and what is resident; writes the texture of the neighborhood effect and the tables
// of the surface pass. Without grids it holds and runs nothing. Render thread only.
#pragma once

#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "runtime/base/change_gate.hpp"
#include "runtime/base/result.hpp"
#include "runtime/effects/glossy/glossy.hpp"
#include "runtime/effects/neighborhood/neighborhood.hpp"
#include "runtime/effects/neighborhood/vertex_receivers.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/shadows/lit_scene.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

// Grids that one draw receives from, the nearest; more are left out.
inline constexpr std::uint32_t kMaxArrivals = 32;

struct NeighborhoodCounts {
  std::uint32_t grids = 0;                                          // there are
  std::uint32_t ready = 0;                                          // have arrived
  std::uint32_t written = 0;                                        // were written anew in this step
  std::uint32_t pairs = 0;                                          // (body -> group) carried by grids
  std::uint32_t receivers = 0;                                      // draws that receive
  std::uint32_t arrivals = 0;                                       // draw by grid
  std::uint32_t left_out = 0;                                       // beyond kMaxArrivals
  std::uint32_t vertex_receivers = 0, vertex_receivers_shaded = 0;  // draws; of these anew in this step
};

class Neighborhoods {
 public:
  Neighborhoods();

  // Whether any group has a grid.
  bool any() const { return !effect_.grids().empty(); }
  // Before the light: notices new bundles, chooses carriers, and leaves bodies out of captures. Off: no pair
  // is carried by grids, at once.
  void chooseCarriers(const World& world, LitScene& scene, bool on = true);
  // After the glossy effect: what was shaded goes into the texture.
  Result<void> update(World& world, const lighting::GroupLights& lights,
                      const effects::glossy::Glossy& glossy, evaluate::TransferMode mode,
                      gpu::Counters& counters);

  // Whether no grid has become ready since carriers were chosen: else the next step shows it.
  bool settled() const { return readyGrids() == ready_when_chosen_; }
  // Whether the draw receives per pixel; at its vertices.
  bool receives(std::size_t draw) const { return draw < receivers_.size() && receivers_[draw].count > 0; }
  bool receivesAtVertices(std::size_t draw) const {
    return draw < receivers_.size() && receivers_[draw].change_word != effects::neighborhood::kNoChange;
  }
  // Rises when draws begin or cease to receive.
  std::uint64_t version() const { return version_; }
  // For the surface pass; what draws receive at their vertices in a place that glossy draws use otherwise.
  void bind() const;
  void bindVertices() const;
  const NeighborhoodCounts& counts() const { return counts_; }
  const effects::neighborhood::Neighborhood& effect() const { return effect_; }
  // (group of the body, group that receives), of the residency.
  const std::set<std::pair<std::uint32_t, std::uint32_t>>& pairs() const { return pairs_; }

 private:
  std::size_t readyGrids() const;
  void noticeGrids(const World& world);
  void takeReceivers();
  void findReceivers(const World& world, evaluate::TransferMode mode, bool keys);

  effects::neighborhood::Neighborhood effect_;
  std::set<std::pair<std::uint32_t, std::uint32_t>> pairs_;
  std::vector<effects::neighborhood::Receiver> receivers_, found_;  // by draw; found in this step
  std::vector<effects::neighborhood::Arrival> arrivals_;
  std::vector<effects::neighborhood::VertexDraw> vertex_draws_;
  effects::neighborhood::VertexReceivers vertex_receivers_;
  gpu::Table receivers_table_, arrivals_table_;
  std::vector<std::uint64_t> group_keys_;  // what indices of groups mean in pairs_
  std::size_t ready_when_chosen_ = 0;
  ChangeGate<std::uint64_t> structure_changed_;
  // Of the residency, transforms and the effect; the mode, whether key lights stand apart.
  ChangeGate<std::uint64_t, std::uint64_t, std::uint64_t, evaluate::TransferMode, bool> receivers_changed_;
  bool on_ = true;
  std::uint32_t left_out_ = 0;
  std::uint64_t version_ = 1;
  NeighborhoodCounts counts_;
};

}  // namespace lambent::frame
