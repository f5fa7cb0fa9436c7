// Moves, turns and scales the selection by handles in the picture. The local Transforms of the selection with
// their parents' matrices, a view and pixels come in; new local Transforms and lines to paint go out. A drag
// always starts from the Transforms at press(), so rounding errors do not add up. It changes no registry; the
// caller passes the results to the history. Below mirrored and scaled parents, too, things follow the
// pointer. An axis that points at the viewer and a plane seen edge-on have no handle.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>

#include "editor/gizmo/projection.hpp"
#include "runtime/scene/components.hpp"

namespace lambent::editor {

enum class GizmoMode : std::uint8_t { Move, Rotate, Scale };
// The axes of the primary target, or of the world. Things scale along their own in any case.
enum class GizmoSpace : std::uint8_t { Local, World };
enum class Handle : std::uint8_t {
  None,
  X,
  Y,
  Z,
  YZ,  // YZ, ZX and XY are planes, in mode Move only
  ZX,
  XY,
  Screen  // Move: parallel to the picture; Rotate: about the line of sight; Scale: uniformly
};
inline constexpr std::array kHandles = {Handle::X,  Handle::Y,  Handle::Z,     Handle::YZ,
                                        Handle::ZX, Handle::XY, Handle::Screen};
std::string_view handleWord(Handle handle);  // "x", "yz", "screen"

struct GizmoOptions {
  GizmoMode mode = GizmoMode::Move;
  GizmoSpace space = GizmoSpace::World;
  bool snap = false;                                          // drags go in steps
  float snap_m = 0.25f, snap_deg = 15.0f, snap_scale = 0.1f;  // their sizes, > 0
  float size_px = 90.0f;  // length of an axis that is perpendicular to the view
  float hit_px = 7.0f;    // largest distance from the pointer to a handle
};

struct GizmoTarget {
  scene::Transform local;
  glm::mat4 world_from_parent{1.0f};
};

class Gizmo {
 public:
  GizmoOptions options;

  // Call both every frame. During a drag new targets are ignored, but a new view is used. The last target is
  // the primary one, about whose origin all turn and scale. Without targets there are no handles.
  void setTargets(std::vector<GizmoTarget> targets);
  void setView(const spec::View& view, const Viewport& viewport) { projection_ = {view, viewport}; }

  Handle hit(glm::vec2 pixel) const;
  void hover(glm::vec2 pixel);
  Handle hovered() const { return hovered_; }

  // Starts a drag at the handle under the pixel. Returns false if there is none.
  bool press(glm::vec2 pixel);
  bool press(Handle handle, glm::vec2 pixel);  // for shortcuts ("g", "x"); false if the handle is not shown
  bool dragging() const { return active_ != Handle::None; }
  Handle active() const { return active_; }
  // Returns the new Transforms of the targets, in their order, or an empty list if there is no drag.
  // other_snap: snaps if options.snap does not, and the other way round (a modifier key is held).
  std::vector<scene::Transform> drag(glm::vec2 pixel, bool other_snap = false);
  void release() { active_ = Handle::None; }

  // Returns a pixel at which a script can grab the handle, away from the others, or none if the handle is not
  // visible.
  std::optional<glm::vec2> handleScreenPoint(Handle handle) const;
  std::optional<glm::vec2> pivotScreenPoint() const;

  Painting paint() const;
  // Describes the drag so far: "x +1.250 m", "y 45.0 deg", "x 2.00".
  std::string readout() const;

 private:
  struct Start {
    glm::dvec3 pivot{0.0};
    glm::dmat3 axes{1.0};
    glm::dvec2 pixel{0.0};
    double size_m = 1.0;    // length of an axis
    double along = 0.0;     // where the axis was grabbed
    glm::dvec3 point{0.0};  // where the plane was grabbed
    glm::dvec3 turn_axis{0.0, 1.0, 0.0};
    bool edge_on = false;  // the ring is seen edge-on and turned by moving along its line
  };
  // A Shape is the outline of a handle on the screen: a line, or a filled polygon.
  struct Shape {
    std::vector<glm::dvec2> points;
    bool filled = false;
  };

  glm::dvec3 pivot() const;  // of the handles
  glm::dmat3 axes() const;
  double sizeMetres() const;
  bool shown(Handle handle) const;
  glm::dvec3 turnAxis(Handle handle) const;
  std::vector<Shape> shapes(Handle handle) const;
  std::vector<Shape> ring(Handle handle) const;
  std::optional<glm::dvec2> screenDirection(const glm::dvec3& direction) const;
  double distance(Handle handle, const glm::dvec2& pixel) const;  // in pixels; infinite if hidden

  // Returns where the pixel is along the dragged axis, in metres from the pivot.
  std::optional<double> alongAxis(const glm::dvec2& pixel) const;
  void dragMove(const glm::dvec2& pixel, bool snap);
  void dragTurn(const glm::dvec2& pixel, bool snap);
  void dragScale(const glm::dvec2& pixel, bool snap);
  std::optional<double> angleAt(const glm::dvec2& pixel) const;

  Projection projection_;
  std::vector<GizmoTarget> targets_;
  Handle hovered_ = Handle::None, active_ = Handle::None;
  Start start_;
  glm::dvec3 moved_{0.0}, factors_{1.0};
  double turned_rad_ = 0.0;                   // after snapping
  double turn_rad_ = 0.0, last_angle_ = 0.0;  // before snapping; the pointer's angle at the last call
};

}  // namespace lambent::editor
