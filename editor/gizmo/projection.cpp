#include "editor/gizmo/projection.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>

namespace lambent::editor {

Projection::Projection(const spec::View& view, const Viewport& viewport) : viewport_(viewport) {
  const glm::dmat4 view_from_world(view.view_from_world), clip_from_view(view.clip_from_view);
  clip_from_world_ = clip_from_view * view_from_world;
  world_from_clip_ = glm::inverse(clip_from_world_);
  const glm::dmat4 world_from_view = glm::inverse(view_from_world);
  right_ = glm::normalize(glm::dvec3(world_from_view[0]));
  up_ = glm::normalize(glm::dvec3(world_from_view[1]));
  back_ = glm::normalize(glm::dvec3(world_from_view[2]));
  eye_ = glm::dvec3(world_from_view[3]);
  perspective_ = clip_from_view[2][3] != 0.0;
}

glm::dvec3 Projection::pixelHomogeneous(const glm::dvec4& point) const {
  const glm::dvec4 clip = clip_from_world_ * point;
  const double width = viewport_.width, height = viewport_.height;
  return {(0.5 * width + viewport_.x) * clip.w + 0.5 * width * clip.x,
          (0.5 * height + viewport_.y) * clip.w - 0.5 * height * clip.y, clip.w};
}

std::optional<glm::dvec2> Projection::toScreen(const glm::dvec3& point_ws) const {
  const glm::dvec3 pixel = pixelHomogeneous(glm::dvec4(point_ws, 1.0));
  if (!(pixel.z > 1e-9)) return std::nullopt;
  return glm::dvec2(pixel) / pixel.z;
}

Ray Projection::ray(const glm::dvec2& pixel) const {
  const double x = 2.0 * (pixel.x - viewport_.x) / viewport_.width - 1.0;
  const double y = 1.0 - 2.0 * (pixel.y - viewport_.y) / viewport_.height;
  // The near and the far plane are both in front of the eye.
  const glm::dvec4 near_h = world_from_clip_ * glm::dvec4(x, y, -1.0, 1.0);
  const glm::dvec4 far_h = world_from_clip_ * glm::dvec4(x, y, 1.0, 1.0);
  const glm::dvec3 near_ws = glm::dvec3(near_h) / near_h.w, far_ws = glm::dvec3(far_h) / far_h.w;
  if (perspective_) return {eye_, glm::normalize(far_ws - eye_)};
  // The ray starts in the eye's plane, because points before the near plane are in front of the eye, too.
  const glm::dvec3 direction = -back_;
  return {near_ws + direction * glm::dot(eye_ - near_ws, direction), direction};
}

glm::dvec3 Projection::toEye(const glm::dvec3& point_ws) const {
  if (!perspective_) return back_;
  const glm::dvec3 way = eye_ - point_ws;
  const double length = glm::length(way);
  return length > 0.0 ? way / length : back_;
}

double Projection::pixelsPerMetre(const glm::dvec3& point_ws) const {
  const glm::dvec3 here = pixelHomogeneous(glm::dvec4(point_ws, 1.0));
  if (!(here.z > 1e-9)) return 0.0;
  // A step along the camera's up keeps the depth and so w.
  const glm::dvec3 step = pixelHomogeneous(glm::dvec4(up_, 0.0));
  return std::abs(step.y) / here.z;
}

std::optional<double> Projection::alongLine(const glm::dvec3& p, const glm::dvec3& d, const glm::dvec2& u,
                                            double coordinate) const {
  // The pixel of p + t d is (P.xy + t D.xy) / (P.z + t D.z), so
  // u.(P.xy + t D.xy) = coordinate (P.z + t D.z), linear in t.
  const glm::dvec3 at = pixelHomogeneous(glm::dvec4(p, 1.0)), along = pixelHomogeneous(glm::dvec4(d, 0.0));
  const double slope = glm::dot(u, glm::dvec2(along)) - coordinate * along.z;
  const double rest = coordinate * at.z - glm::dot(u, glm::dvec2(at));
  if (std::abs(slope) < 1e-9 * (std::abs(rest) + at.z)) return std::nullopt;
  const double t = rest / slope;
  // A pixel at or beyond the vanishing point corresponds to no point of the line.
  if (!(at.z + t * along.z > 1e-4 * at.z)) return std::nullopt;
  return t;
}

std::optional<double> Projection::hitPlane(const Ray& ray, const glm::dvec3& point,
                                           const glm::dvec3& normal) {
  const double slope = glm::dot(ray.direction, normal);
  if (std::abs(slope) < 1e-6) return std::nullopt;
  const double t = glm::dot(point - ray.origin, normal) / slope;
  if (!(t > 0.0)) return std::nullopt;
  return t;
}

namespace {

double distanceToSegment(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& pixel) {
  const glm::dvec2 way = b - a;
  const double length2 = glm::dot(way, way);
  const double t = length2 > 0.0 ? std::clamp(glm::dot(pixel - a, way) / length2, 0.0, 1.0) : 0.0;
  return glm::length(pixel - a - t * way);
}

}  // namespace

double distanceToLine(const std::vector<glm::dvec2>& points, const glm::dvec2& pixel) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < points.size(); ++i)
    nearest = std::min(nearest, distanceToSegment(points[i], points[i + 1], pixel));
  return nearest;
}

