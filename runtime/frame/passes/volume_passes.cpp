// Brings the light in volumes into textures, and marches rays through the picture that look it up.
#include <algorithm>
#include <optional>
#include <vector>

#include "runtime/draws/view.hpp"
#include "runtime/effects/volume/march.hpp"
#include "runtime/effects/volume/volume.hpp"
#include "runtime/evaluate/samples.hpp"
#include "runtime/frame/pass_list.hpp"

namespace lambent::frame {

namespace {

using effects::volume::Volume;

// Returns whether volumes are in the picture: other views show surfaces alone.
bool anyShown(const FrameContext& frame) {
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

class VolumePass final : public FramePass {
 public:
  VolumePass(bool precise, Blackboard& board)
      : FramePass({.name = "volume",
                   .reads = resources<World, lighting::GroupLights, evaluate::Samples>(),
                   .writes = resources<Volume>(),
                   .causes = kLightCauses | Cause::View,
                   .counts = {"volumes_shaded", "volume_slabs_written", "volumes_out_of_view"}}),
        volume_(precise) {
    board.offer(volume_);
  }

  bool due(const FrameContext& frame) override { return anyShown(frame); }
  Result<void> update(FrameContext& frame) override {
    // Nothing but the march reads the light of volumes.
    const std::vector<std::uint8_t> in_view = volumesInView(frame);
    Result<void> done = volume_.shade(frame.world.residency(),
                                      {frame.read<lighting::GroupLights>(), frame.read<evaluate::Samples>()},
                                      frame.settings().transfer, in_view, frame.counters());
    if (frame.counters().dispatches > 0) frame.because("light");
    frame.count("volumes_shaded", volume_.shadedLast().volumes);
    frame.count("volume_slabs_written", volume_.shadedLast().slabs);
    frame.count("volumes_out_of_view",
                static_cast<std::uint64_t>(std::ranges::count(in_view, std::uint8_t{0})));
    return done;
  }

 private:
  Volume volume_;
};

class MarchPass final : public FramePass {
 public:
  MarchPass()
      : FramePass({.name = "march",
                   .reads = resources<World, Volume, PictureTargets>(),
                   .writes = resources<PictureTargets>(),
                   .causes = kPictureCauses,
                   .counts = {"volumes_drawn"}}) {}

  bool due(const FrameContext& frame) override { return anyShown(frame); }
  Result<void> update(FrameContext& frame) override {
    frame.because();
    // Linear pictures, which are compared, take steps of half the length, without jitter.
    const bool linear = frame.options.linear();
    if (!march_) march_.emplace(effects::volume::MarchOptions{.jitter = !linear});
    march_->setStep(frame.settings().march_step_voxels * (linear ? 0.5f : 1.0f));
    const auto& volumes = frame.world.residency().volumes();
    std::vector<effects::volume::PlacedVolume> placed;
    for (std::uint32_t v = 0; v < volumes.size(); ++v)
      if (frame.world.showsSurfaces(frame.world.residency().groups()[volumes[v].group].bundle))
        placed.push_back({v, frame.world.worldFromGroup(volumes[v].group)});
    Result<void> done = march_->draw(frame.world.residency(), frame.read<Volume>(), placed, *frame.view,
                                     {frame.targets.hdrColor(), frame.targets.depth(), frame.targets.size()},
                                     frame.counters());
    frame.count("volumes_drawn", march_->drawnLast());
    return done;
  }

 private:
  std::optional<effects::volume::March> march_;  // made once there is a volume
};

}  // namespace

MadePass makeVolumePass(const PassSetup& setup) {
  return std::make_unique<VolumePass>(/*precise=*/setup.options.linear(), setup.board);
}

MadePass makeMarchPass(const PassSetup&) {
  return std::make_unique<MarchPass>();
}

}  // namespace lambent::frame
