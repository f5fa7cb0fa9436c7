// Owns neighborhoods in a frame: the light plan chooses which bodies change the light of which groups by
// their grids rather than by captures, and this finds what each draw then receives. It reads where groups
// stand and what is resident, and writes the texture of the neighborhood effect and the tables of the surface
// pass. Without grids it holds and runs nothing. Render thread only.
//
// A draw receives from a grid at its vertices, through transfer of its own (so that it shades itself under
// the changed light), if the grid has all bands of that transfer, the draw is diffuse without a normal map,
// its edges are on average no longer than the distance of the grid's points, and its transfer is resident
// (effects::neighborhood::hasTransfer). Otherwise it receives per pixel, as an unoccluded surface.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "runtime/base/change_gate.hpp"
#include "runtime/base/result.hpp"
#include "runtime/draws/surface_module.hpp"
#include "runtime/effects/neighborhood/neighborhood.hpp"
#include "runtime/light_plan/light_plan.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

// A draw receives from at most this many grids, the nearest ones.
inline constexpr std::uint32_t kMaxArrivals = 32;

// A count of the last step with its name in StepCounts.
using NamedCount = std::pair<std::string_view, std::size_t>;

class Neighborhoods {
 public:
  Neighborhoods();

  // Returns whether any group has a grid.
  bool any() const { return !effect_.grids().empty(); }
  // Notices new bundles, and returns the grids for the light plan. If `on` is false, captures carry all pairs
  // at once.
  PlannedGrids gridsNow(const World& world, bool on);
  // Takes what the plan chose.
  void takePairs(const LightPlan& plan);
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
  std::array<NamedCount, 9> counts() const;
  const effects::neighborhood::Neighborhood& effect() const { return effect_; }
  // Returns the pairs that grids carry, as indices of groups in the residency: that of the body, that which
  // receives.
  const GridPairs& pairs() const { return pairs_; }

 private:
  std::size_t readyGrids() const;
  void noticeGrids(const World& world);
  void takeReceivers();
  void findReceivers(const World& world, evaluate::TransferMode mode, bool keys);

  effects::neighborhood::Neighborhood effect_;
  GridPairs pairs_;
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
  std::uint32_t grids_ready_ = 0;  // when pairs were chosen
  std::uint32_t left_out_ = 0;     // pairs (draw, grid) beyond kMaxArrivals
  std::uint64_t version_ = 1;
};

// Adds what bodies with grids change around them, per pixel, or at the vertices of draws that have transfer
// of their own. It refers to what must outlive it.
class NeighborhoodModule final : public SurfaceModule {
 public:
  NeighborhoodModule(const Neighborhoods& neighborhoods, const bool& shown, bool at_vertices);
  bool reaches(std::size_t draw, const SurfaceDraw&) const override {
    return on_ && (at_vertices_ ? neighborhoods_.receivesAtVertices(draw) : neighborhoods_.receives(draw));
  }
  std::uint64_t version() const override { return on_ ? neighborhoods_.version() : 0; }
  void bindFor(SurfaceReceiver) const override {
    neighborhoods_.bind();
    if (at_vertices_) neighborhoods_.bindVertices();
  }

 private:
  const Neighborhoods& neighborhoods_;
  const bool& on_;
  bool at_vertices_;
};

}  // namespace lambent::frame
