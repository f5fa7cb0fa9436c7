// The passes of a step, which bring light to where it is needed: first to light probes and patches, then by
// transfer to vertices, samples and grids, and then from body to body by captures.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "runtime/frame/frame_parts.hpp"
#include "runtime/frame/frame_pass.hpp"

namespace lambent::frame {

namespace {

// Records the time from one picture to the next, with the steps between them.
void noticePicture(FrameParts& parts, std::uint64_t most_bytes) {
  const auto now = std::chrono::steady_clock::now();
  if (parts.rendered)
    parts.pacer.frameTook(std::chrono::duration<double, std::milli>(now - *parts.rendered).count(),
                          parts.uploaded_bytes > 0, most_bytes);
  parts.rendered = now;
  parts.uploaded_bytes = 0;
}

// Uploads what has arrived, within a budget of bytes.
Result<void> upload(FrameContext& frame) {
  FrameParts& parts = frame.parts;
  const std::uint64_t most = frame.options.upload_budget_bytes;
  if (frame.view) noticePicture(parts, most);
  Result<void> done =
      frame.world.upload(parts.pacer.budget(most), frame.counters(), parts.pacer.waitSeconds());
  parts.uploaded_bytes += frame.counters().uploaded_bytes;
  frame.log.noticeArrivals(frame.world, frame.counters().uploaded_bytes);
  frame.because();
  frame.count("volumes", frame.world.residency().volumes().size());
  return done;
}

// Updates nodes, rigid groups, materials and the suns of the scene.
Result<void> updateTransforms(FrameContext& frame) {
  frame.world.updateTransforms();
  frame.world.updateMaterials();
  frame.environment.setSuns(sunsOf(frame.world, frame.environment.mostKeys()).discs);
  frame.log.noticeEnvironment(frame.environment);
  frame.log.noticeWorld(frame.world);
  frame.because();
  return {};
}

float meanRadiance(const lighting::Environment& environment) {
  constexpr float kMeanOfBandZero = 0.28209479f;  // y_00
  const glm::vec3 mean = kMeanOfBandZero * environment.light().c[0];
  return std::max({mean.r, mean.g, mean.b, 0.0f});
}

void makePlan(const FrameContext& frame) {
  const FrameSettings& settings = frame.settings();
  LightPlan& plan = frame.parts.plan;
  Neighborhoods& neighborhoods = frame.parts.neighborhoods;
  const std::vector<ecs::Entity> cubes_before = std::move(plan.column_entities);
  const bool by_grids = settings.neighborhoods || neighborhoods.any();
  plan = makeLightPlan(
      frame.world, meanRadiance(frame.environment),
      {.shadowed_lights = settings.local_shadows,
       .column_lights = settings.local_shadows && frame.options.keysApart(),
       .local_radii = frame.options.keysApart() ? settings.local_radii : 0.0f,
       .bodies = settings.captures,
       .most_suns = frame.environment.mostKeys(),
       .cubes_before = cubes_before,
       .grids = by_grids ? neighborhoods.gridsNow(frame.world, settings.neighborhoods) : PlannedGrids{}});
  if (by_grids) neighborhoods.takePairs(plan);
}

Result<void> prepareSampling(const FrameContext& frame) {
  FrameParts& parts = frame.parts;
  if (!parts.incident && !parts.plan.needsSampling()) return {};
  const streaming::Residency& residency = frame.world.residency();
  lighting::CaptureOptions options = frame.settings().capture;
  options.order = std::max(1, parts.capture_order);  // never falls, so that captured light stays valid
  for (const streaming::ResidentGroup& group : residency.groups())
    options.order = std::max(options.order, static_cast<int>(group.order));
  if (!parts.incident) {
    auto made = lighting::IncidentLight::create(options, frame.environment);
    if (!made) return failAgain(made.error());
    parts.incident = std::move(*made);
    parts.proxies_changed.forget();
  } else if (!(options == parts.incident->captures().options())) {
    if (Result<void> done = parts.incident->renew(options, frame.environment); !done) return done;
    parts.proxies_changed.forget();
  }
  parts.capture_order = options.order;
  if (parts.proxies_changed.renew(residency.proxiesVersion())) {
    std::vector<const bundle::CaptureProxy*> proxies;  // in the order of the bodies
    std::vector<std::uint64_t> keys;
    for (const streaming::ResidentGroup& group : residency.groups()) {
      if (!group.proxy) continue;
      proxies.push_back(&*group.proxy);
      keys.push_back(group.id);
    }
    parts.incident->captures().setProxies(proxies, frame.counters(), keys);
  }
  return {};
}

void sampleLight(const FrameContext& frame) {
  lighting::IncidentLight& incident = *frame.parts.incident;
  const LightPlan& plan = frame.parts.plan;
  incident.update(frame.environment, plan.groups, plan.lights, frame.options.wait_for_captures);
  const lighting::IncidentCounts& counts = incident.counts();
  if (counts.arrived > 0) frame.log.note(Cause::Captured, "captures arrived");
  if (counts.fading > 0) frame.log.note(Cause::Captured, "light fades from carrier to carrier");
  frame.count("light_probes", counts.samples);
  frame.count("light_probes_risen", counts.risen);
}

std::vector<lighting::GroupPlace> placesOf(const FrameContext& frame) {
  std::vector<lighting::GroupPlace> places;
  const LightPlan& plan = frame.parts.plan;
  const auto& incident = frame.parts.incident;
  const auto& groups = frame.world.residency().groups();
  for (std::size_t g = 0; g < groups.size(); ++g)
    places.push_back({.world_from_group = frame.world.rotationOf(g),
                      .order = groups[g].order,
                      .lamps = plan.lamps[g],
                      .lamps_apart = plan.lamps_apart[g],
                      .incident = incident ? incident->incidentOf(g)
                                           : std::vector<lighting::Incident>(groups[g].light_probes.size()),
                      .key = plan.groups[g].key,
                      .parted = frame.options.keysApart() && groups[g].volume < 0});
  return places;
}

// Computes the light at the groups' light probes: the environment, lights in the scene, and light between
// bodies.
Result<void> updateLight(FrameContext& frame) {
  FrameParts& parts = frame.parts;
  const FrameSettings& settings = frame.settings();
  // Captures depend on the previous light, so they are drawn anew when the carriers change. Otherwise the
  // result would depend on which carriers were in use before.
  if (parts.carriers_changed.renew(settings.captures, settings.neighborhoods, settings.local_shadows,
                                   settings.local_radii) &&
      parts.incident)
    parts.incident->forget();
  makePlan(frame);
  if (Result<void> done = prepareSampling(frame); !done) return done;
  if (parts.incident) sampleLight(frame);
  parts.group_lights.update(frame.environment, settings.window, placesOf(frame), frame.counters(),
                            static_cast<int>(settings.order));
  if (frame.counters().uploaded_bytes > 0) frame.because("light");
  frame.count("groups", parts.plan.groups.size());
  frame.count("bodies", parts.plan.bodies.size());
  frame.count("local_lights", parts.plan.lights.size());
  frame.count("shadowed_lights", parts.plan.shadowed_lights.size());
  frame.count("shadowed_lights_left_out", parts.plan.local_left_out);
  frame.count("light_probes_written", parts.group_lights.renewedSamples());
  return {};
}

bool patchesDue(const FrameContext& frame) {
  return !frame.parts.plan.shadowed_lights.empty() || !frame.keys().empty() || frame.parts.bounces.any();
}

// Bounces lights among the surfaces, and key lights, by patches.
Result<void> bouncePatches(FrameContext& frame) {
  const FrameSettings& settings = frame.settings();
  PatchBounces& bounces = frame.parts.bounces;
  const bool on = settings.patch_bounces && settings.transfer == evaluate::TransferMode::Full;
  Result<void> done = bounces.update(frame.world, frame.parts.plan,
                                     {.keys = frame.keys(), .bands = &frame.parts.group_lights}, on,
                                     frame.options.wait_for_captures, frame.counters());
  const PatchBounceCounts& counts = bounces.counts();
  frame.count("patch_rooms", counts.rooms);
  frame.count("patch_rooms_to_come", counts.rooms_to_come);
  frame.count("patches", counts.patches);
  frame.count("lights_bounced", counts.lights_bounced);
  frame.count("patch_draws_gathered", counts.draws_gathered);
  if (frame.counters().uploaded_bytes > 0) frame.because("lights that patches send on");
  return done;
}

// --- transfer ---

// Shades the samples that vertices and volumes take, and E/pi at every vertex whose light or transfer
// changed.
Result<void> shadeDiffuse(FrameContext& frame) {
  FrameParts& parts = frame.parts;
  const FrameSettings& settings = frame.settings();
  streaming::Residency& residency = frame.world.residency();
  Result<void> done =
      parts.samples.shade(residency, parts.group_lights, settings.transfer, frame.counters(),
                          {.surfaces = settings.diffuse, .volumes = settings.volumes, .matrices = false});
  if (!done) return done;
  done = parts.diffuse.shade(residency, parts.group_lights, settings.transfer, parts.samples,
                             frame.counters(), settings.diffuse);
  if (frame.counters().dispatches > 0) frame.because("light");
  frame.count("cells_shaded", parts.samples.cellsShadedLast());
  frame.count("draws_shaded", parts.diffuse.drawsShadedLast());
  return done;
}

bool seenSkyDue(const FrameContext& frame) {
  return std::ranges::any_of(frame.world.residency().draws(), &streaming::ResidentDraw::layered);
}

// Computes what the vertices of layered draws see of the sky, when their transfer has arrived.
Result<void> updateSeenSky(FrameContext& frame) {
  Result<void> done =
      frame.parts.seen_sky.update(frame.world.residency(), frame.parts.group_lights, frame.counters());
  if (frame.counters().dispatches > 0) frame.because("transfer arrived");
  return done;
}

bool glossyDue(const FrameContext& frame) {
  return std::ranges::any_of(frame.world.residency().cells(), &streaming::ResidentCell::matrices);
}

// Shades transferred light at the samples of glossy surfaces, of volumes and of grids, if any have matrices.
Result<void> shadeGlossy(FrameContext& frame) {
  const FrameSettings& settings = frame.settings();
  evaluate::Samples& samples = frame.parts.samples;
  Result<void> done =
      samples.shade(frame.world.residency(), frame.parts.group_lights, settings.transfer, frame.counters(),
                    {.surfaces = settings.glossy,
                     .volumes = settings.volumes,
                     .neighborhoods = settings.neighborhoods,
                     .vectors = false});
  if (frame.counters().dispatches > 0) frame.because("light");
  frame.count("cells_shaded", samples.cellsShadedLast());
  return done;
}

bool neighborhoodsDue(const FrameContext& frame) {
  frame.parts.neighborhoods_shown = frame.settings().neighborhoods;
  return frame.parts.neighborhoods_shown && frame.parts.neighborhoods.any();
}

// Updates what bodies with grids change around them. The light pass has chosen which of them act on whom.
Result<void> updateNeighborhoods(FrameContext& frame) {
  FrameParts& parts = frame.parts;
  Result<void> done = parts.neighborhoods.update(frame.world, parts.group_lights, parts.samples,
                                                 frame.settings().transfer, frame.counters());
  if (frame.counters().dispatches > 0 || frame.counters().uploaded_bytes > 0) frame.because("light");
  for (const auto& [name, value] : parts.neighborhoods.counts()) frame.count(name, value);
  return done;
}

Result<void> shadeProxies(const FrameContext& frame) {
  FrameParts& parts = frame.parts;
  std::vector<std::uint64_t> shaded;
  std::vector<effects::diffuse::AddedRadiance> added;
  for (std::size_t g = 0; g < frame.world.residency().groups().size(); ++g) {
    shaded.push_back(parts.samples.allVersionOf(g));
    added.push_back({.triangles = parts.bounces.sentBy(g), .version = parts.bounces.versionOf(g)});
  }
  return parts.proxies.shade(frame.world.residency(), parts.group_lights, shaded, frame.counters(), added);
}

// Returns the bodies with the sums of how their light has changed.
std::vector<lighting::IncidentBody> driftingBodies(FrameParts& parts) {
  const LightPlan& plan = parts.plan;
  const lighting::GroupLights& lights = parts.group_lights;
  std::vector<lighting::IncidentBody> bodies = plan.bodies;
  parts.sent.follow(plan.groups, &lighting::IncidentGroup::key);
  for (std::size_t g = 0; g < plan.groups.size(); ++g) {
    SentLight& sent = parts.sent[g];
    if (std::exchange(sent.version, parts.proxies.versionOf(g)) != parts.proxies.versionOf(g)) {
      const double bounced = parts.bounces.driftOf(g);
      const bool by_light = std::exchange(sent.light, lights.versionOf(g)) != lights.versionOf(g);
      const bool by_bounces = bounced != sent.bounced;
      if (by_light) sent.drift += double{lights.changeOf(g)};
      if (by_bounces) sent.drift += std::min(std::abs(bounced - sent.bounced), 1.0);
      // The group was shaded for another reason than light or a turn, so everything may differ.
      if (!by_light && !by_bounces) sent.drift += 1.0;
      sent.bounced = bounced;
    }
    if (const std::uint32_t body = plan.groups[g].body; body != lighting::CapturePoint::kNoBody)
      bodies[body].radiance_drift = sent.drift;
  }
  return bodies;
}

// Returns how many captures may be drawn. In the step in which bundles arrived or were removed there are
// none, because that step is costly already; they begin with the next one. Without a view nobody waits for a
// picture, so all are drawn at once.
std::size_t mostCaptures(const FrameContext& frame) {
  FrameParts& parts = frame.parts;
  const bool changed = parts.structure_changed.renew(frame.world.residency().structureVersion());
  parts.waited = changed && !parts.waited && frame.view;
  if (parts.waited) return 0;
  return frame.view ? frame.settings().captures_per_step : std::numeric_limits<std::size_t>::max();
}

// Updates the light between bodies: shades their capture proxies, and captures the surroundings of light
// probes where these have changed. The result arrives with the next step.
Result<void> capture(FrameContext& frame) {
  auto& incident = frame.parts.incident;
  if (!incident) return {};
  if (Result<void> done = shadeProxies(frame); !done) return done;
  const LightPlan& plan = frame.parts.plan;
  Result<void> done =
      incident->capture(frame.environment, {plan.groups, driftingBodies(frame.parts), plan.lights},
                        frame.parts.proxies.radiance(), mostCaptures(frame), frame.counters());
  const lighting::IncidentCounts& counts = incident->counts();
  frame.count("light_probes_captured", counts.captured);
  frame.count("light_probes_waiting", counts.waiting);
  if (counts.captured > 0) frame.count("capture_bodies_drawn", incident->captures().load().draws);
  if (frame.counters().dispatches > 0) frame.because("light between bodies");
  return done;
}

constexpr FramePass kStepPasses[] = {{"upload", causes(Cause::Arrived), upload},
                                     {"transforms", Cause::Moved | Cause::Materials, updateTransforms},
                                     {"light", kLightCauses, updateLight},
                                     {"patch bounces", kLightCauses, bouncePatches, patchesDue},
                                     {"shade", kLightCauses, shadeDiffuse},
                                     {"seen sky", 0, updateSeenSky, seenSkyDue},
                                     {"glossy", kLightCauses, shadeGlossy, glossyDue},
                                     {"neighborhood", kLightCauses, updateNeighborhoods, neighborhoodsDue},
                                     {"capture", kLightCauses, capture}};

}  // namespace

std::span<const FramePass> stepPasses() {
  return kStepPasses;
}

}  // namespace lambent::frame
