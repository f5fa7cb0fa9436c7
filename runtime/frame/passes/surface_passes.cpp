// The passes that draw surfaces: into reflection probes, and into the picture.
#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>

#include "runtime/base/change_gate.hpp"
#include "runtime/bounces/patch_bounces.hpp"
#include "runtime/debug/data_view.hpp"
#include "runtime/effects/diffuse/diffuse.hpp"
#include "runtime/evaluate/samples.hpp"
#include "runtime/evaluate/seen_sky.hpp"
#include "runtime/frame/frame_pass.hpp"
#include "runtime/frame/pass_list.hpp"
#include "runtime/lighting/prefiltered_environment.hpp"
#include "runtime/lighting/sky.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/shadows/key_shadows.hpp"
#include "runtime/shadows/lit_scene.hpp"
#include "runtime/shadows/local_shadows.hpp"
#include "runtime/surface/light_modules.hpp"
#include "runtime/surface/neighborhoods.hpp"
#include "runtime/surface/proxy_lods.hpp"
#include "runtime/surface/reflection_probes.hpp"
#include "runtime/surface/surfaces.hpp"

namespace lambent::frame {

namespace {

// Prepares surfaces for a view, as the settings of the frame say. The pass must read World, Diffuse and
// SeenSky, and write the prefiltered environment.
Result<void> prepareSurfaces(FrameContext& frame, Surfaces& surfaces, const SurfaceModules& modules,
                             const spec::View& view, SurfaceView shown) {
  surfaces.setView(shown);
  const FrameSettings& settings = frame.settings();
  auto& prefiltered = frame.write<std::optional<lighting::PrefilteredEnvironment>>();
  if (prefiltered && settings.residual) {
    std::uint32_t order = 1;
    for (const streaming::ResidentGroup& group : frame.world.residency().groups())
      order = std::max(order, group.order);
    order = std::min(order, settings.order);
    prefiltered->update(frame.environment, static_cast<int>(order), settings.window, frame.counters());
  }
  return surfaces.prepare(frame.world, frame.read<effects::diffuse::Diffuse>(), view,
                          {.options = {.diffuse = settings.diffuse,
                                       .glossy = settings.glossy,
                                       .glossy_bands = settings.glossy_order},
                           .seen_sky = &frame.read<evaluate::SeenSky>(),
                           .modules = modules},
                          frame.counters());
}

// --- reflection probes ---
//
// Captures rooms as the mirrors in them show them, again only when light or scene changed. Rooms are rigid
// groups that hide most of the sky and have mirrors in them; others cost nothing.

using effects::diffuse::Diffuse;
using Prefiltered = std::optional<lighting::PrefilteredEnvironment>;

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

class ReflectionProbesPass final : public FramePass {
 public:
  ReflectionProbesPass(SurfaceVoxelizer voxelizer, ReflectionProbes probes, Blackboard& board)
      : FramePass({.name = "reflection probes",
                   .reads = resources<World, Diffuse, evaluate::Samples, PatchBounces, Neighborhoods,
                                      evaluate::SeenSky, Prefiltered, LocalShadows>(),
                   .writes = resources<ReflectionProbes, Surfaces, Prefiltered>(),
                   .causes = kLightCauses | Cause::Materials,
                   .counts = {"reflection_probes", "reflection_probes_captured"}}),
        voxelizer_(std::move(voxelizer)),
        probes_(std::move(probes)),
        modules_(board.get<SurfaceModules>()),
        module_(probes_, board.get<SpecularEnvironmentModule>()) {
    board.offer(probes_);
    board.get<SurfaceModules>().push_back(&module_);
  }

  bool due(const FrameContext& frame) override {
    return !probes_.places().empty() || (wanted(frame) > 0 && anyMirror(frame.world));
  }

