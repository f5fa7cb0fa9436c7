// Moves, turns and scales what is selected by handles: says where they stand in the picture, what the pointer
// is over, and what dragging does. The local Transforms of the selection with their parents' matrices, a view
// and pixels come in. New local Transforms go out, made from the state at press() each time, so that a drag
// leaves no rounding behind, and lines to paint. It touches no registry: whoever drives it puts the results
// through the history. Mirrored and scaled parents are taken as they are: things move as the pointer does. An
// axis that points at the viewer, or a plane seen edge on, has no handle.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>

#include "editor/gizmo/painting.hpp"
#include "editor/gizmo/projection.hpp"
#include "runtime/scene/components.hpp"

namespace lambent::editor {

enum class GizmoMode : std::uint8_t { Move, Rotate, Scale };
enum class GizmoSpace : std::uint8_t { Local, World };  // whose axes: the primary target's
enum class GizmoPivot : std::uint8_t {
  Primary,  // about the primary target's origin
  Center,   // about the mean of the origins
  Each      // every target about its own; handles stand at the primary
};

enum class Handle : std::uint8_t {
  None,
  X,
  Y,
  Z,
  YZ,  // planes, of Move
  ZX,
  XY,
  Screen  // Move: in the picture; Rotate: about the line of sight; Scale: evenly
};
inline constexpr std::array kHandles = {Handle::X,  Handle::Y,  Handle::Z,     Handle::YZ,
                                        Handle::ZX, Handle::XY, Handle::Screen};
std::string_view handleWord(Handle handle);  // "x", "yz", "screen"
std::optional<Handle> parseHandle(std::string_view word);

struct GizmoOptions {
  GizmoMode mode = GizmoMode::Move;
  GizmoSpace space = GizmoSpace::World;
  GizmoPivot pivot = GizmoPivot::Primary;
  float snap_m = 0.0f, snap_deg = 0.0f, snap_scale = 0.0f;  // steps; 0: none
  float size_px = 90.0f;                                    // of an axis that is seen from the side
  float hit_px = 7.0f;                                      // how near the pointer has to come
};

struct GizmoTarget {
  scene::Transform local;
  glm::mat4 world_from_parent{1.0f};
};

class Gizmo {
 public:
  GizmoOptions options;

  // Call both every frame. The targets are not taken over while dragging; the view is. The primary target is
  // the last. No targets: no handles.
  void setTargets(std::vector<GizmoTarget> targets);
  void setView(const spec::View& view, const Viewport& viewport);

  // Returns the handle under the pixel.
  Handle hit(glm::vec2 pixel) const;
  void hover(glm::vec2 pixel);
  Handle hovered() const { return hovered_; }

  // Takes the handle under the pixel; false if there is none.
  bool press(glm::vec2 pixel);
  bool press(Handle handle, glm::vec2 pixel);  // for shortcuts ("g", "x"); false if it is not there
  bool dragging() const { return active_ != Handle::None; }
  Handle active() const { return active_; }
  // Returns the targets in their order, as they are to be now. `free`: without snapping (a modifier key).
  // Returns nothing while nothing is dragged.
  std::vector<scene::Transform> drag(glm::vec2 pixel, bool free = false);
  void release();
  // Ends the drag and returns the targets as they were.
  std::vector<scene::Transform> cancel();

  // Returns a pixel at which the handle can be taken, away from the others, or none if it is not seen.
  // Scripts grab by it.
  std::optional<glm::vec2> handleScreenPoint(Handle handle) const;
  std::optional<glm::vec2> pivotScreenPoint() const;

  Painting paint() const;
  // Tells what the drag has done so far: "x +1.250 m", "y 45.0 deg", "x 2.00".
  std::string readout() const;

 private:
  struct Start {
    glm::dvec3 pivot{0.0};
    glm::dmat3 axes{1.0};
    glm::dvec2 pixel{0.0};
    double size_m = 1.0;    // of an axis
    double along = 0.0;     // where the axis was taken
    glm::dvec3 point{0.0};  // where the plane was taken
    glm::dvec3 turn_axis{0.0, 1.0, 0.0};
    bool edge_on = false;  // a ring that is turned by moving along its line
  };
  // Lines (or one filled polygon) on the screen that a handle is taken at.
  struct Shape {
    std::vector<glm::dvec2> points;
    bool filled = false;
  };

  glm::dvec3 pivot() const;  // where the handles stand now
  glm::dmat3 axes() const;
  double sizeMetres() const;
  bool shown(Handle handle) const;
  glm::dvec3 turnAxis(Handle handle) const;
  std::vector<Shape> shapes(Handle handle) const;
  std::vector<Shape> ring(Handle handle) const;
  std::optional<glm::dvec2> screenDirection(const glm::dvec3& direction) const;
  double distance(Handle handle, const glm::dvec2& pixel) const;  // in pixels; infinite where not shown

  void dragMove(const glm::dvec2& pixel, bool free);
  void dragTurn(const glm::dvec2& pixel, bool free);
  void dragScale(const glm::dvec2& pixel, bool free);
  std::optional<double> angleAt(const glm::dvec2& pixel) const;

  Projection projection_;
  std::vector<GizmoTarget> targets_;
  Handle hovered_ = Handle::None, active_ = Handle::None;
  Start start_;
  glm::dvec3 moved_{0.0}, factors_{1.0};
  double turned_rad_ = 0.0;                   // with snapping
  double turn_rad_ = 0.0, last_angle_ = 0.0;  // without; the pointer's angle when it was last asked
};

// ---- what the drags do, for one target

// Returns the unit axes of its node in the world, or the world's own where it is flat.
glm::dmat3 axesOf(const GizmoTarget& target);
glm::dvec3 originOf(const GizmoTarget& target);

// Moves its origin by `delta_ws`; turn and scale stay.
scene::Transform movedBy(const GizmoTarget& target, const glm::dvec3& delta_ws);
// Turns it in the world about an axis (unit) through a point. Below a parent that is scaled unevenly the
// shear takes up what a rotation cannot say.
scene::Transform turnedBy(const GizmoTarget& target, const glm::dvec3& pivot_ws, const glm::dvec3& axis_ws,
                          double angle_rad);
// Scales it along its own axes; its origin goes from the pivot by the same factors along `axes`.
scene::Transform scaledLocally(const GizmoTarget& target, const glm::dvec3& pivot_ws, const glm::dmat3& axes,
                               const glm::dvec3& factors);
// Scales it along axes of the world, about a point.
scene::Transform scaledInWorld(const GizmoTarget& target, const glm::dvec3& pivot_ws,
                               const glm::dvec3& factors);

}  // namespace lambent::editor
