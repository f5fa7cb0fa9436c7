// Holds how the world is viewed: the camera and its goal, what surfaces show, the overlays, and what is
// known about the last picture. Pointer input and command words come in; a spec::View for each picture goes
// out. World files store it in WorldState::view.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "editor/document/document.hpp"
#include "editor/gizmo/camera_control.hpp"
#include "runtime/frame/frame.hpp"
#include "runtime/measure/measured_frame.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/surface/views.hpp"
#include "runtime/world/frame_times.hpp"

namespace lambent::editor {

class Session;

// Chooses the resolution of pictures, in pixels per window pixel along an edge: the one that the user asked
// for, or a lower one while the picture moves if full pictures take long. It does not use the GPU; the
// renderer reports the times.
class PictureScale {
 public:
  float whole = 1.0f;  // the user's choice, 0.25..2

  // Returns the scale of the next picture.
  float now() const { return coarse_ ? whole * moving_ : whole; }
  bool coarse() const { return coarse_; }
  // Call this when a picture was rendered. moves: another will follow soon, and may be coarse.
  void drawn(bool moves) { coarse_ = moves && moving_ < 1.0f; }
  // Call this with the time of a picture at full resolution.
  void wholeTook(double milliseconds);
  // Call this when nothing moves any more. The next picture has full resolution. Returns whether the last did
  // not.
  bool settle();

 private:
  float moving_ = 1.0f;  // factor on `whole` while the picture moves
  bool coarse_ = false;
};

// Holds what is known about the last picture. The renderer writes it; commands and panels read it. Before
// the first picture everything is zero.
struct PictureFacts {
  frame::StepCounts counts;
  frame::ViewLegend legend;
  std::vector<gpu::PassTime> passes;  // of the newest frame whose times are all known
  std::uint64_t volume_bytes = 0;     // GPU memory that the frame keeps for volumes
  frame::FrameTimes times;            // from the first command to the last
  std::uint64_t drawn = 0;            // how many pictures there were
  bool settled = false;               // everything is loaded, and the light did not change in the last frame
  bool in_flight = false;             // the GPU still works on the last picture
  // These belong to the last picture that the GPU has finished.
  std::uint32_t negative_pixels = 0;
  float exposure_ev = 0.0f;
};

class Viewing {
 public:
  // Size in pixels and view of the last picture.
  spec::Size size;
  spec::View shown_view;

  CameraPose pose, goal;  // the camera eases from `pose` to `goal`
  frame::ViewChoice surfaces;
  frame::OverlayOptions overlays;
  // The index into Environment::keys() of the key light whose fields are shown.
  std::optional<std::size_t> key_at_hand;
  PictureScale scale;
  // Returns the surface point in the middle of the picture, or none where the sky is. It is empty without a
  // window.
  std::function<std::optional<glm::vec3>()> surface_ahead;

  bool frame_when_loaded = true;  // place the camera when the first bundle is loaded
  bool changed = true;            // the picture must be drawn anew
  bool flying = false;            // the keys move the camera
  bool hovered = false;           // the pointer is over the view

  // Eases the camera towards its goal; call it once a frame.
  void update(const Document& document, double seconds);
  Result<spec::View> view(const Document& document, spec::Size of) const;

  void move(const Document& document, const CameraInput& input);
  // Fits the box into the picture. An empty box means the whole world.
  void frame(const Document& document, const scene::Box& box);
  Result<void> setCamera(const Document& document, std::string_view word);

  // Write this to a world's state, and read it back if that has changed.
  void keep(WorldState& world) const;
  void follow(const WorldState& world);

 private:
  void placeFirst(const Document& document);

  std::string pose_followed_;
};

// Measures on request what each setting of the frame costs in time and in error: one a frame, so that the
// editor stays responsive. update() needs a current OpenGL context, and the renderer calls it.
class SettingStudy {
 public:
  // Starts measuring every setting at its present value.
  void measureAll();
  void update(Session& session);
  bool busy() const { return !waiting_.empty(); }

  const std::map<std::string, frame::SettingCost, std::less<>>& costs() const { return costs_; }

 private:
  std::vector<std::string> waiting_;  // the last is the next
  std::map<std::string, frame::SettingCost, std::less<>> costs_;
};

// ---- Cameras that stand in the world.

// Returns the selected entity if it is a camera, or none.
ecs::Entity selectedCamera(const Session& session);
void lookThrough(Session& session, ecs::Entity camera);
// Places the camera where the view is and gives it the view's angle, as one step.
Result<void> placeAtView(Session& session, ecs::Entity camera);

}  // namespace lambent::editor
