// The passes that finish a picture: volumes, exposure and colours, then overlays.
#include <algorithm>
#include <utility>
#include <vector>

#include "runtime/frame/frame_parts.hpp"
#include "runtime/frame/frame_pass.hpp"

namespace lambent::frame {

namespace {

// Returns whether volumes are in the picture: other views show surfaces alone.
bool volumesShown(const FrameContext& frame) {
  const SurfaceView shown = frame.options.view.view;
  return frame.settings().volumes && !frame.world.residency().volumes().empty() &&
         (shown == SurfaceView::Final || shown == SurfaceView::Wireframe);
}

// Returns 1 for each volume that the view may reach.
std::vector<std::uint8_t> volumesInView(const FrameContext& frame) {
  const glm::mat4 clip_from_world = frame.view->clip_from_view * frame.view->view_from_world;
  std::vector<std::uint8_t> in_view;
  for (const streaming::ResidentVolume& volume : frame.world.residency().volumes()) {
    const glm::mat4 clip_from_grid =
        clip_from_world * frame.world.worldFromGroup(volume.group) * volume.grid.group_from_grid;
    const scene::Box box{glm::vec3(0.0f), glm::vec3(volume.grid.size)};
    in_view.push_back(outOfView(clip_from_grid, box) ? 0 : 1);
  }
  return in_view;
}

// Brings the light in volumes into textures. Nothing but the march reads it.
Result<void> shadeVolumes(FrameContext& frame) {
  effects::volume::Volume& volume = frame.parts.volume;
  const std::vector<std::uint8_t> in_view = volumesInView(frame);
  Result<void> done = volume.shade(frame.world.residency(), {frame.parts.group_lights, frame.parts.samples},
                                   frame.settings().transfer, in_view, frame.counters());
  if (frame.counters().dispatches > 0) frame.because("light");
  frame.count("volumes_shaded", volume.shadedLast().volumes);
  frame.count("volume_slabs_written", volume.shadedLast().slabs);
  frame.count("volumes_out_of_view",
              static_cast<std::uint64_t>(std::ranges::count(in_view, std::uint8_t{0})));
  return done;
}

// Marches rays through the picture, which gather what volumes scatter and absorb.
Result<void> marchVolumes(FrameContext& frame) {
  frame.because();
  effects::volume::March& march = frame.parts.march;
  // Linear pictures, which are compared, take steps of half the length, without jitter.
  const bool linear = frame.options.linear();
  march.set({.step_voxels = frame.settings().march_step_voxels * (linear ? 0.5f : 1.0f), .jitter = !linear});
  const auto& volumes = frame.world.residency().volumes();
  std::vector<effects::volume::PlacedVolume> placed;
  for (std::uint32_t v = 0; v < volumes.size(); ++v)
    if (frame.world.showsSurfaces(frame.world.residency().groups()[volumes[v].group].bundle))
      placed.push_back({v, frame.world.worldFromGroup(volumes[v].group)});
  Result<void> done =
      march.draw(frame.world.residency(), frame.parts.volume, placed, *frame.view,
                 {frame.targets.hdrColor(), frame.targets.depth(), frame.targets.size()}, frame.counters());
  frame.count("volumes_drawn", march.drawnLast());
  return done;
}

// The owner of shared targets maps tones itself.
bool toneMapDue(const FrameContext& frame) {
  return frame.options.destination != Destination::Shared;
}

// Turns linear radiance into the picture; counts negative pixels, and clamps them for the eye.
Result<void> mapTones(FrameContext& frame) {
  frame.targets.bindPicture();
  frame.because();
  return frame.parts.tone_mapper.run(frame.targets.hdr(), frame.settings().exposure_ev, frame.counters(),
                                     !showsLight(frame.options.view.view));
}

bool showsWires(const FrameContext& frame) {
  return frame.options.view.view == SurfaceView::Wireframe;
}

bool overlaysDue(const FrameContext& frame) {
  const bool wires = showsWires(frame);
  if (!wires) frame.parts.wires.reset();
  const bool any = wires || frame.options.overlays.any();
  if (!any) frame.parts.overlays.reset();
  return any;
}

// Draws overlays and wires of triangles over the finished picture.
Result<void> drawOverlays(FrameContext& frame) {
  frame.because();
  FrameParts& parts = frame.parts;
  const bool linear = frame.options.linear(), wires = showsWires(frame);
  if (parts.targets_changed.renew(frame.targets.version()) || !parts.overlays)
    parts.overlays.emplace(frame.targets.depth(), frame.targets.size(), linear);
  if (wires && !parts.wires) parts.wires.emplace(linear);
  const OverlayScene scene{frame.world,         frame.environment, parts.plan, parts.group_lights,
                           parts.neighborhoods, parts.tone_mapper, *frame.view};
  DataView* const shown_wires = wires ? &*parts.wires : nullptr;
  if (Result<void> done = parts.overlays->draw(frame.options.overlays, scene, shown_wires, frame.counters());
      !done)
    return done;
  frame.targets.bindPicture();
  return parts.overlays->layOver(frame.counters());
}

constexpr FramePass kPicturePasses[] = {{"volume", kLightCauses | Cause::View, shadeVolumes, volumesShown},
                                        {"march", kPictureCauses, marchVolumes, volumesShown},
                                        {"tone map", kPictureCauses | Cause::Exposure, mapTones, toneMapDue},
                                        {"overlays", kPictureCauses, drawOverlays, overlaysDue}};

}  // namespace

std::span<const FramePass> picturePasses() {
  return kPicturePasses;
}

}  // namespace lambent::frame
