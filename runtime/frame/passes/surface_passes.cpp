// The passes that draw surfaces, into reflection probes and into the picture, and prepare what these look up
// per pixel: the sky, and shadow maps.
#include <algorithm>
#include <utility>
#include <vector>

#include <epoxy/gl.h>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>

#include "runtime/frame/frame_parts.hpp"
#include "runtime/frame/frame_pass.hpp"
#include "runtime/scene/bounds.hpp"

namespace lambent::frame {

namespace {

using lighting::PrefilteredEnvironment;

bool skyDue(const FrameContext& frame) {
  return !frame.parts.sky.upToDate(frame.environment);
}

// Updates the sky, as it is seen behind all surfaces.
Result<void> updateSky(FrameContext& frame) {
  frame.parts.sky.update(frame.environment);
  frame.because();
  return {};
}

bool prefilteredEnvironmentDue(const FrameContext& frame) {
  const FrameSettings& settings = frame.settings();
  frame.parts.prefiltered_shown = settings.residual;
  if (!settings.residual || !settings.glossy) return false;
  if (frame.parts.prefiltered_from.holds(PrefilteredEnvironment::sourceVersion(frame.environment)))
    return false;
  // Matrices may belong to neighborhoods or volumes alone, which do not show it.
  return std::ranges::any_of(frame.world.residency().draws(), [](const streaming::ResidentDraw& draw) {
    return draw.glossy() || draw.layered;
  });
}

// Prefilters the environment once for each set of lights, when there is a glossy surface to show it.
Result<void> prefilterEnvironment(FrameContext& frame) {
  Result<PrefilteredEnvironment> made =
      PrefilteredEnvironment::make(frame.environment, frame.parts.sky, frame.counters());
  if (!made) return failAgain(made.error());
  frame.parts.prefiltered = std::move(*made);
  frame.parts.prefiltered_from.renew(PrefilteredEnvironment::sourceVersion(frame.environment));
  frame.because("first needed");
  return {};
}

// Draws the shadow cubes of local lights, for direct light per pixel.
Result<void> drawLocalShadows(FrameContext& frame) {
  const LightPlan& plan = frame.parts.plan;
  LocalShadows& shadows = frame.parts.local_shadows;
  Result<void> done =
      shadows.update(frame.world, plan.shadowed_lights, plan.pixel_masks, frame.counters(), plan.own_lamps);
  if (shadows.cubesDrawn() > 0) frame.because("lights among surfaces");
  frame.count("shadow_cubes_drawn", shadows.cubesDrawn());
  return done;
}

bool keyShadowsDue(const FrameContext& frame) {
  return !frame.environment.keys().empty() || frame.parts.key_shadows.any();
}

// Draws the shadow maps of key lights over the visible area.
Result<void> drawKeyShadows(FrameContext& frame) {
  const FrameSettings& settings = frame.settings();
  KeyShadows& shadows = frame.parts.key_shadows;
  Result<void> done =
      shadows.update(frame.world, frame.keys(), *frame.view,
                     {.finest = settings.key_size, .samples = settings.key_samples}, frame.counters());
  if (shadows.mapsDrawn() > 0) frame.because();
  frame.count("key_lights", frame.environment.keys().size());
  frame.count("key_maps_drawn", shadows.mapsDrawn());
  return done;
}

// Prepares surfaces for a view, as the settings of the frame say.
Result<void> prepareSurfaces(FrameContext& frame, const spec::View& view, SurfaceView shown) {
  FrameParts& parts = frame.parts;
  const FrameSettings& settings = frame.settings();
  if (parts.prefiltered && settings.residual) {
    std::uint32_t order = 1;
    for (const streaming::ResidentGroup& group : frame.world.residency().groups())
      order = std::max(order, group.order);
    order = std::min(order, settings.order);
    parts.prefiltered->update(frame.environment, static_cast<int>(order), settings.window, frame.counters());
  }
  return parts.surfaces.prepare(frame.world, parts.diffuse, parts.seen_sky, view,
                                {.diffuse = settings.diffuse,
                                 .glossy = settings.glossy,
                                 .glossy_bands = settings.glossy_order,
                                 .view = shown},
                                frame.counters());
}

// --- reflection probes ---
//
// Captures rooms as the mirrors in them show them, again only when light or scene changed. Rooms without
// mirrors cost nothing.

// Shadows of key lights in captures are coarser than in pictures.
constexpr std::uint32_t kKeySize = 2048, kKeySamples = 12;
constexpr float kNearShare = 1e-3f;  // of the world's extent

bool mirrors(const World& world, const streaming::ResidentDraw& draw, std::size_t index) {
  if (draw.layered) return true;
  if (!draw.glossy()) return false;
  // Brushed metals show fans of lobes, and measured ones have no lobe.
  const std::int32_t table = brdfTableOf(world, index);
  const auto& families = world.residency().bundles()[draw.bundle].brdf_families;
  return table >= 0 && families[static_cast<std::size_t>(table)] == bundle::BrdfFamily::Ggx;
}

std::uint32_t probesWanted(const FrameContext& frame) {
  const FrameSettings& settings = frame.settings();
  return settings.glossy && settings.residual ? settings.reflection_probes : 0;
}

// Returns whether the middle of the group lies in the room.
bool isIn(const World& world, std::size_t room, std::size_t group) {
  if (room == group) return true;
  const scene::Box &bounds = world.groupBounds(room), &other = world.groupBounds(group);
  if (other.empty()) return false;
  const glm::vec3 middle = glm::inverse(world.worldFromGroup(room)) * world.worldFromGroup(group) *
                           glm::vec4(other.center(), 1.0f);
  return glm::all(glm::greaterThanEqual(middle, bounds.min)) &&
         glm::all(glm::lessThanEqual(middle, bounds.max));
}

// Chooses the places in each group that has mirrors in it, once its meshes have arrived.
Result<void> choosePlaces(const FrameContext& frame) {
  World& world = frame.world;
  Rooms& rooms = frame.parts.rooms;
  const streaming::Residency& residency = world.residency();
  rooms.places.assign(residency.groups().size(), {});
  if (probesWanted(frame) == 0) return {};
  for (std::size_t group = 0; group < rooms.places.size(); ++group) {
    if (world.groupBounds(group).empty() || residency.groups()[group].volume >= 0) continue;
    bool arrived = true, any = false;
    for (std::size_t i = 0; i < residency.draws().size(); ++i) {
      const streaming::ResidentDraw& draw = residency.draws()[i];
      if (draw.group == group) arrived &= bool(residency.meshes()[draw.mesh].block);
      any |= mirrors(world, draw, i) && isIn(world, group, draw.group);
    }
    if (!arrived || !any) continue;
    const Result<lighting::SurfaceVoxels> voxels =
        frame.parts.probes.voxelsOf(world, group, frame.counters());
    if (!voxels) return failAgain(voxels.error());
    rooms.places[group] = lighting::chooseProbePlaces(*voxels, probesWanted(frame));
  }
  return {};
}

Result<void> findRooms(const FrameContext& frame) {
  const World& world = frame.world;
  Rooms& rooms = frame.parts.rooms;
  const streaming::Residency& residency = world.residency();
  const std::uint32_t wanted = probesWanted(frame);
  if (!rooms.found_from.renew(residency.version(), world.transformsVersion(), world.materialsVersion(),
                              wanted))
    return {};
  const auto meshes = static_cast<std::size_t>(
      std::ranges::count_if(residency.meshes(), [](const auto& mesh) { return bool(mesh.block); }));
  if (rooms.places_from.renew(residency.structureVersion(), meshes, wanted))
    if (Result<void> done = choosePlaces(frame); !done) return done;
  std::vector<glm::vec3> places_ws;
  std::vector<std::uint8_t> shown(residency.draws().size(), 0);
  for (std::size_t room = 0; room < rooms.places.size(); ++room) {
    if (rooms.places[room].empty()) continue;
    bool any = false;
    for (std::size_t i = 0; i < shown.size(); ++i) {
      const streaming::ResidentDraw& draw = residency.draws()[i];
      if (!mirrors(world, draw, i) || !isIn(world, room, draw.group)) continue;
      shown[i] = 1;
      any = true;
    }
    if (!any) continue;
    for (const glm::vec3& place : rooms.places[room])
      places_ws.emplace_back(world.worldFromGroup(room) * glm::vec4(place, 1.0f));
  }
  frame.parts.probes.place(std::move(places_ws));
  frame.parts.probes.showBy(std::move(shown));
  rooms.stale.assign(frame.parts.probes.places().size(), 1);
  return {};
}

// Returns the versions of all that a capture shows.
std::vector<std::uint64_t> versionsOf(const FrameContext& frame) {
  const World& world = frame.world;
  const FrameParts& parts = frame.parts;
  std::vector<std::uint64_t> versions = {frame.environment.version(),
                                         world.residency().version(),
                                         world.transformsVersion(),
                                         world.lampsVersion(),
                                         world.materialsVersion(),
                                         parts.neighborhoods.version(),
                                         parts.seen_sky.version(),
                                         parts.local_shadows.version(),
                                         parts.prefiltered ? std::uint64_t{1} : std::uint64_t{0}};
  for (std::size_t g = 0; g < world.residency().groups().size(); ++g)
    for (const std::uint64_t version :
         {parts.samples.vectorsVersionOf(g), parts.samples.matricesVersionOf(g), parts.bounces.versionOf(g)})
      versions.push_back(version);
  return versions;
}

// Returns a view in which shadow maps cover the whole world.
spec::View viewOfAll(const scene::Box& bounds) {
  const float radius = bounds.radius();
  return {.view_from_world = glm::translate(glm::mat4(1.0f), -bounds.center()),
          .clip_from_view = glm::ortho(-radius, radius, -radius, radius, -radius, radius),
          .eye_ws = bounds.center()};
}

Result<void> captureProbe(FrameContext& frame, std::size_t probe) {
  const scene::Box bounds = scene::worldBounds(frame.world.registry());
  const float extent = 2.0f * bounds.radius();
  KeyShadows& keys = frame.parts.rooms.keys;
  if (Result<void> done = keys.update(frame.world, frame.keys(), viewOfAll(bounds),
                                      {.finest = std::min(frame.settings().key_size, kKeySize),
                                       .samples = std::min(frame.settings().key_samples, kKeySamples)},
                                      frame.counters());
      !done)
    return done;
  const auto draw = [&](const spec::View& view, const spec::Size& size) -> Result<void> {
    if (Result<void> done = prepareSurfaces(frame, view, SurfaceView::Final); !done) return done;
    frame.parts.local_shadows.bind(view, size);
    keys.bind(view, size);
    frame.parts.surfaces.drawOpaque(frame.world, frame.counters());
    frame.parts.surfaces.drawBlended(frame.world, frame.counters());
    return {};
  };
  return frame.parts.probes.capture(probe, kNearShare * extent, 2.0f * extent, draw, frame.counters());
}

bool reflectionProbesDue(const FrameContext& frame) {
  return !frame.parts.probes.places().empty() ||
         (probesWanted(frame) > 0 &&
          std::ranges::any_of(frame.world.residency().draws(),
                              [](const auto& draw) { return draw.layered || draw.glossy(); }));
}

Result<void> captureProbes(FrameContext& frame) {
  if (Result<void> done = findRooms(frame); !done) return done;
  Rooms& rooms = frame.parts.rooms;
  frame.count("reflection_probes", frame.parts.probes.places().size());
  if (frame.parts.probes.places().empty()) return {};
  if (rooms.captured_from.renew(versionsOf(frame), frame.settings()))
    std::ranges::fill(rooms.stale, std::uint8_t{1});
  std::uint32_t captured = 0;
  const std::uint32_t most = frame.options.wait_for_captures ? kMostProbes : 1;
  // The probes take turns, so that none waits forever while light keeps changing.
  for (std::size_t i = 0; i < rooms.stale.size() && captured < most; ++i) {
    rooms.next = (rooms.next + 1) % rooms.stale.size();
    if (std::exchange(rooms.stale[rooms.next], std::uint8_t{0}) == 0) continue;
    if (Result<void> done = captureProbe(frame, rooms.next); !done) return done;
    ++captured;
  }
  frame.count("reflection_probes_captured", captured);
  if (captured > 0) frame.because("probes wait");
  return {};
}

// --- the picture ---

void clearTargets(const FrameContext& frame) {
  // Pictures of numbers and directions have a dark grey behind them that no value has.
  constexpr float kGrey = 0.012f;
  frame.targets.bindCleared(showsLight(frame.options.view.view) || frame.options.linear() ? 0.0f : kGrey);
}

Result<void> drawNumbers(FrameContext& frame) {
  auto& data_view = frame.parts.data_view;
  if (!data_view) data_view.emplace(/*numbers=*/frame.options.linear());
  if (Result<void> done = data_view->update(frame.world, frame.parts.group_lights, frame.options.view,
                                            frame.settings().transfer, frame.counters());
      !done)
    return done;
  clearTargets(frame);
  return data_view->draw(frame.world, *frame.view, frame.counters());
}

Result<void> drawLight(FrameContext& frame) {
  FrameParts& parts = frame.parts;
  const spec::View& view = *frame.view;
  const SurfaceView shown = frame.options.view.view;
  parts.local_shadows.bind(view, frame.targets.size());
  parts.key_shadows.bind(view, frame.targets.size());
  clearTargets(frame);
  parts.surfaces.drawOpaque(frame.world, frame.counters());
  if (shown == SurfaceView::Final || shown == SurfaceView::Wireframe) {
    if (Result<void> done = parts.proxy_lods.prepare(frame.world, frame.environment, parts.plan.lights,
                                                     {.order = frame.settings().order,
                                                      .window = frame.settings().window,
                                                      .diffuse = frame.settings().diffuse},
                                                     frame.counters());
        !done)
      return done;
    if (Result<void> done = parts.proxy_lods.draw(view, frame.counters()); !done) return done;
  }
  if (showsLight(shown) && frame.options.show_sky) {
    parts.sky.draw(frame.environment, view.view_from_world, view.clip_from_view, frame.targets.size().height,
                   frame.counters());
    glDepthFunc(GL_LESS);
  }
  parts.surfaces.drawBlended(frame.world, frame.counters());
  return {};
}

// Draws surfaces, proxies of bundles that are not resident, the sky and blended surfaces, as linear radiance.
// In views of transfer it draws numbers instead of light.
Result<void> raster(FrameContext& frame) {
  frame.because();
  // Surfaces are prepared even if numbers are drawn, because picking reads them.
  const SurfaceView shown = frame.options.view.view;
  if (Result<void> done = prepareSurfaces(frame, *frame.view, shown); !done) return done;
  if (showsTransfer(shown)) return drawNumbers(frame);
  frame.count("draws_out_of_view", frame.parts.surfaces.countOutOfView());
  frame.parts.data_view.reset();
  return drawLight(frame);
}

constexpr FramePass kSurfacePasses[] = {
    {"sky", causes(Cause::Environment), updateSky, skyDue},
    {"shadows", kLightCauses | Cause::Materials, drawLocalShadows},
    {"key shadows", kPictureCauses, drawKeyShadows, keyShadowsDue},
    {"specular environment", causes(Cause::Environment), prefilterEnvironment, prefilteredEnvironmentDue},
    {"reflection probes", kLightCauses | Cause::Materials, captureProbes, reflectionProbesDue},
    {"raster", kPictureCauses, raster}};

}  // namespace

std::span<const FramePass> surfacePasses() {
  return kSurfacePasses;
}

}  // namespace lambent::frame
