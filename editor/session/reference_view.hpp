// Owns the path-traced reference beside the runtime's picture: traced in the background from all scenes that
// are shown, as the world has them (where they stand, moved nodes, edited materials, lights and camera),
// finer pass by pass. Anything that changes begins it anew. What cannot be traced says so in notice(). The
// renderer (editor/render) shows its snapshots and tells how they differ from the runtime's own linear
// picture. Main thread; tracing happens elsewhere.
#pragma once

#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "baker/accuracy/difference.hpp"
#include "editor/session/reference_scene.hpp"
#include "reference/progressive.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/distant_lights.hpp"
#include "runtime/spec/size.hpp"

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

  bool on() const { return split != SplitView::Off; }
  // Returns whether it shows the samples that were asked for, or cannot go on.
  bool done() const;
  // Says what keeps it from being traced, or what it does.
  std::string notice() const;
  std::shared_ptr<const baker::reference::Snapshot> snapshot() const;
  // How the snapshot that is shown differs from the runtime's picture; nothing: not known yet.
  const std::optional<baker::Difference>& difference() const { return difference_; }

  // The rest is for the renderer. Follows the world; call it once a frame, after the runtime's picture was
  // drawn. Returns whether there is a picture to show. Lets go of everything while it is off.
  bool update(const Session& session);
  // The view that is traced.
  const spec::View& view() const { return eye_key_->view; }
  // The snapshot that shown() was told of last.
  const std::shared_ptr<const baker::reference::Snapshot>& seen() const { return seen_; }
  void shown(std::shared_ptr<const baker::reference::Snapshot> snapshot) { seen_ = std::move(snapshot); }
  void compared(Result<baker::Difference> difference);

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
  void followScene(const Session& session);
  void followEye(const Session& session);

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
  std::optional<baker::Difference> difference_;
};

}  // namespace lambent::editor
