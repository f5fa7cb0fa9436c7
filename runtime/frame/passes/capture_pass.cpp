// Updates the light between bodies: shades their capture proxies, and captures the surroundings of light
// probes where these have changed. The result arrives with the next step.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "runtime/base/change_gate.hpp"
#include "runtime/bounces/patch_bounces.hpp"
#include "runtime/effects/diffuse/diffuse.hpp"
#include "runtime/effects/diffuse/proxies.hpp"
#include "runtime/effects/glossy/glossy.hpp"
#include "runtime/frame/passes/passes.hpp"
#include "runtime/lighting/incident_light.hpp"
#include "runtime/shadows/lit_scene.hpp"

namespace lambent::frame {

namespace {

using effects::diffuse::Diffuse;
using effects::diffuse::Proxies;
using effects::glossy::Glossy;
using lighting::GroupLights;
using Incident = std::optional<lighting::IncidentLight>;

constexpr std::size_t kAllCaptures = std::numeric_limits<std::size_t>::max();

class CapturePass final : public FramePass {
 public:
  explicit CapturePass(Blackboard& board)
      : FramePass(
            {.name = "capture",
             .reads = resources<World, LitScene, GroupLights, PatchBounces, Diffuse, Glossy, Incident>(),
             .writes = resources<LitScene, Proxies, Incident>(),
             .causes = kLightCauses,
             .counts = {"light_probes_captured", "light_probes_waiting", "capture_pages", "capture_tiles",
                        "capture_bodies_drawn", "capture_triangles", "capture_pixels"}}) {
    board.offer(proxies_);
  }

  Result<void> update(FrameContext& frame) override {
    Incident& incident = frame.write<Incident>();
    if (!incident) return {};
    if (Result<void> done = shadeProxies(frame); !done) return done;
    LitScene& scene = frame.write<LitScene>();
    sumDrift(frame, scene);
    Result<void> done = incident->capture(frame.environment, {scene.groups, scene.bodies, scene.lights},
                                          proxies_.radiance(), mostCaptures(frame), frame.counters());
    const lighting::IncidentCounts& counts = incident->counts();
    frame.count("light_probes_captured", counts.captured);
    frame.count("light_probes_waiting", counts.waiting);
    if (counts.captured > 0) {
      const lighting::Capture::Load& load = incident->captures().load();
      frame.count("capture_pages", load.pages);
      frame.count("capture_tiles", load.tiles);
      frame.count("capture_bodies_drawn", load.draws);
      frame.count("capture_triangles", load.triangles);
      frame.count("capture_pixels", load.pixels);
    }
    if (frame.counters().dispatches > 0) frame.because("light between bodies");
    return done;
  }

 private:
  Result<void> shadeProxies(const FrameContext& frame) {
    const auto& bounces = frame.read<PatchBounces>();
    std::vector<std::uint64_t> shaded;
    std::vector<effects::diffuse::AddedRadiance> added;
    for (std::size_t g = 0; g < frame.world.residency().groups().size(); ++g) {
      shaded.push_back(frame.read<Diffuse>().versionOf(g) + frame.read<Glossy>().versionOf(g));
      added.push_back({.triangles = bounces.sentBy(g), .version = bounces.versionOf(g)});
    }
    return proxies_.shade(frame.world.residency(), frame.read<GroupLights>(), shaded, frame.counters(),
                          added);
  }

  void sumDrift(const FrameContext& frame, LitScene& scene) {
    const auto& lights = frame.read<GroupLights>();
    radiance_.follow(scene.groups, &lighting::IncidentGroup::key);
    for (std::size_t g = 0; g < scene.groups.size(); ++g) {
      Radiance& radiance = radiance_[g];
      if (std::exchange(radiance.version, proxies_.versionOf(g)) != proxies_.versionOf(g)) {
        const double bounced = frame.read<PatchBounces>().driftOf(g);
        const bool by_light = std::exchange(radiance.light, lights.versionOf(g)) != lights.versionOf(g);
        const bool by_bounces = bounced != radiance.bounced;
        if (by_light) radiance.drift += double{lights.changeOf(g)};
        if (by_bounces) radiance.drift += std::min(std::abs(bounced - radiance.bounced), 1.0);
        // The group was shaded for another reason than light or a turn, so everything may differ.
        if (!by_light && !by_bounces) radiance.drift += 1.0;
        radiance.bounced = bounced;
      }
      if (const std::uint32_t body = scene.groups[g].body; body != lighting::CapturePoint::kNoBody)
        scene.bodies[body].radiance_drift = radiance.drift;
    }
  }

  // Returns how many captures may be drawn. In the step in which bundles arrived or were removed there are
  // none, because that step is costly already; they begin with the next one. Without a view nobody waits for
  // a picture, so all are drawn at once.
  std::size_t mostCaptures(const FrameContext& frame) {
    const bool changed = structure_changed_.renew(frame.world.residency().structureVersion());
    waited_ = changed && !waited_ && frame.view;
    if (waited_) return 0;
    return frame.view ? frame.settings().captures_per_step : kAllCaptures;
  }

  // Sums up how the light that a group sends out has changed.
  struct Radiance {
    std::uint64_t version = 0, light = 0;
    double bounced = 0.0, drift = 0.0;
  };
  Proxies proxies_;
  KeyedState<Radiance> radiance_;
  ChangeGate<std::uint64_t> structure_changed_;  // residency, since the last captures
  bool waited_ = false;  // whether the last step drew no captures because the structure changed
};

}  // namespace

MadePass makeCapturePass(const PassSetup& setup) {
  return std::make_unique<CapturePass>(setup.board);
}

}  // namespace lambent::frame
