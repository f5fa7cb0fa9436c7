#include "editor/gizmo/gizmo.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>

#include "editor/gizmo/projection.hpp"
#include "runtime/scene/transforms.hpp"

namespace lambent::editor {
namespace {

// A drag is limited to this many heights of the picture, measured at the pivot, near vanishing points.
constexpr double kFarthest = 100.0;
constexpr double kLeastFactor = 1e-3;

int axisIndex(Handle handle) {
  return static_cast<int>(handle) - static_cast<int>(Handle::X);
}
bool isAxis(Handle handle) {
  return handle == Handle::X || handle == Handle::Y || handle == Handle::Z;
}
bool isPlane(Handle handle) {
  return handle == Handle::YZ || handle == Handle::ZX || handle == Handle::XY;
}
// Returns the axis that is perpendicular to the plane of a handle: X for YZ.
int planeAxis(Handle handle) {
  return static_cast<int>(handle) - static_cast<int>(Handle::YZ);
}
glm::dvec3 planeNormal(const glm::dmat3& axes, Handle handle) {
  const int n = planeAxis(handle);
  return glm::cross(axes[(n + 1) % 3], axes[(n + 2) % 3]);
}
double snapped(double value, double step) {
  return step > 0.0 ? std::round(value / step) * step : value;
}
// Returns e1 and e2, orthonormal, with e1 x e2 = axis.
std::pair<glm::dvec3, glm::dvec3> across(const glm::dvec3& axis) {
  const glm::dvec3 other = std::abs(axis.y) < 0.9 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(1.0, 0.0, 0.0);
  const glm::dvec3 e1 = glm::normalize(glm::cross(other, axis));
  return {e1, glm::cross(axis, e1)};
}

// ---- What a drag does to one target.

// Returns whether the parent only rotates, mirrors and scales uniformly, so that a rotation stays a rotation.
bool isSimilarity(const glm::dmat3& linear) {
  const glm::dmat3 square = glm::transpose(linear) * linear;
  const double size = (square[0][0] + square[1][1] + square[2][2]) / 3.0;
  if (!(size > 0.0)) return false;
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) {
      const double expected = column == row ? size : 0.0;
      if (std::abs(square[column][row] - expected) > 1e-5 * size) return false;
    }
  }
  return true;
}

bool invertible(const glm::dmat3& linear) {
  const double volume = std::abs(glm::determinant(linear));
  const double size = glm::length(linear[0]) * glm::length(linear[1]) * glm::length(linear[2]);
  return volume > 1e-12 * size && size > 0.0;
}

// Returns the moved Transform with the target's matrix multiplied by `linear`, whose shear it stores.
scene::Transform transformedBy(const GizmoTarget& target, scene::Transform moved, const glm::dmat3& linear) {
  glm::dmat4 matrix(scene::localMatrix(target.local));
  for (int column = 0; column < 3; ++column)
    matrix[column] = glm::dvec4(linear * glm::dvec3(matrix[column]), 0.0);
  const glm::vec3 translation = moved.translation;
  scene::setLocalMatrix(moved, glm::mat4(matrix));
  moved.translation = translation;
  return moved;
}

glm::dvec3 originOf(const GizmoTarget& target) {
  return glm::dvec3(glm::dmat4(target.world_from_parent) * glm::dvec4(target.local.translation, 1.0));
}

// Returns the unit axes of the target's node in the world, or the world's axes if the node is flat.
glm::dmat3 axesOf(const GizmoTarget& target) {
  glm::dmat3 axes(glm::dmat4(target.world_from_parent) * glm::dmat4(scene::localMatrix(target.local)));
  for (int i = 0; i < 3; ++i) {
    const double length = glm::length(axes[i]);
    if (!(length > 0.0)) return glm::dmat3(1.0);
    axes[i] /= length;
  }
  // A node that is nearly flat by its shear has no usable axes.
  return std::abs(glm::determinant(axes)) > 1e-3 ? axes : glm::dmat3(1.0);
}

// Moves the origin by `delta_ws` and keeps rotation and scale.
scene::Transform movedBy(const GizmoTarget& target, const glm::dvec3& delta_ws) {
  scene::Transform moved = target.local;
  const glm::dmat3 linear{glm::mat3(target.world_from_parent)};
  if (!invertible(linear)) return moved;  // a flat parent has no inverse
  moved.translation = glm::vec3(glm::dvec3(target.local.translation) + glm::inverse(linear) * delta_ws);
  return moved;
}

