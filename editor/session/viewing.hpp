// Holds how the world is looked at: the camera and where it is going, what surfaces show, and what is drawn
// over them. Movements of the pointer and words of commands come in; a spec::View for each picture goes out.
// World files keep it in WorldState::view.
#pragma once

#include <cstddef>
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
  // The size in pixels and the view of the last picture.
  spec::Size size;
  spec::View shown_view;

  CameraPose pose, goal;  // the camera eases from the one to the other
  frame::ViewChoice surfaces;
  frame::OverlayOptions overlays;
  std::optional<std::size_t> key_at_hand;  // of Environment::keys(): whose fields are shown
  PictureScale scale;

  bool frame_when_loaded = true;  // the first bundle that comes decides where the camera stands
  bool changed = true;            // the picture must be drawn anew
  bool flying = false;            // keys move the camera

  // Eases the camera towards its goal; call it once a frame.
  void update(const Document& document, double seconds);
  Result<spec::View> view(const Document& document, spec::Size of) const;

  void move(const Document& document, const CameraInput& input);
  // Lets the box fill the picture; an empty one means the whole world.
  void frame(const Document& document, const scene::Box& box);
  // Takes "orbit:...", "pose:...", or a camera of a bundle by its name. Errors: a word that is none of these.
  Result<void> setCamera(const Document& document, std::string_view word);

  // Writes itself into a world's state, and reads itself from there where that has changed.
  void keep(WorldState& world) const;
  void follow(const WorldState& world);

 private:
  void placeFirst(const Document& document);

  std::string pose_followed_;
};

}  // namespace lambent::editor
