// What arrives at the groups' light probes in Frame's steps, and what bodies send to each other.
#include <algorithm>
#include <cmath>
#include <utility>

#include "runtime/frame/frame.hpp"
#include "runtime/shadows/apart_shadows.hpp"

namespace lambent::frame {

namespace {

float meanRadiance(const lighting::Environment& environment) {
  constexpr float kMeanOfBandZero = 0.28209479f;  // y_00
  const glm::vec3 mean = kMeanOfBandZero * environment.light().c[0];
  return std::max({mean.r, mean.g, mean.b, 0.0f});
}

}  // namespace

Result<void> Frame::prepareSampling(World& world, const lighting::Environment& environment,
                                    gpu::Counters& counters) {
  if (!incident_ && !lit_scene_.needsSampling()) return {};
  lighting::CaptureOptions options = options_.settings.capture;
  if (options.order == 0) {
    options.order = std::max(1, capture_order_);  // never fewer again: light that was captured stays
    for (const streaming::ResidentGroup& group : world.residency().groups())
      options.order = std::max(options.order, static_cast<int>(group.order));
  }
  if (!incident_) {
    auto made = lighting::IncidentLight::create(options, environment);
    if (!made) return failAgain(made.error());
    incident_ = std::move(*made);
    proxies_seen_ = 0;
  } else if (!(options == incident_->captures().options())) {
    if (Result<void> done = incident_->renew(options, environment); !done) return done;
    proxies_seen_ = 0;
  }
  capture_order_ = options.order;
  if (proxies_seen_ != world.residency().proxiesVersion()) {
    proxies_seen_ = world.residency().proxiesVersion();
    const BodyProxies bodies = proxiesOf(world.residency());
    incident_->captures().setProxies(bodies.proxies, counters, bodies.keys);
  }
  return {};
}

Result<void> Frame::light(World& world, const lighting::Environment& environment) {
  gpu::PassTimers::Scope pass(timers_, "light");
  const FrameSettings& settings = options_.settings;
  lit_scene_ = gatherLitScene(world, meanRadiance(environment),
                              {.shadowed_lights = settings.local_shadows,
                               .local_radii = keysApart() ? settings.local_radii : 0.0f,
                               .bodies = settings.captures});
  if (settings.neighborhoods || neighborhoods_.any())
    neighborhoods_.chooseCarriers(world, lit_scene_, settings.neighborhoods);
  keepFewerSamples(world);
  hideApart(lit_scene_, proxiesOf(world.residency()).proxies);
  if (Result<void> done = prepareSampling(world, environment, pass.counters()); !done) return done;
  if (incident_) {
    incident_->update(environment, lit_scene_.groups, lit_scene_.lights, options_.wait_for_captures);
    counts_.incident = incident_->counts();
    if (counts_.incident.arrived > 0) invalidation_log_.note(Cause::Captured, "captures arrived");
    if (counts_.incident.fading > 0)
      invalidation_log_.note(Cause::Captured, "light fades from carrier to carrier");
  }
  std::vector<lighting::GroupPlace> places;
  for (std::size_t g = 0; g < world.residency().groups().size(); ++g) {
    const streaming::ResidentGroup& group = world.residency().groups()[g];
    places.push_back({.world_from_group = world.rotationOf(g),
                      .order = group.order,
                      .lamps = lit_scene_.lamps[g],
                      .incident = incidentOf(world, g),
                      .key = lit_scene_.groups[g].key,
                      .parted = keysApart() && group.volume < 0});
  }
  group_lights_.update(environment, settings.window, places, pass.counters(),
                       static_cast<int>(settings.order));
  if (pass.counters().uploaded_bytes > 0) pass.because(invalidation_log_.of(kLightCauses, "light"));
  counts_.groups = static_cast<std::uint32_t>(places.size());
  counts_.bodies = static_cast<std::uint32_t>(lit_scene_.bodies.size());
  counts_.local_lights = static_cast<std::uint32_t>(lit_scene_.lights.size());
  counts_.shadowed_lights = static_cast<std::uint32_t>(lit_scene_.shadowed_lights.size());
  counts_.shadowed_lights_left_out = lit_scene_.local_left_out;
  counts_.light_probes_written = group_lights_.renewedSamples();
  return {};
}

Result<void> Frame::bounce(World& world, const lighting::Environment& environment) {
  const std::span<const spec::Disc> keys = keysApart() ? environment.keys() : std::span<const spec::Disc>();
  if (lit_scene_.shadowed_lights.empty() && keys.empty() && !patch_bounces_.any()) return {};
  gpu::PassTimers::Scope pass(timers_, "patch bounces");
  const FrameSettings& settings = options_.settings;
  const bool on = settings.patch_bounces && settings.transfer == effects::diffuse::TransferMode::Full;
  Result<void> done = patch_bounces_.update(world, lit_scene_, {.keys = keys, .bands = &group_lights_}, on,
                                            options_.wait_for_captures, pass.counters());
  counts_.patch_bounces = patch_bounces_.counts();
  if (pass.counters().uploaded_bytes > 0)
    pass.because(invalidation_log_.of(kLightCauses, "lights that patches send on"));
  return done;
}

// Others of a group's samples take the light of those.
void Frame::keepFewerSamples(const World& world) {
  const auto& groups = world.residency().groups();
  fewer_samples_.assign(groups.size(), {});
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (groups[g].light_probes.size() <= options_.settings.light_probes) continue;
    fewer_samples_[g] = fewerSamples(groups[g].light_probes, options_.settings.light_probes);
    std::vector<glm::vec3> kept;
    for (const std::uint32_t sample : fewer_samples_[g].kept)
      kept.push_back(lit_scene_.groups[g].samples_ws[sample]);
    lit_scene_.groups[g].samples_ws = std::move(kept);
  }
}