  Result<void> update(FrameContext& frame) override {
    findRooms(frame);
    frame.count("reflection_probes", probes_.places().size());
    if (probes_.places().empty()) return {};
    if (seen_.renew(versionsOf(frame), frame.settings())) std::ranges::fill(stale_, std::uint8_t{1});
    std::uint32_t captured = 0;
    const std::uint32_t most = frame.options.wait_for_captures ? kMostProbes : 1;
    // The probes take turns, so that none waits forever while light keeps changing.
    for (std::size_t i = 0; i < stale_.size() && captured < most; ++i) {
      next_ = (next_ + 1) % stale_.size();
      if (std::exchange(stale_[next_], std::uint8_t{0}) == 0) continue;
      if (Result<void> done = capture(frame, next_); !done) return done;
      ++captured;
    }
    frame.count("reflection_probes_captured", captured);
    if (captured > 0) frame.because("probes wait");
    return {};
  }
  void forget() override { seen_.forget(); }

 private:
  static std::uint32_t wanted(const FrameContext& frame) {
    const FrameSettings& settings = frame.settings();
    return settings.glossy && settings.residual ? settings.reflection_probes : 0;
  }
  static bool anyMirror(const World& world) {
    const auto& draws = world.residency().draws();
    return std::ranges::any_of(draws, [](const auto& draw) { return draw.layered || draw.glossy(); });
  }

  // Returns whether the middle of the group lies in the room.
  static bool isIn(const World& world, std::size_t room, std::size_t group) {
    if (room == group) return true;
    const scene::Box &bounds = world.groupBounds(room), &other = world.groupBounds(group);
    if (other.empty()) return false;
    const glm::vec3 middle = glm::inverse(world.worldFromGroup(room)) * world.worldFromGroup(group) *
                             glm::vec4(other.center(), 1.0f);
    return glm::all(glm::greaterThanEqual(middle, bounds.min)) &&
           glm::all(glm::lessThanEqual(middle, bounds.max));
  }

  static std::size_t meshesOf(const streaming::Residency& residency) {
    return static_cast<std::size_t>(
        std::ranges::count_if(residency.meshes(), [](const auto& mesh) { return bool(mesh.block); }));
  }

  // Chooses the places in each group that has mirrors in it, once its meshes have arrived.
  void choosePlaces(const FrameContext& frame) {
    World& world = frame.world;
    const streaming::Residency& residency = world.residency();
    places_.assign(residency.groups().size(), {});
    if (wanted(frame) == 0) return;
    for (std::size_t group = 0; group < places_.size(); ++group) {
      if (world.groupBounds(group).empty() || residency.groups()[group].volume >= 0) continue;
      bool arrived = true, any = false;
      for (std::size_t i = 0; i < residency.draws().size(); ++i) {
        const streaming::ResidentDraw& draw = residency.draws()[i];
        if (draw.group == group) arrived &= bool(residency.meshes()[draw.mesh].block);
        any |= mirrors(world, draw, i) && isIn(world, group, draw.group);
      }
      if (arrived && any)
        places_[group] =
            lighting::chooseProbePlaces(voxelizer_.voxelsOf(world, group, frame.counters()), wanted(frame));
    }
  }

  void findRooms(const FrameContext& frame) {
    const World& world = frame.world;
    const streaming::Residency& residency = world.residency();
    if (!rooms_from_.renew(residency.version(), world.transformsVersion(), world.materialsVersion(),
                           wanted(frame)))
      return;
    if (meshes_from_.renew(residency.structureVersion(), meshesOf(residency), wanted(frame)))
      choosePlaces(frame);
    std::vector<glm::vec3> places_ws;
    std::vector<std::uint8_t> shown(residency.draws().size(), 0);
    for (std::size_t room = 0; room < places_.size(); ++room) {
      if (places_[room].empty()) continue;
      bool any = false;
      for (std::size_t i = 0; i < shown.size(); ++i) {
        const streaming::ResidentDraw& draw = residency.draws()[i];
        if (!mirrors(world, draw, i) || !isIn(world, room, draw.group)) continue;
        shown[i] = 1;
        any = true;
      }
      if (!any) continue;
      for (const glm::vec3& place : places_[room])
        places_ws.emplace_back(world.worldFromGroup(room) * glm::vec4(place, 1.0f));
    }
    probes_.place(std::move(places_ws));
    probes_.showBy(std::move(shown));
    stale_.assign(probes_.places().size(), 1);
  }