double distanceToPolygon(const std::vector<glm::dvec2>& points, const glm::dvec2& pixel) {
  bool inside = false;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0, last = points.size() - 1; i < points.size(); last = i++) {
    const glm::dvec2 a = points[i], b = points[last];
    nearest = std::min(nearest, distanceToSegment(a, b, pixel));
    // A pixel is inside if a line to its right crosses an odd number of edges.
    if ((a.y > pixel.y) != (b.y > pixel.y) && pixel.x < a.x + (b.x - a.x) * (pixel.y - a.y) / (b.y - a.y))
      inside = !inside;
  }
  return inside ? 0.0 : nearest;
}

std::vector<glm::dvec2> samplesOf(const std::vector<glm::dvec2>& points, bool filled) {
  std::vector<glm::dvec2> samples;
  if (points.size() < 2) return samples;
  if (filled) {
    glm::dvec2 center(0.0);
    for (const glm::dvec2& point : points) center += point / static_cast<double>(points.size());
    samples.push_back(center);
    for (const glm::dvec2& point : points) samples.push_back(0.5 * (center + point));
    return samples;
  }
  const int parts = std::max<int>(1, 24 / static_cast<int>(points.size() - 1));
  for (std::size_t i = 0; i + 1 < points.size(); ++i)
    for (int k = 0; k <= parts; ++k)
      samples.push_back(glm::mix(points[i], points[i + 1], static_cast<double>(k) / parts));
  return samples;
}

Stroke tip(const glm::dvec2& from, const glm::dvec2& to, bool arrow, std::uint32_t color) {
  const glm::dvec2 way = to - from;
  const double length = glm::length(way);
  const glm::dvec2 along = length > 0.0 ? way / length : glm::dvec2(1.0, 0.0), side(-along.y, along.x);
  // Foreshortened axes get smaller tips.
  const double size = std::min(8.0, 0.3 * length);
  Stroke stroke;
  stroke.color = color;
  stroke.filled = stroke.closed = true;
  if (arrow)
    stroke.points = {glm::vec2(to + 1.5 * size * along), glm::vec2(to + 0.6 * size * side),
                     glm::vec2(to - 0.6 * size * side)};
  else
    stroke.points = {glm::vec2(to + 0.6 * size * (along + side)), glm::vec2(to + 0.6 * size * (along - side)),
                     glm::vec2(to - 0.6 * size * (along + side)),
                     glm::vec2(to - 0.6 * size * (along - side))};
  return stroke;
}

}  // namespace lambent::editor
