// The path-traced picture beside the runtime's: traced in the background from all scenes that are shown, as
// the world has them (where they stand, moved nodes, edited materials, lights and eye), finer pass by pass,
// and held against the runtime's own linear picture of the same eye. Anything that changes begins it anew.
// Main thread; tracing happens elsewhere. What cannot be traced says so in notice().
#pragma once

#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "baker/accuracy/difference.hpp"
#include "editor/session/reference_scene.hpp"
#include "reference/progressive.hpp"
#include "runtime/frame/frame.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/tone_map/tone_mapper.hpp"

namespace lambent::editor {

class Session;

enum class SplitView : std::uint8_t { Off, Beside, Heat };

class ReferenceView {
 public:
  SplitView split = SplitView::Off;
  float split_at = 0.5f;  // share of the width that the runtime's picture has
  std::uint32_t spp = 256;
  std::optional<int> band_limit;  // of the light: what an ideal runtime of that order would show
  baker::HeatMap heat_map = baker::HeatMap::Signed;

  // Once a frame, after the runtime's picture was drawn; nothing happens while it is off.
  void update(Session& session);

  bool on() const { return split != SplitView::Off; }
  // Whether it has the samples that were asked for, or cannot go on.
  bool done() const;
  // The picture to show, row 0 at the top; no handle: none yet.
  const gpu::Texture& picture() const { return split == SplitView::Heat ? heat_ : shown_; }
  const std::optional<baker::Difference>& difference() const { return difference_; }
  std::shared_ptr<const baker::reference::Snapshot> snapshot() const;
  // What keeps it from being traced, or what it does.
  std::string notice() const;

 private:
  // What the scene that is traced was made of.
  struct SceneKey {
    std::vector<ReferencePart> parts;
    std::string lamps;  // what else was put into it, as text
    float animation_s = 0.0f;
    bool operator==(const SceneKey&) const = default;
  };
  struct EyeKey {
    spec::View view;
    spec::Size size;
    std::uint64_t lights = 0;
    std::uint32_t spp = 0;
    std::optional<int> band_limit;
  };
  using ScenePointer = std::shared_ptr<const baker::Scene>;
  void followScene(Session& session);
  void followEye(Session& session);
  void show(Session& session, const baker::reference::Snapshot& snapshot);
  Result<spec::RgbaImage> linearPicture(Session& session, const spec::View& view, spec::Size size);

  std::optional<SceneKey> scene_key_;
  std::optional<EyeKey> eye_key_;
  std::future<Result<ScenePointer>> coming_;
  ScenePointer scene_;
  // The light with edited key lights, and the version that it is of: an eye that moves needs it again.
  std::shared_ptr<const spec::DistantLights> edited_light_;
  std::uint64_t edited_light_of_ = 0;
  std::optional<Error> error_;
  std::unique_ptr<baker::reference::ProgressiveReference> tracer_;
  std::shared_ptr<const baker::reference::Snapshot> seen_;
  float seen_exposure_ev_ = 0.0f;
  std::optional<frame::ToneMapper> tone_mapper_;
  std::optional<frame::Frame> linear_;
  gpu::Texture radiance_, shown_, heat_;
  gpu::Framebuffer shown_target_;
  std::optional<baker::Difference> difference_;
};

}  // namespace lambent::editor
