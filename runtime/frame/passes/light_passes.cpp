// The passes that bring light to light probes and patches.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "runtime/base/change_gate.hpp"
#include "runtime/bounces/patch_bounces.hpp"
#include "runtime/effects/diffuse/diffuse.hpp"
#include "runtime/evaluate/samples.hpp"
#include "runtime/frame/frame_pass.hpp"
#include "runtime/light_plan/light_plan.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/lighting/incident_light.hpp"
#include "runtime/surface/neighborhoods.hpp"

namespace lambent::frame {

namespace {

// Computes the light at the groups' light probes: the environment, lights in the scene, and light between
// bodies.
using lighting::GroupLights;
using Incident = std::optional<lighting::IncidentLight>;

float meanRadiance(const lighting::Environment& environment) {
  constexpr float kMeanOfBandZero = 0.28209479f;  // y_00
  const glm::vec3 mean = kMeanOfBandZero * environment.light().c[0];
  return std::max({mean.r, mean.g, mean.b, 0.0f});
}

class LightPass final : public FramePass {
 public:
  explicit LightPass(Blackboard& board)
      : FramePass(
            {.name = "light",
             .reads = resources<World>(),
             .reads_before = resources<Incident, Neighborhoods>(),
             .writes = resources<LightPlan, Incident, GroupLights, Neighborhoods>(),
             .causes = kLightCauses,
             .counts = {"groups", "bodies", "local_lights", "shadowed_lights", "shadowed_lights_left_out",
                        "light_probes", "light_probes_risen", "light_probes_written"}}) {
    board.offer(plan_);
    board.offer(incident_);
    board.offer(group_lights_);
  }

  Result<void> update(FrameContext& frame) override {
    const FrameSettings& settings = frame.settings();
    // Captures depend on the previous light, so they are drawn anew when the carriers change. Otherwise the
    // result would depend on which carriers were in use before.
    if (carriers_.renew(settings.captures, settings.neighborhoods, settings.local_shadows,
                        settings.local_radii) &&
        incident_)
      incident_->forget();
    makePlan(frame);
    if (Result<void> done = prepareSampling(frame); !done) return done;
    if (incident_) sample(frame);
    group_lights_.update(frame.environment, settings.window, placesOf(frame), frame.counters(),
                         static_cast<int>(settings.order));
    if (frame.counters().uploaded_bytes > 0) frame.because("light");
    frame.count("groups", plan_.groups.size());
    frame.count("bodies", plan_.bodies.size());
    frame.count("local_lights", plan_.lights.size());
    frame.count("shadowed_lights", plan_.shadowed_lights.size());
    frame.count("shadowed_lights_left_out", plan_.local_left_out);
    frame.count("light_probes_written", group_lights_.renewedSamples());
    return {};
  }
  void forget() override {
    group_lights_.forget();
    if (incident_) incident_->forget();
  }
  bool settled() const override { return !incident_ || incident_->atRest(); }

 private:
  void makePlan(const FrameContext& frame) {
    const FrameSettings& settings = frame.settings();
    const std::vector<ecs::Entity> cubes_before = std::move(plan_.column_entities);
    Neighborhoods& neighborhoods = frame.write<Neighborhoods>();
    const bool by_grids = settings.neighborhoods || neighborhoods.any();
    plan_ = makeLightPlan(
        frame.world, meanRadiance(frame.environment),
        {.shadowed_lights = settings.local_shadows,
         .column_lights = settings.local_shadows && frame.options.keysApart(),
         .local_radii = frame.options.keysApart() ? settings.local_radii : 0.0f,
         .bodies = settings.captures,
         .most_suns = frame.environment.mostKeys(),
         .cubes_before = cubes_before,
         .grids = by_grids ? neighborhoods.gridsNow(frame.world, settings.neighborhoods) : PlannedGrids{}});
    if (by_grids) neighborhoods.takePairs(plan_);
  }

