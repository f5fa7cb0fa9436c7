// Uploads what has arrived, within a budget of bytes, and updates nodes, rigid groups, materials and
// the suns of the scene.
#include <algorithm>
#include <chrono>
#include <optional>

#include "runtime/effects/diffuse/diffuse.hpp"
#include "runtime/evaluate/samples.hpp"
#include "runtime/evaluate/seen_sky.hpp"
#include "runtime/frame/frame_pass.hpp"
#include "runtime/surface/neighborhoods.hpp"
#include "runtime/world/frame_times.hpp"

namespace lambent::frame {

namespace {

class UploadPass final : public FramePass {
 public:
  UploadPass()
      : FramePass({.name = "upload",
                   .writes = resources<World>(),
                   .causes = static_cast<std::uint32_t>(Cause::Arrived),
                   .counts = {"volumes"}}) {}

  Result<void> update(FrameContext& frame) override {
    const std::uint64_t most = frame.options.upload_budget_bytes;
    if (frame.view) noticeFrame(most);
    Result<void> done = frame.options.pace_uploads
                            ? frame.world.upload(pacer_.budget(most), frame.counters(), pacer_.waitSeconds())
                            : frame.world.upload(most, frame.counters());
    uploaded_bytes_ += frame.counters().uploaded_bytes;
    frame.log.noticeArrivals(frame.world, frame.counters().uploaded_bytes);
    frame.because();
    frame.count("volumes", frame.world.residency().volumes().size());
    return done;
  }

 private:
  // Records the time from one picture to the next, with the steps between them.
  void noticeFrame(std::uint64_t most_bytes) {
    const auto now = std::chrono::steady_clock::now();
    if (rendered_)
      pacer_.frameTook(std::chrono::duration<double, std::milli>(now - *rendered_).count(),
                       uploaded_bytes_ > 0, most_bytes);
    rendered_ = now;
    uploaded_bytes_ = 0;
  }

  UploadPacer pacer_;
  std::optional<std::chrono::steady_clock::time_point> rendered_;  // time of the last picture
  std::uint64_t uploaded_bytes_ = 0;                               // since the last picture
};

class TransformsPass final : public FramePass {
 public:
  TransformsPass()
      : FramePass({.name = "transforms",
                   .reads = resources<World>(),
                   .writes = resources<World>(),
                   .causes = Cause::Moved | Cause::Materials}) {}

  Result<void> update(FrameContext& frame) override {
    frame.world.updateTransforms();
    frame.world.updateMaterials();
    frame.environment.setSuns(sunsOf(frame.world, frame.environment.mostKeys()).discs);
    frame.log.noticeEnvironment(frame.environment);
    frame.log.noticeWorld(frame.world);
    frame.because();
    return {};
  }
};

}  // namespace

MadePass makeUploadPass(const PassSetup&) {
  return std::make_unique<UploadPass>();
}

MadePass makeTransformsPass(const PassSetup&) {
  return std::make_unique<TransformsPass>();
}

// The passes that evaluate transfer under the light of its groups, at vertices, samples and grids.

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
  NeighborhoodModule at_pixels_{neighborhoods_, shown_, /*at_vertices=*/false};
  NeighborhoodModule at_vertices_{neighborhoods_, shown_, /*at_vertices=*/true};
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
