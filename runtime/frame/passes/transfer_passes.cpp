// The passes that evaluate transfer under the light of its groups, at vertices, samples and grids.
#include <algorithm>

#include "runtime/effects/diffuse/diffuse.hpp"
#include "runtime/evaluate/samples.hpp"
#include "runtime/evaluate/seen_sky.hpp"
#include "runtime/frame/pass_list.hpp"
#include "runtime/surface/light_modules.hpp"
#include "runtime/surface/neighborhoods.hpp"

namespace lambent::frame {

namespace {

// Shades the samples that vertices and volumes take, and E/pi at every vertex whose light or transfer
// changed.
class DiffusePass final : public FramePass {
 public:
  explicit DiffusePass(Blackboard& board)
      : FramePass({.name = "shade",
                   .reads = resources<World, lighting::GroupLights>(),
                   .writes = resources<evaluate::Samples, effects::diffuse::Diffuse>(),
                   .causes = kLightCauses,
                   .counts = {"cells_shaded", "draws_shaded"}}) {
    board.offer(samples_);
    board.offer(diffuse_);
  }

  Result<void> update(FrameContext& frame) override {
    const FrameSettings& settings = frame.settings();
    streaming::Residency& residency = frame.world.residency();
    const auto& lights = frame.read<lighting::GroupLights>();
    Result<void> done =
        samples_.shade(residency, lights, settings.transfer, frame.counters(),
                       {.surfaces = settings.diffuse, .volumes = settings.volumes, .matrices = false});
    if (!done) return done;
    done = diffuse_.shade(residency, lights, settings.transfer, samples_, frame.counters(), settings.diffuse);
    if (frame.counters().dispatches > 0) frame.because("light");
    frame.count("cells_shaded", samples_.cellsShadedLast());
    frame.count("draws_shaded", diffuse_.drawsShadedLast());
    return done;
  }

 private:
  evaluate::Samples samples_;
  effects::diffuse::Diffuse diffuse_;
};

// Computes what the vertices of layered draws see of the sky, when their transfer has arrived.
class SeenSkyPass final : public FramePass {
 public:
  explicit SeenSkyPass(Blackboard& board)
      : FramePass({.name = "seen sky",
                   .reads = resources<World, lighting::GroupLights>(),
                   .writes = resources<evaluate::SeenSky>()}) {
    board.offer(seen_sky_);
  }

  bool due(const FrameContext& frame) override {
    return std::ranges::any_of(frame.world.residency().draws(), &streaming::ResidentDraw::layered);
  }
  Result<void> update(FrameContext& frame) override {
    Result<void> done =
        seen_sky_.update(frame.world.residency(), frame.read<lighting::GroupLights>(), frame.counters());
    if (frame.counters().dispatches > 0) frame.because("transfer arrived");
    return done;
  }

 private:
  evaluate::SeenSky seen_sky_;
};

// Shades transferred light at the samples of glossy surfaces, of volumes and of grids, if any have matrices.
class GlossyPass final : public FramePass {
 public:
  GlossyPass()
      : FramePass({.name = "glossy",
                   .reads = resources<World, lighting::GroupLights>(),
                   .writes = resources<evaluate::Samples>(),
                   .causes = kLightCauses,
                   .counts = {"cells_shaded"}}) {}

  bool due(const FrameContext& frame) override {
    return std::ranges::any_of(frame.world.residency().cells(), &streaming::ResidentCell::matrices);
  }
  Result<void> update(FrameContext& frame) override {
    const FrameSettings& settings = frame.settings();
    auto& samples = frame.write<evaluate::Samples>();
    Result<void> done = samples.shade(frame.world.residency(), frame.read<lighting::GroupLights>(),
                                      settings.transfer, frame.counters(),
                                      {.surfaces = settings.glossy,
                                       .volumes = settings.volumes,
                                       .neighborhoods = settings.neighborhoods,
                                       .vectors = false});
    if (frame.counters().dispatches > 0) frame.because("light");
    frame.count("cells_shaded", samples.cellsShadedLast());
    return done;
  }
};

// Updates what bodies with grids change around them. The light pass has chosen which of them act on whom.
class NeighborhoodPass final : public FramePass {
 public:
  explicit NeighborhoodPass(Blackboard& board)
      : FramePass({.name = "neighborhood",
                   .reads = resources<World, lighting::GroupLights, evaluate::Samples, Neighborhoods>(),
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
    Result<void> done =
        neighborhoods_.update(frame.world, frame.read<lighting::GroupLights>(),
                              frame.read<evaluate::Samples>(), frame.settings().transfer, frame.counters());
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

MadePass makeDiffusePass(const PassSetup& setup) {
  return std::make_unique<DiffusePass>(setup.board);
}

MadePass makeSeenSkyPass(const PassSetup& setup) {
  return std::make_unique<SeenSkyPass>(setup.board);
}

MadePass makeGlossyPass(const PassSetup&) {
  return std::make_unique<GlossyPass>();
}

MadePass makeNeighborhoodPass(const PassSetup& setup) {
  return std::make_unique<NeighborhoodPass>(setup.board);
}

}  // namespace lambent::frame