// Turns the target about a unit axis through a point, in world space. If the parent is scaled non-uniformly,
// the local result is no pure rotation, and the shear of the Transform stores the rest.
scene::Transform turnedBy(const GizmoTarget& target, const glm::dvec3& pivot_ws, const glm::dvec3& axis_ws,
                          double angle_rad) {
  const glm::dmat3 linear{glm::mat3(target.world_from_parent)};
  if (!invertible(linear)) return target.local;
  const glm::dmat3 turn(glm::rotate(glm::dmat4(1.0), angle_rad, axis_ws));
  const glm::dvec3 origin = originOf(target);
  scene::Transform turned = movedBy(target, pivot_ws + turn * (origin - pivot_ws) - origin);
  const glm::dmat3 parent_turn = glm::inverse(linear) * turn * linear;
  if (isSimilarity(linear)) {
    // The result is a rotation again; scale and shear stay.
    turned.rotation = glm::quat(
        glm::normalize(glm::quat_cast(parent_turn) * glm::normalize(glm::dquat(target.local.rotation))));
    return turned;
  }
  return transformedBy(target, turned, parent_turn);
}

// Scales the target along its own axes, and its distance from the pivot along `axes` by the same factors.
scene::Transform scaledLocally(const GizmoTarget& target, const glm::dvec3& pivot_ws, const glm::dmat3& axes,
                               const glm::dvec3& factors) {
  const glm::dvec3 origin = originOf(target);
  const glm::dvec3 place = pivot_ws + axes * (factors * (glm::inverse(axes) * (origin - pivot_ws)));
  scene::Transform scaled = movedBy(target, place - origin);
  scaled.scale = glm::vec3(glm::dvec3(target.local.scale) * factors);
  // The columns are scaled, so the shear terms change by the ratio of two factors.
  const glm::dvec3 f = factors;
  if (f.x != 0.0 && f.y != 0.0) {
    scaled.shear.x = static_cast<float>(target.local.shear.x * f.y / f.x);
    scaled.shear.y = static_cast<float>(target.local.shear.y * f.z / f.x);
    scaled.shear.z = static_cast<float>(target.local.shear.z * f.z / f.y);
  }
  return scaled;
}

}  // namespace

std::string_view handleWord(Handle handle) {
  constexpr std::string_view kWords[] = {"none", "x", "y", "z", "yz", "zx", "xy", "screen"};
  return kWords[static_cast<std::size_t>(handle)];
}

void Gizmo::setTargets(std::vector<GizmoTarget> targets) {
  if (!dragging()) targets_ = std::move(targets);
}

// ---- Where the handles are.

glm::dvec3 Gizmo::pivot() const {
  if (dragging()) return start_.pivot + moved_;
  return originOf(targets_.back());
}

glm::dmat3 Gizmo::axes() const {
  if (dragging()) return start_.axes;
  const bool own = options.space == GizmoSpace::Local || options.mode == GizmoMode::Scale;
  return own ? axesOf(targets_.back()) : glm::dmat3(1.0);
}

double Gizmo::sizeMetres() const {
  const double scale = projection_.pixelsPerMetre(pivot());
  return scale > 0.0 ? options.size_px / scale : 0.0;
}

glm::dvec3 Gizmo::turnAxis(Handle handle) const {
  return isAxis(handle) ? axes()[axisIndex(handle)] : projection_.toEye(pivot());
}

std::optional<glm::dvec2> Gizmo::screenDirection(const glm::dvec3& direction) const {
  const auto from = projection_.toScreen(pivot());
  const auto to = projection_.toScreen(pivot() + 0.01 * sizeMetres() * direction);
  if (!from || !to) return std::nullopt;
  const double length = glm::length(*to - *from);
  if (!(length > 0.0)) return std::nullopt;
  return (*to - *from) / length;
}

bool Gizmo::shown(Handle handle) const {
  // Shorter axes and narrower planes, as a fraction of their size, are hidden.
  constexpr double kLeast = 0.15;
  if (handle == Handle::None || targets_.empty() || !(sizeMetres() > 0.0)) return false;
  if (dragging()) return handle == active_;
  if (isPlane(handle)) {
    if (options.mode != GizmoMode::Move) return false;
    return std::abs(glm::dot(planeNormal(axes(), handle), projection_.toEye(pivot()))) > kLeast;
  }
  if (isAxis(handle) && options.mode != GizmoMode::Rotate) {
    const auto from = projection_.toScreen(pivot());
    const auto to = projection_.toScreen(pivot() + sizeMetres() * axes()[axisIndex(handle)]);
    return from && to && glm::length(*to - *from) > kLeast * options.size_px;
  }
  return true;
}

