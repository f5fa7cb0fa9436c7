// Updates what bodies with grids change around them. The light pass has chosen which of them act on whom.
#include "runtime/effects/glossy/glossy.hpp"
#include "runtime/frame/passes/passes.hpp"
#include "runtime/surface/light_modules.hpp"
#include "runtime/surface/neighborhoods.hpp"

namespace lambent::frame {

namespace {

class NeighborhoodPass final : public FramePass {
 public:
  explicit NeighborhoodPass(Blackboard& board)
      : FramePass({.name = "neighborhood",
                   .reads = resources<World, lighting::GroupLights, effects::glossy::Glossy, Neighborhoods>(),
                   .writes = resources<Neighborhoods>(),
                   .causes = kLightCauses,
                   .counts = {"neighborhood_grids", "neighborhood_grids_ready", "neighborhood_grids_written",
                              "neighborhood_pairs", "neighborhood_receivers", "neighborhood_arrivals",
                              "neighborhood_vertex_receivers", "neighborhood_vertex_receivers_shaded",
                              "neighborhood_arrivals_left_out"}}) {
    board.offer(neighborhoods_);
    board.get<SurfaceModules>().push_back(&at_pixels_);
    board.get<SurfaceModules>().push_back(&at_vertices_);
  }

  bool due(const FrameContext& frame) override {
    shown_ = frame.settings().neighborhoods;
    return shown_ && neighborhoods_.any();
  }
  Result<void> update(FrameContext& frame) override {
    Result<void> done = neighborhoods_.update(frame.world, frame.read<lighting::GroupLights>(),
                                              frame.read<effects::glossy::Glossy>(),
                                              frame.settings().transfer, frame.counters());
    if (frame.counters().dispatches > 0 || frame.counters().uploaded_bytes > 0) frame.because("light");
    const NeighborhoodCounts& counts = neighborhoods_.counts();
    frame.count("neighborhood_grids", counts.grids);
    frame.count("neighborhood_grids_ready", counts.ready);
    frame.count("neighborhood_grids_written", counts.written);
    frame.count("neighborhood_pairs", counts.pairs);
    frame.count("neighborhood_receivers", counts.receivers);
    frame.count("neighborhood_arrivals", counts.arrivals);
    frame.count("neighborhood_vertex_receivers", counts.vertex_receivers);
    frame.count("neighborhood_vertex_receivers_shaded", counts.vertex_receivers_shaded);
    frame.count("neighborhood_arrivals_left_out", counts.left_out);
    return done;
  }
  bool settled() const override { return neighborhoods_.settled(); }

 private:
  Neighborhoods neighborhoods_;
  bool shown_ = true;
  NeighborhoodModule at_pixels_{neighborhoods_, shown_};
  VertexChangeModule at_vertices_{neighborhoods_, shown_};
};

}  // namespace

MadePass makeNeighborhoodPass(const PassSetup& setup) {
  return std::make_unique<NeighborhoodPass>(setup.board);
}

}  // namespace lambent::frame
