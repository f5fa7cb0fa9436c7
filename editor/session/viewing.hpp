// Holds how the world is viewed: the camera and its goal, what surfaces show, and the overlays. Pointer input
// and command words come in; a spec::View for each picture goes out. World files store it in
// WorldState::view.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "editor/document/document.hpp"
#include "editor/gizmo/camera_control.hpp"
#include "editor/session/picture_scale.hpp"
#include "runtime/debug/overlay_options.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/spec/size.hpp"
#include "runtime/surface/views.hpp"

namespace lambent::editor {

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
  // The camera whose picture stays in the view while other things are selected.
  ecs::Entity kept_camera;
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
  // Sets the camera from "orbit:...", "pose:..." or the name of a bundle's camera. Errors: the word is none
  // of these.
  Result<void> setCamera(const Document& document, std::string_view word);

  // Write this to a world's state, and read it back if that has changed.
  void keep(WorldState& world) const;
  void follow(const WorldState& world);

 private:
  void placeFirst(const Document& document);

  std::string pose_followed_;
};

}  // namespace lambent::editor