std::vector<Gizmo::Shape> Gizmo::ring(Handle handle) const {
  constexpr int kParts = 96;
  const glm::dvec3 center = pivot(), axis = turnAxis(handle), to_eye = projection_.toEye(center);
  const auto [e1, e2] = across(axis);
  const double radius = sizeMetres() * (handle == Handle::Screen ? 1.25 : 1.0);
  // Only the half that faces the viewer is drawn, or the whole ring if it lies in the picture's plane.
  const bool whole = std::abs(glm::dot(axis, to_eye)) > 0.98 || dragging();
  std::vector<Shape> shapes(1);
  for (int i = 0; i <= kParts; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kParts;
    const glm::dvec3 offset = std::cos(angle) * e1 + std::sin(angle) * e2;
    const auto pixel = projection_.toScreen(center + radius * offset);
    if (pixel && (whole || glm::dot(offset, to_eye) > -1e-3))
      shapes.back().points.push_back(*pixel);
    else if (!shapes.back().points.empty())
      shapes.emplace_back();
  }
  return shapes;
}

std::vector<Gizmo::Shape> Gizmo::shapes(Handle handle) const {
  if (!shown(handle)) return {};
  if (options.mode == GizmoMode::Rotate) return ring(handle);
  const glm::dvec3 center = pivot();
  const glm::dmat3 a = axes();
  const double size = sizeMetres();
  std::vector<glm::dvec3> corners;
  Shape shape;
  if (isAxis(handle)) {
    corners = {center + 0.18 * size * a[axisIndex(handle)], center + size * a[axisIndex(handle)]};
  } else if (isPlane(handle)) {
    const glm::dvec3 u = a[(planeAxis(handle) + 1) % 3], v = a[(planeAxis(handle) + 2) % 3];
    for (const auto& [s, t] : {std::pair{0.35, 0.35}, {0.6, 0.35}, {0.6, 0.6}, {0.35, 0.6}})
      corners.push_back(center + size * (s * u + t * v));
    shape.filled = true;
  } else {
    for (int i = 0; i < 12; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / 12;
      corners.push_back(center +
                        0.08 * size *
                            (std::cos(angle) * projection_.right() + std::sin(angle) * projection_.up()));
    }
    shape.filled = true;
  }
  for (const glm::dvec3& corner : corners) {
    const auto pixel = projection_.toScreen(corner);
    if (!pixel) return {};
    shape.points.push_back(*pixel);
  }
  return {shape};
}

double Gizmo::distance(Handle handle, const glm::dvec2& pixel) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Shape& shape : shapes(handle))
    nearest = std::min(
        nearest, shape.filled ? distanceToPolygon(shape.points, pixel) : distanceToLine(shape.points, pixel));
  return nearest;
}

// ---- Which handle is under the pointer.

Handle Gizmo::hit(glm::vec2 pixel) const {
  // At equal distance the smaller handle wins, so it comes first.
  constexpr Handle kOrder[] = {Handle::Screen, Handle::X,  Handle::Y, Handle::Z,
                               Handle::XY,     Handle::YZ, Handle::ZX};
  Handle best = Handle::None;
  double nearest = options.hit_px;
  for (const Handle handle : kOrder) {
    const double away = distance(handle, glm::dvec2(pixel));
    if (away < nearest) {
      nearest = away;
      best = handle;
    }
  }
  return best;
}

void Gizmo::hover(glm::vec2 pixel) {
  hovered_ = dragging() ? active_ : hit(pixel);
}

std::optional<glm::vec2> Gizmo::pivotScreenPoint() const {
  if (targets_.empty()) return std::nullopt;
  const auto pixel = projection_.toScreen(pivot());
  return pixel ? std::optional(glm::vec2(*pixel)) : std::nullopt;
}

std::optional<glm::vec2> Gizmo::handleScreenPoint(Handle handle) const {
  std::optional<glm::vec2> best;
  double margin = -1.0;
  for (const Shape& shape : shapes(handle)) {
    for (const glm::dvec2& candidate : samplesOf(shape.points, shape.filled)) {
      if (hit(glm::vec2(candidate)) != handle) continue;
      double free = std::numeric_limits<double>::max();
      for (const Handle other : kHandles)
        if (other != handle) free = std::min(free, distance(other, candidate));
      if (free <= margin) continue;
      margin = free;
      best = glm::vec2(candidate);
    }
  }
  return best;
}