  Result<void> prepareSampling(const FrameContext& frame) {
    if (!incident_ && !plan_.needsSampling()) return {};
    lighting::CaptureOptions options = frame.settings().capture;
    options.order = std::max(1, capture_order_);  // never falls, so that captured light stays valid
    for (const streaming::ResidentGroup& group : frame.world.residency().groups())
      options.order = std::max(options.order, static_cast<int>(group.order));
    if (!incident_) {
      auto made = lighting::IncidentLight::create(options, frame.environment);
      if (!made) return failAgain(made.error());
      incident_ = std::move(*made);
      proxies_.forget();
    } else if (!(options == incident_->captures().options())) {
      if (Result<void> done = incident_->renew(options, frame.environment); !done) return done;
      proxies_.forget();
    }
    capture_order_ = options.order;
    if (proxies_.renew(frame.world.residency().proxiesVersion())) {
      std::vector<const bundle::CaptureProxy*> proxies;  // in the order of the bodies
      std::vector<std::uint64_t> keys;
      for (const streaming::ResidentGroup& group : frame.world.residency().groups()) {
        if (!group.proxy) continue;
        proxies.push_back(&*group.proxy);
        keys.push_back(group.id);
      }
      incident_->captures().setProxies(proxies, frame.counters(), keys);
    }
    return {};
  }

  void sample(const FrameContext& frame) {
    incident_->update(frame.environment, plan_.groups, plan_.lights, frame.options.wait_for_captures);
    const lighting::IncidentCounts& counts = incident_->counts();
    if (counts.arrived > 0) frame.log.note(Cause::Captured, "captures arrived");
    if (counts.fading > 0) frame.log.note(Cause::Captured, "light fades from carrier to carrier");
    frame.count("light_probes", counts.samples);
    frame.count("light_probes_risen", counts.risen);
  }

  std::vector<lighting::GroupPlace> placesOf(const FrameContext& frame) const {
    std::vector<lighting::GroupPlace> places;
    const auto& groups = frame.world.residency().groups();
    for (std::size_t g = 0; g < groups.size(); ++g)
      places.push_back({.world_from_group = frame.world.rotationOf(g),
                        .order = groups[g].order,
                        .lamps = plan_.lamps[g],
                        .lamps_apart = plan_.lamps_apart[g],
                        .incident = incident_
                                        ? incident_->incidentOf(g)
                                        : std::vector<lighting::Incident>(groups[g].light_probes.size()),
                        .key = plan_.groups[g].key,
                        .parted = frame.options.keysApart() && groups[g].volume < 0});
    return places;
  }

  LightPlan plan_;
  Incident incident_;  // made once there is something to sample
  GroupLights group_lights_;
  ChangeGate<bool, bool, bool, float> carriers_;  // settings that choose carriers
  ChangeGate<std::uint64_t> proxies_;             // version that the captures have
  int capture_order_ = 0;
};

// Bounces lights among the surfaces, and key lights, by patches.
class PatchBouncesPass final : public FramePass {
 public:
  explicit PatchBouncesPass(Blackboard& board)
      : FramePass({.name = "patch bounces",
                   .reads = resources<World, LightPlan, lighting::GroupLights>(),
                   .writes = resources<PatchBounces>(),
                   .causes = kLightCauses,
                   .counts = {"patch_rooms", "patch_rooms_to_come", "patches", "lights_bounced",
                              "patch_draws_gathered"}}) {
    board.offer(bounces_);
    board.get<SurfaceModules>().push_back(&bounces_);
  }

