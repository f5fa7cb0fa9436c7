// How the world is looked at: the eye and where it is going, what surfaces show, what is drawn over them, the
// handles of what is selected, and whether animations run. Comes in: movements of the pointer from the view
// panel, words from commands; goes out: a spec::View for each picture. Kept in world files by
// WorldState::view.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "editor/document/world_state.hpp"
#include "editor/gizmo/camera_control.hpp"
#include "editor/gizmo/gizmo.hpp"
#include "editor/gizmo/light_gizmo.hpp"
#include "editor/gizmo/sun_gizmo.hpp"
#include "editor/session/suns.hpp"
#include "runtime/debug/overlays.hpp"
#include "runtime/spec/size.hpp"
#include "runtime/surface/views.hpp"

namespace lambent::editor {

class Session;

class Viewing {
 public:
  // Of the picture that is shown; free to be read by panels.
  spec::Size size;
  spec::View shown_view;

  CameraPose pose, goal;  // the eye eases from the one to the other
  Gizmo gizmo;
  LightGizmo light_gizmo;
  SunGizmo sun_gizmo;
  std::optional<SunOnSky> sun_taken;       // as it stood when its drag began
  std::optional<std::size_t> key_at_hand;  // of Environment::keys(): whose fields are shown
  bool show_gizmos = true;
  frame::OverlayOptions overlays;
  float render_scale = 1.0f;  // pixels of the picture for each of the window
  // What a picture is drawn at now: fewer pixels while it moves and whole ones take long.
  float scaleNow() const { return moving_fast_ ? render_scale * moving_scale_ : render_scale; }
  // Of a picture that was drawn at scaleNow(); moves: it will not stay.
  void tookTime(double ms, bool moves);
  // Nothing moves any more: the next picture is whole.
  void settle();

  bool playing = false;      // animations
  float animation_s = 0.0f;  // how long they have played

  bool frame_when_loaded = true;  // the first bundle that comes decides where the eye stands
  bool changed = true;            // something here did: the picture is to be drawn anew
  bool flying = false;            // keys move the eye

  // Once a frame.
  void update(Session& session, double seconds);
  Result<spec::View> view(const Session& session, spec::Size of) const;
  void setView(Session& session, const frame::ViewChoice& choice);
  const frame::ViewChoice& surfaceView() const { return view_; }

  void move(const Session& session, const CameraInput& input);
  // Empty: the whole world.
  void frame(const Session& session, const scene::Box& box);
  // "orbit:...", "pose:...", or a camera of a bundle by its name.
  Result<void> setCamera(const Session& session, std::string_view word);
  // Names of the bundles' cameras.
  std::vector<std::string> cameras(const Session& session) const;
  bool hasAnimations(const Session& session) const;

  // To and from a world file.
  void keep(WorldState& world) const;
  void follow(const WorldState& world);

 private:
  scene::Box bounds(const Session& session) const;
  void placeFirst(Session& session);

  frame::ViewChoice view_;
  float moving_scale_ = 1.0f;
  bool moving_fast_ = false;
  std::string pose_followed_;
};

}  // namespace lambent::editor