// ---- Dragging.

bool Gizmo::press(glm::vec2 pixel) {
  return press(hit(pixel), pixel);
}

bool Gizmo::press(Handle handle, glm::vec2 pixel) {
  if (dragging() || !shown(handle)) return false;
  start_ = {};
  start_.pivot = pivot();
  start_.axes = axes();
  start_.size_m = sizeMetres();
  start_.pixel = glm::dvec2(pixel);
  start_.turn_axis = turnAxis(handle);
  start_.edge_on =
      handle != Handle::Screen && std::abs(glm::dot(start_.turn_axis, projection_.toEye(start_.pivot))) < 0.2;
  moved_ = glm::dvec3(0.0);
  factors_ = glm::dvec3(1.0);
  turned_rad_ = turn_rad_ = 0.0;
  active_ = handle;
  if (options.mode == GizmoMode::Rotate) {
    last_angle_ = angleAt(start_.pixel).value_or(0.0);
  } else if (isAxis(handle)) {
    start_.along = alongAxis(start_.pixel).value_or(0.0);
  } else {
    const glm::dvec3 normal = isPlane(handle) ? planeNormal(start_.axes, handle) : projection_.back();
    const Ray ray = projection_.ray(start_.pixel);
    const auto t = Projection::hitPlane(ray, start_.pivot, normal);
    start_.point = t ? ray.origin + *t * ray.direction : start_.pivot;
  }
  return true;
}

std::optional<double> Gizmo::alongAxis(const glm::dvec2& pixel) const {
  const glm::dvec3 axis = start_.axes[axisIndex(active_)];
  const auto u = screenDirection(axis);
  return u ? projection_.alongLine(start_.pivot, axis, *u, glm::dot(*u, pixel)) : std::nullopt;
}

void Gizmo::dragMove(const glm::dvec2& pixel, bool snap) {
  const double step = snap ? double{options.snap_m} : 0.0;
  const double limit = kFarthest * start_.size_m * projection_.viewport().height / options.size_px;
  if (isAxis(active_)) {
    if (const auto t = alongAxis(pixel))
      moved_ = snapped(std::clamp(*t - start_.along, -limit, limit), step) * start_.axes[axisIndex(active_)];
    return;
  }
  const glm::dvec3 normal = isPlane(active_) ? planeNormal(start_.axes, active_) : projection_.back();
  const Ray ray = projection_.ray(pixel);
  const auto t = Projection::hitPlane(ray, start_.point, normal);
  if (!t) return;  // beyond the plane's horizon: keep the last position
  const glm::dvec3 delta = ray.origin + *t * ray.direction - start_.point;
  if (glm::length(delta) > limit) return;
  glm::dvec3 steps = glm::inverse(start_.axes) * delta;
  for (int i = 0; i < 3; ++i) steps[i] = snapped(steps[i], step);
  moved_ = start_.axes * steps;
}

std::optional<double> Gizmo::angleAt(const glm::dvec2& pixel) const {
  if (active_ == Handle::Screen) {
    const auto center = projection_.toScreen(start_.pivot);
    if (!center || pixel == *center) return std::nullopt;
    return std::atan2(center->y - pixel.y, pixel.x - center->x);
  }
  if (start_.edge_on) {
    // The ring's near side moves along axis x line of sight.
    const auto tangent = screenDirection(glm::cross(start_.turn_axis, projection_.toEye(start_.pivot)));
    if (!tangent) return std::nullopt;
    return glm::dot(*tangent, pixel - start_.pixel) / options.size_px;
  }
  const Ray ray = projection_.ray(pixel);
  const auto t = Projection::hitPlane(ray, start_.pivot, start_.turn_axis);
  if (!t) return std::nullopt;
  const glm::dvec3 offset = ray.origin + *t * ray.direction - start_.pivot;
  const auto [e1, e2] = across(start_.turn_axis);
  return std::atan2(glm::dot(offset, e2), glm::dot(offset, e1));
}

void Gizmo::dragTurn(const glm::dvec2& pixel, bool snap) {
  if (const auto angle = angleAt(pixel)) {
    const double step = *angle - last_angle_;
    // Steps are added up, so that a drag can turn by more than a full circle.
    turn_rad_ += start_.edge_on ? step : std::remainder(step, 2.0 * std::numbers::pi);
    last_angle_ = *angle;
  }
  turned_rad_ = snapped(turn_rad_, snap ? glm::radians(double{options.snap_deg}) : 0.0);
}

