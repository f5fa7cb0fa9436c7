// Owns the path-traced reference beside the runtime's picture. It is traced in the background from all
// scenes that are shown, as the world has them (placement, moved nodes, edited materials, lights, camera),
// pass by pass, and starts anew when anything changes. notice() says why a scene cannot be traced. The
// renderer (editor/render) shows its snapshots and reports how they differ from the runtime's own linear
// picture. Main thread; tracing runs on others.
#pragma once

#include <cstdint>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "baker/accuracy/compare.hpp"
#include "baker/import/scene.hpp"
#include "baker/import/scene_edits.hpp"
#include "editor/document/document.hpp"
#include "reference/progressive.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/distant_lights.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::editor {

class Session;

// Identifies a scene that is shown, and its edits and placement.
struct ReferencePart {
  std::filesystem::path source;
  std::filesystem::file_time_type time;
  std::string name;
  baker::SceneEdits edits;
  glm::mat4 world_from_scene{1.0f};
  glm::dvec3 origin{0.0};  // of the world, frame::World::origin()
  bool operator==(const ReferencePart&) const = default;
};

// A point, spot or directional light of the world that belongs to no bundle.
struct ReferenceLamp {
  glm::mat4 world_from_node{1.0f};
  gltf::Light light;
  bool operator==(const ReferenceLamp&) const = default;
};

enum class SplitView : std::uint8_t { Off, Beside, Heat };

class ReferenceView {
 public:
  SplitView split = SplitView::Off;
  float split_at = 0.5f;  // fraction of the width that the runtime's picture takes
  std::uint32_t spp = 256;
  std::optional<int> band_limit;  // SH order to which the light is limited, to show what an exact runtime of
                                  // that order would show

  bool on() const { return split != SplitView::Off; }
  // Returns whether all requested samples are shown, or tracing cannot go on.
  bool done() const;
  // Returns whether there is what the view is named after: any samples, or for a heat map a difference of
  // whole pictures.
  bool shows() const { return split == SplitView::Heat ? difference_.has_value() : seen_ != nullptr; }
  // Says why the reference cannot be traced, or else what it is doing.
  std::string notice() const;
  std::shared_ptr<const baker::reference::Snapshot> snapshot() const;
  // Returns how the snapshot that is shown differs from the runtime's picture, or none if not yet known.
  const std::optional<baker::Difference>& difference() const { return difference_; }

  // The rest is for the renderer. update() follows the world; call it once a frame, after the runtime's
  // picture was rendered. It returns whether there is a snapshot to show, and releases everything while the
  // view is off.
  bool update(const Session& session);
  const spec::View& view() const { return eye_key_->view; }
  const std::shared_ptr<const baker::reference::Snapshot>& seen() const { return seen_; }
  void shown(std::shared_ptr<const baker::reference::Snapshot> snapshot) { seen_ = std::move(snapshot); }
  void compared(Result<baker::Difference> difference);

 private:
  // Identifies what the traced scene was built from.
  struct SceneKey {
    std::vector<ReferencePart> parts;
    std::vector<ReferenceLamp> lamps;
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
  // The light with edited key lights, and the version it belongs to. It is kept because a new view needs it
  // again.
  std::shared_ptr<const spec::DistantLights> edited_light_;
  std::uint64_t edited_light_of_ = 0;
  std::optional<Error> error_;
  std::unique_ptr<baker::reference::ProgressiveReference> tracer_;
  std::shared_ptr<const baker::reference::Snapshot> seen_;
  std::optional<baker::Difference> difference_;
};

}  // namespace lambent::editor
