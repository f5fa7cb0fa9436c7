// Computes the light at the groups' light probes: the environment, lights in the scene, and light between
// bodies. It decides which carrier brings each light.
#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "runtime/base/change_gate.hpp"
#include "runtime/frame/passes/passes.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/lighting/incident_light.hpp"
#include "runtime/shadows/lit_scene.hpp"
#include "runtime/surface/neighborhoods.hpp"

namespace lambent::frame {

namespace {

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
             .writes = resources<LitScene, Incident, GroupLights, Neighborhoods>(),
             .causes = kLightCauses,
             .counts = {"groups", "bodies", "local_lights", "shadowed_lights", "shadowed_lights_left_out",
                        "light_probes", "light_probes_risen", "light_probes_written"}}) {
    board.offer(scene_);
    board.offer(incident_);
    board.offer(group_lights_);
  }

  Result<void> update(FrameContext& frame) override {
    const FrameSettings& settings = frame.settings();
    // Captures depend on the previous light, so they are drawn anew when the carriers change. Otherwise the
    // result would depend on which carriers were in use before.
    if (carriers_.renew(settings.captures, settings.neighborhoods, settings.local_shadows,
                        settings.local_radii, settings.light_probes) &&
        incident_)
      incident_->forget();
    gatherScene(frame);
    if (Result<void> done = prepareSampling(frame); !done) return done;
    if (incident_) sample(frame);
    group_lights_.update(frame.environment, settings.window, placesOf(frame), frame.counters(),
                         static_cast<int>(settings.order));
    if (frame.counters().uploaded_bytes > 0) frame.because("light");
    frame.count("groups", scene_.groups.size());
    frame.count("bodies", scene_.bodies.size());
    frame.count("local_lights", scene_.lights.size());
    frame.count("shadowed_lights", scene_.shadowed_lights.size());
    frame.count("shadowed_lights_left_out", scene_.local_left_out);
    frame.count("light_probes_written", group_lights_.renewedSamples());
    return {};
  }
  void forget() override {
    group_lights_.forget();
    if (incident_) incident_->forget();
  }
  bool settled() const override { return !incident_ || incident_->atRest(); }

 private:
  void gatherScene(const FrameContext& frame) {
    const FrameSettings& settings = frame.settings();
    const std::vector<ecs::Entity> cubes_before = std::move(scene_.column_entities);
    scene_ = gatherLitScene(frame.world, meanRadiance(frame.environment),
                            {.shadowed_lights = settings.local_shadows,
                             .column_lights = settings.local_shadows && frame.options.keysApart(),
                             .local_radii = frame.options.keysApart() ? settings.local_radii : 0.0f,
                             .bodies = settings.captures,
                             .most_suns = frame.environment.mostKeys(),
                             .cubes_before = cubes_before});
    Neighborhoods& neighborhoods = frame.write<Neighborhoods>();
    if (settings.neighborhoods || neighborhoods.any())
      neighborhoods.chooseCarriers(frame.world, scene_, settings.neighborhoods);
    keepFewerSamples(frame.world, settings.light_probes);
    hideApart(scene_, proxiesOf(frame.world.residency()).proxies);
  }

  // Keeps at most `most` light probes per group. Other samples take the light of the nearest kept one.
  void keepFewerSamples(const World& world, std::uint32_t most) {
    const auto& groups = world.residency().groups();
    fewer_samples_.assign(groups.size(), {});
    for (std::size_t g = 0; g < groups.size(); ++g) {
      if (groups[g].light_probes.size() <= most) continue;
      fewer_samples_[g] = lighting::fewerSamples(groups[g].light_probes, most);
      std::vector<glm::vec3> kept;
      for (const std::uint32_t sample : fewer_samples_[g].kept)
        kept.push_back(scene_.groups[g].samples_ws[sample]);
      scene_.groups[g].samples_ws = std::move(kept);
    }
  }

  Result<void> prepareSampling(const FrameContext& frame) {
    if (!incident_ && !scene_.needsSampling()) return {};
    lighting::CaptureOptions options = frame.settings().capture;
    if (options.order == 0) {
      options.order = std::max(1, capture_order_);  // never falls, so that captured light stays valid
      for (const streaming::ResidentGroup& group : frame.world.residency().groups())
        options.order = std::max(options.order, static_cast<int>(group.order));
    }
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
      const BodyProxies bodies = proxiesOf(frame.world.residency());
      incident_->captures().setProxies(bodies.proxies, frame.counters(), bodies.keys);
    }
    return {};
  }

  void sample(const FrameContext& frame) {
    incident_->update(frame.environment, scene_.groups, scene_.lights, frame.options.wait_for_captures);
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
                        .lamps = scene_.lamps[g],
                        .lamps_apart = scene_.lamps_apart[g],
                        .incident = incidentOf(g, groups[g].light_probes.size()),
                        .key = scene_.groups[g].key,
                        .parted = frame.options.keysApart() && groups[g].volume < 0});
    return places;
  }

  std::vector<lighting::Incident> incidentOf(std::size_t group, std::size_t count) const {
    if (!incident_) return std::vector<lighting::Incident>(count);
    std::vector<lighting::Incident> kept = incident_->incidentOf(group);
    if (fewer_samples_[group].place.empty()) return kept;
    std::vector<lighting::Incident> all;
    for (const std::uint32_t place : fewer_samples_[group].place) all.push_back(kept[place]);
    return all;
  }

  LitScene scene_;
  Incident incident_;  // made once there is something to sample
  GroupLights group_lights_;
  ChangeGate<bool, bool, bool, float, std::uint32_t> carriers_;  // settings that choose carriers
  ChangeGate<std::uint64_t> proxies_;                            // version that the captures have
  int capture_order_ = 0;
  std::vector<lighting::FewerSamples> fewer_samples_;  // per group; empty: all are kept
};

}  // namespace

MadePass makeLightPass(const PassSetup& setup) {
  return std::make_unique<LightPass>(setup.board);
}

}  // namespace lambent::frame