void Gizmo::dragScale(const glm::dvec2& pixel, bool snap) {
  double factor = 1.0;
  if (isAxis(active_)) {
    const auto t = alongAxis(pixel);
    if (!t || std::abs(start_.along) < 1e-3 * start_.size_m) return;
    factor = *t / start_.along;
  } else {
    const glm::dvec2 way = pixel - start_.pixel;
    factor = std::exp2((way.x - way.y) / options.size_px);  // to the right and up is larger
  }
  const double step = snap ? double{options.snap_scale} : 0.0;
  factor = std::clamp(snapped(factor, step), std::max(step, kLeastFactor), 1.0 / kLeastFactor);
  factors_ = glm::dvec3(isAxis(active_) ? 1.0 : factor);
  if (isAxis(active_)) factors_[axisIndex(active_)] = factor;
}

std::vector<scene::Transform> Gizmo::drag(glm::vec2 pixel, bool other_snap) {
  if (!dragging()) return {};
  const bool snap = options.snap != other_snap;
  const glm::dvec2 at(pixel);
  if (options.mode == GizmoMode::Move) dragMove(at, snap);
  if (options.mode == GizmoMode::Rotate) dragTurn(at, snap);
  if (options.mode == GizmoMode::Scale) dragScale(at, snap);
  std::vector<scene::Transform> result;
  for (const GizmoTarget& target : targets_) {
    switch (options.mode) {
      case GizmoMode::Move:
        result.push_back(movedBy(target, moved_));
        break;
      case GizmoMode::Rotate:
        result.push_back(turnedBy(target, start_.pivot, start_.turn_axis, turned_rad_));
        break;
      case GizmoMode::Scale:
        result.push_back(scaledLocally(target, start_.pivot, start_.axes, factors_));
        break;
    }
  }
  return result;
}

std::string Gizmo::readout() const {
  if (!dragging()) return {};
  const std::string_view word = handleWord(active_);
  switch (options.mode) {
    case GizmoMode::Move: {
      if (isAxis(active_))
        return fmt::format("{} {:+.3f} m", word, glm::dot(moved_, start_.axes[axisIndex(active_)]));
      return fmt::format("{} {:+.3f}, {:+.3f}, {:+.3f} m", word, moved_.x, moved_.y, moved_.z);
    }
    case GizmoMode::Rotate:
      return fmt::format("{} {:+.1f} deg", word, glm::degrees(turned_rad_));
    case GizmoMode::Scale:
      return fmt::format("{} x {:.3f}", word, factors_[isAxis(active_) ? axisIndex(active_) : 0]);
  }
  return {};
}

// ---- Painting.

Painting Gizmo::paint() const {
  constexpr std::uint32_t kColors[] = {rgba(230, 70, 70), rgba(100, 190, 70), rgba(70, 120, 235)};
  constexpr std::uint32_t kLit = rgba(255, 215, 60), kNeutral = rgba(220, 220, 220);
  Painting painting;
  // Planes are painted first, below the axes.
  constexpr Handle kOrder[] = {Handle::XY, Handle::YZ, Handle::ZX,    Handle::X,
                               Handle::Y,  Handle::Z,  Handle::Screen};
  for (const Handle handle : kOrder) {
    std::uint32_t color = kNeutral;
    if (isAxis(handle)) color = kColors[axisIndex(handle)];
    if (isPlane(handle)) color = kColors[planeAxis(handle)];
    const bool lit = handle == hovered_ || handle == active_;
    if (lit) color = kLit;
    if (isPlane(handle)) color = (color & 0x00ffffffu) | (lit ? 0xc0000000u : 0x70000000u);
    for (const Shape& shape : shapes(handle)) {
      if (shape.points.size() < 2) continue;
      Stroke& stroke = painting.emplace_back();
      stroke.points.assign(shape.points.begin(), shape.points.end());
      stroke.color = color;
      stroke.width_px = lit ? 3.5f : 2.5f;
      stroke.filled = stroke.closed = shape.filled;
      if (isAxis(handle) && options.mode != GizmoMode::Rotate)
        painting.push_back(tip(shape.points[0], shape.points[1], options.mode == GizmoMode::Move, color));
    }
  }
  return painting;
}

}  // namespace lambent::editor