  // Returns the versions of all that a capture shows.
  static std::vector<std::uint64_t> versionsOf(const FrameContext& frame) {
    const World& world = frame.world;
    const bool prefiltered = frame.read<Prefiltered>().has_value();
    std::vector<std::uint64_t> versions = {frame.environment.version(),
                                           world.residency().version(),
                                           world.transformsVersion(),
                                           world.lampsVersion(),
                                           world.materialsVersion(),
                                           frame.read<Neighborhoods>().version(),
                                           frame.read<evaluate::SeenSky>().version(),
                                           frame.read<LocalShadows>().version(),
                                           prefiltered ? std::uint64_t{1} : std::uint64_t{0}};
    for (std::size_t g = 0; g < world.residency().groups().size(); ++g)
      for (const std::uint64_t version :
           {frame.read<evaluate::Samples>().vectorsVersionOf(g),
            frame.read<evaluate::Samples>().matricesVersionOf(g), frame.read<PatchBounces>().versionOf(g)})
        versions.push_back(version);
    return versions;
  }

  Result<void> capture(FrameContext& frame, std::size_t probe) {
    const scene::Box bounds = scene::worldBounds(frame.world.registry());
    const float extent = 2.0f * bounds.radius();
    if (Result<void> done = keys_.update(frame.world, frame.keys(), viewOfAll(bounds),
                                         {.finest = std::min(frame.settings().key_size, kKeySize),
                                          .samples = std::min(frame.settings().key_samples, kKeySamples)},
                                         frame.counters());
        !done)
      return done;
    auto& surfaces = frame.write<Surfaces>();
    const auto draw = [&](const spec::View& view, const spec::Size& size) -> Result<void> {
      if (Result<void> done = prepareSurfaces(frame, surfaces, modules_, view, SurfaceView::Final); !done)
        return done;
      frame.read<LocalShadows>().bind(view, size);
      keys_.bind(view, size);
      surfaces.drawOpaque(frame.world, frame.counters());
      surfaces.drawBlended(frame.world, frame.counters());
      return {};
    };
    return probes_.capture(probe, kNearShare * extent, 2.0f * extent, draw, frame.counters());
  }

  // Returns a view in which shadow maps cover the whole world.
  static spec::View viewOfAll(const scene::Box& bounds) {
    const float radius = bounds.radius();
    return {.view_from_world = glm::translate(glm::mat4(1.0f), -bounds.center()),
            .clip_from_view = glm::ortho(-radius, radius, -radius, radius, -radius, radius),
            .eye_ws = bounds.center()};
  }

  SurfaceVoxelizer voxelizer_;
  ReflectionProbes probes_;
  const SurfaceModules& modules_;
  ReflectionProbeModule module_;
  KeyShadows keys_;
  std::vector<std::vector<glm::vec3>> places_;  // of each group, in its frame
  std::vector<std::uint8_t> stale_;             // of each probe: it must be captured
  std::size_t next_ = 0;                        // the probe that was looked at last
  ChangeGate<std::uint64_t, std::uint64_t, std::uint64_t, std::uint32_t> rooms_from_;
  ChangeGate<std::uint64_t, std::size_t, std::uint32_t> meshes_from_;
  ChangeGate<std::vector<std::uint64_t>, FrameSettings> seen_;
};

// Draws surfaces, proxies of bundles that are not resident, the sky and blended surfaces, as linear radiance.
// In views of transfer it draws numbers instead of light.
using lighting::GroupLights;
using lighting::Sky;

class RasterPass final : public FramePass {
 public:
  RasterPass(Surfaces surfaces, Blackboard& board)
      : FramePass(
            {.name = "raster",
             .reads = resources<World, LitScene, GroupLights, Diffuse, Neighborhoods, PatchBounces, Sky,
                                evaluate::SeenSky, Prefiltered, LocalShadows, KeyShadows, ReflectionProbes>(),
             .writes = resources<PictureTargets, Surfaces, std::optional<DataView>, Prefiltered>(),
             .causes = kPictureCauses,
             .counts = {"draws_out_of_view"}}),
        surfaces_(std::move(surfaces)),
        modules_(board.get<SurfaceModules>()) {
    board.offer(surfaces_);
    board.offer(data_view_);
  }