std::vector<lighting::Incident> Frame::incidentOf(const World& world, std::size_t group) const {
  const std::size_t count = world.residency().groups()[group].light_probes.size();
  if (!incident_) return std::vector<lighting::Incident>(count);
  std::vector<lighting::Incident> kept = incident_->incidentOf(group);
  if (fewer_samples_[group].place.empty()) return kept;
  std::vector<lighting::Incident> all;
  for (const std::uint32_t place : fewer_samples_[group].place) all.push_back(kept[place]);
  return all;
}

Result<void> Frame::capture(World& world, const lighting::Environment& environment,
                            std::size_t max_captures) {
  gpu::PassTimers::Scope pass(timers_, "capture");
  if (!incident_) return {};
  std::vector<std::uint64_t> shaded;
  for (std::size_t g = 0; g < world.residency().groups().size(); ++g)
    shaded.push_back(diffuse_.versionOf(g) + glossy_.versionOf(g));
  std::vector<effects::diffuse::AddedRadiance> added;
  for (std::size_t g = 0; g < shaded.size(); ++g)
    added.push_back({.triangles = patch_bounces_.sentBy(g), .version = patch_bounces_.versionOf(g)});
  if (Result<void> done = proxies_.shade(world.residency(), group_lights_, shaded, pass.counters(), added);
      !done)
    return done;
  proxy_radiance_.follow(lit_scene_.groups, &lighting::IncidentGroup::key);
  for (std::size_t g = 0; g < lit_scene_.groups.size(); ++g) {
    ProxyRadiance& radiance = proxy_radiance_[g];
    if (radiance.version != proxies_.versionOf(g)) {
      radiance.version = proxies_.versionOf(g);
      // Shaded for another reason than light or a turn: all of it may be different.
      const bool by_light = group_lights_.versionOf(g) != radiance.light;
      const double lamps = patch_bounces_.driftOf(g);
      const bool by_lamps = lamps != radiance.lamps;
      radiance.light = group_lights_.versionOf(g);
      if (by_light) radiance.drift += double{group_lights_.changeOf(g)};
      if (by_lamps) radiance.drift += std::min(std::abs(lamps - radiance.lamps), 1.0);
      if (!by_light && !by_lamps) radiance.drift += 1.0;
      radiance.lamps = lamps;
    }
    if (const std::uint32_t body = lit_scene_.groups[g].body; body != lighting::CapturePoint::kNoBody)
      lit_scene_.bodies[body].radiance_drift = radiance.drift;
  }
  // What came or went has its price in this step. Captures that it asks for begin with the next one, unless
  // everything is asked for at once.
  const std::uint64_t structure = world.residency().structureVersion();
  const bool changed = std::exchange(structure_captured_, structure) != structure;
  captures_waited_ = changed && !captures_waited_ && max_captures != kAllCaptures;
  if (captures_waited_) max_captures = 0;
  Result<void> done = incident_->capture(environment, lit_scene_.groups, lit_scene_.bodies, lit_scene_.lights,
                                         proxies_.radiance(), max_captures, pass.counters());
  counts_.incident.captured = incident_->counts().captured;
  counts_.incident.waiting = incident_->counts().waiting;
  if (counts_.incident.captured > 0) counts_.captured = incident_->captures().load();
  if (pass.counters().dispatches > 0)
    pass.because(invalidation_log_.of(kLightCauses, "light between bodies"));
  return done;
}

}  // namespace lambent::frame