  bool due(const FrameContext& frame) override {
    return !frame.read<LightPlan>().shadowed_lights.empty() || !frame.keys().empty() || bounces_.any();
  }
  Result<void> update(FrameContext& frame) override {
    const FrameSettings& settings = frame.settings();
    const bool on = settings.patch_bounces && settings.transfer == evaluate::TransferMode::Full;
    Result<void> done = bounces_.update(frame.world, frame.read<LightPlan>(),
                                        {.keys = frame.keys(), .bands = &frame.read<lighting::GroupLights>()},
                                        on, frame.options.wait_for_captures, frame.counters());
    const PatchBounceCounts& counts = bounces_.counts();
    frame.count("patch_rooms", counts.rooms);
    frame.count("patch_rooms_to_come", counts.rooms_to_come);
    frame.count("patches", counts.patches);
    frame.count("lights_bounced", counts.lights_bounced);
    frame.count("patch_draws_gathered", counts.draws_gathered);
    if (frame.counters().uploaded_bytes > 0) frame.because("lights that patches send on");
    return done;
  }

 private:
  PatchBounces bounces_;
};

// Updates the light between bodies: shades their capture proxies, and captures the surroundings of light
// probes where these have changed. The result arrives with the next step.
using effects::diffuse::Proxies;

constexpr std::size_t kAllCaptures = std::numeric_limits<std::size_t>::max();

class CapturePass final : public FramePass {
 public:
  explicit CapturePass(Blackboard& board)
      : FramePass(
            {.name = "capture",
             .reads = resources<World, LightPlan, GroupLights, PatchBounces, evaluate::Samples, Incident>(),
             .writes = resources<Proxies, Incident>(),
             .causes = kLightCauses,
             .counts = {"light_probes_captured", "light_probes_waiting", "capture_bodies_drawn"}}) {
    board.offer(proxies_);
  }

  Result<void> update(FrameContext& frame) override {
    Incident& incident = frame.write<Incident>();
    if (!incident) return {};
    if (Result<void> done = shadeProxies(frame); !done) return done;
    const auto& plan = frame.read<LightPlan>();
    Result<void> done =
        incident->capture(frame.environment, {plan.groups, driftingBodies(frame, plan), plan.lights},
                          proxies_.radiance(), mostCaptures(frame), frame.counters());
    const lighting::IncidentCounts& counts = incident->counts();
    frame.count("light_probes_captured", counts.captured);
    frame.count("light_probes_waiting", counts.waiting);
    if (counts.captured > 0) frame.count("capture_bodies_drawn", incident->captures().load().draws);
    if (frame.counters().dispatches > 0) frame.because("light between bodies");
    return done;
  }

 private:
  Result<void> shadeProxies(const FrameContext& frame) {
    const auto& bounces = frame.read<PatchBounces>();
    std::vector<std::uint64_t> shaded;
    std::vector<effects::diffuse::AddedRadiance> added;
    for (std::size_t g = 0; g < frame.world.residency().groups().size(); ++g) {
      shaded.push_back(frame.read<evaluate::Samples>().allVersionOf(g));
      added.push_back({.triangles = bounces.sentBy(g), .version = bounces.versionOf(g)});
    }
    return proxies_.shade(frame.world.residency(), frame.read<GroupLights>(), shaded, frame.counters(),
                          added);
  }

  // Returns the bodies with the sums of how their light has changed.
  std::vector<lighting::IncidentBody> driftingBodies(const FrameContext& frame, const LightPlan& plan) {
    const auto& lights = frame.read<GroupLights>();
    std::vector<lighting::IncidentBody> bodies = plan.bodies;
    radiance_.follow(plan.groups, &lighting::IncidentGroup::key);
    for (std::size_t g = 0; g < plan.groups.size(); ++g) {
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
      if (const std::uint32_t body = plan.groups[g].body; body != lighting::CapturePoint::kNoBody)
        bodies[body].radiance_drift = radiance.drift;
    }
    return bodies;
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

MadePass makeLightPass(const PassSetup& setup) {
  return std::make_unique<LightPass>(setup.board);
}

MadePass makePatchBouncesPass(const PassSetup& setup) {
  return std::make_unique<PatchBouncesPass>(setup.board);
}

MadePass makeCapturePass(const PassSetup& setup) {
  return std::make_unique<CapturePass>(setup.board);
}

}  // namespace lambent::frame