  Result<void> update(FrameContext& frame) override {
    frame.because();
    // Surfaces are prepared even if numbers are drawn, because picking reads them.
    if (Result<void> done = prepareSurfaces(frame, surfaces_, modules_, *frame.view, frame.options.view.view);
        !done)
      return done;
    if (showsTransfer(frame.options.view.view)) return drawNumbers(frame);
    frame.count("draws_out_of_view", surfaces_.countOutOfView());
    data_view_.reset();
    return drawLight(frame);
  }

 private:
  Result<void> drawNumbers(FrameContext& frame) {
    if (!data_view_) data_view_.emplace(/*numbers=*/frame.options.linear());
    if (Result<void> done = data_view_->update(frame.world, frame.read<GroupLights>(), frame.options.view,
                                               frame.settings().transfer, frame.counters());
        !done)
      return done;
    clearTargets(frame);
    return data_view_->draw(frame.world, *frame.view, frame.counters());
  }

  Result<void> drawLight(FrameContext& frame) {
    const spec::View& view = *frame.view;
    const SurfaceView shown = frame.options.view.view;
    frame.read<LocalShadows>().bind(view, frame.targets.size());
    frame.read<KeyShadows>().bind(view, frame.targets.size());
    clearTargets(frame);
    surfaces_.drawOpaque(frame.world, frame.counters());
    if (shown == SurfaceView::Final || shown == SurfaceView::Wireframe) {
      if (Result<void> done =
              proxy_lods_.prepare(frame.world, frame.environment, frame.read<LitScene>().lights,
                                  {.order = frame.settings().order,
                                   .window = frame.settings().window,
                                   .diffuse = frame.settings().diffuse},
                                  frame.counters());
          !done)
        return done;
      proxy_lods_.draw(view, frame.counters());
    }
    if (showsLight(shown) && frame.options.show_sky) {
      frame.read<Sky>().draw(frame.environment, view.view_from_world, view.clip_from_view,
                             frame.targets.size().height, frame.counters());
      glDepthFunc(GL_LESS);
    }
    surfaces_.drawBlended(frame.world, frame.counters());
    return {};
  }

  static void clearTargets(FrameContext& frame) {
    // Pictures of numbers and directions have a dark grey behind them that no value has.
    constexpr float kGrey = 0.012f;
    frame.targets.bindCleared(showsLight(frame.options.view.view) || frame.options.linear() ? 0.0f : kGrey);
  }

  Surfaces surfaces_;
  const SurfaceModules& modules_;
  ProxyLods proxy_lods_;
  std::optional<DataView> data_view_;  // made while a view shows transfer
};

}  // namespace

MadePass makeReflectionProbesPass(const PassSetup& setup) {
  Result<ReflectionProbes> probes = ReflectionProbes::create();
  if (!probes) return failAgain(probes.error());
  Result<SurfaceVoxelizer> voxelizer = SurfaceVoxelizer::create();
  if (!voxelizer) return failAgain(voxelizer.error());
  return std::make_unique<ReflectionProbesPass>(std::move(*voxelizer), std::move(*probes), setup.board);
}

MadePass makeRasterPass(const PassSetup& setup) {
  Result<Surfaces> surfaces = Surfaces::create(/*finest_texels=*/setup.options.linear());
  if (!surfaces) return failAgain(surfaces.error());
  return std::make_unique<RasterPass>(std::move(*surfaces), setup.board);
}

}  // namespace lambent::frame
