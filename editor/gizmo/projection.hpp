// Maps world points to pixels of one view, and pixels to rays, and measures and draws lines and polygons in
// pixels. Pixels count from the top left corner of the window, y down, as in Dear ImGui. Views can be
// perspective or orthographic. It computes in double precision, because handles are dragged by single pixels
// even far from the origin.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "runtime/spec/camera.hpp"

namespace lambent::editor {

struct Viewport {
  float x = 0.0f, y = 0.0f;  // the top left corner
  float width = 1.0f, height = 1.0f;
};

struct Ray {
  glm::dvec3 origin{0.0};
  glm::dvec3 direction{0.0, 0.0, -1.0};  // unit
};

class Projection {
 public:
  Projection() = default;
  Projection(const spec::View& view, const Viewport& viewport);

  const Viewport& viewport() const { return viewport_; }
  // Returns the point's pixel, which may lie outside the viewport, or none if the point is behind the eye.
  std::optional<glm::dvec2> toScreen(const glm::dvec3& point_ws) const;
  Ray ray(const glm::dvec2& pixel) const;
  glm::dvec3 toEye(const glm::dvec3& point_ws) const;
  glm::dvec3 right() const { return right_; }
  glm::dvec3 up() const { return up_; }
  glm::dvec3 back() const { return back_; }
  // Returns how many pixels a metre perpendicular to the view covers at the point's depth; 0 behind the eye.
  double pixelsPerMetre(const glm::dvec3& point_ws) const;

  // Returns the t for which p + t d appears at `coordinate` (in pixels) along the screen direction u. Use it
  // to drag along a line. Returns none if the line is seen end-on, or the result lies behind the eye.
  std::optional<double> alongLine(const glm::dvec3& p, const glm::dvec3& d, const glm::dvec2& u,
                                  double coordinate) const;
  // Returns the t at which the ray hits the plane, or none if they are parallel or the hit lies behind the
  // origin.
  static std::optional<double> hitPlane(const Ray& ray, const glm::dvec3& point, const glm::dvec3& normal);

 private:
  // Returns the pixel in homogeneous coordinates, multiplied by w.
  glm::dvec3 pixelHomogeneous(const glm::dvec4& point) const;

  Viewport viewport_;
  glm::dmat4 clip_from_world_{1.0}, world_from_clip_{1.0};
  glm::dvec3 eye_{0.0}, right_{1.0, 0.0, 0.0}, up_{0.0, 1.0, 0.0}, back_{0.0, 0.0, 1.0};
  bool perspective_ = true;
};

// Describes what gizmos paint, back to front, for ImDrawList or another canvas: a line or a filled polygon
// in pixels.
struct Stroke {
  std::vector<glm::vec2> points;
  std::uint32_t color = 0xffffffff;  // ABGR, alpha on top, as IM_COL32 packs it
  float width_px = 1.0f;             // of lines
  bool closed = false;               // the last point joins the first
  bool filled = false;               // a convex polygon
};

using Painting = std::vector<Stroke>;

constexpr std::uint32_t rgba(unsigned red, unsigned green, unsigned blue, unsigned alpha = 255) {
  return red | green << 8 | blue << 16 | alpha << 24;
}

double distanceToLine(const std::vector<glm::dvec2>& points, const glm::dvec2& pixel);
// Returns the distance in pixels, 0 inside the polygon.
double distanceToPolygon(const std::vector<glm::dvec2>& points, const glm::dvec2& pixel);
// Returns some dozen points on the line, or inside the polygon; none where there are fewer than two points.
std::vector<glm::dvec2> samplesOf(const std::vector<glm::dvec2>& points, bool filled);
// Draws the end of an axis: an arrow head, or a box.
Stroke tip(const glm::dvec2& from, const glm::dvec2& to, bool arrow, std::uint32_t color);

// Follows the pointer during a drag, at a tenth of its way while the user holds the key for fine movements.
class FinePointer {
 public:
  void press(glm::vec2 pixel) { pointer_ = at_ = pixel; }
  // Returns the pixel that counts for the drag when the pointer is at `pixel`.
  glm::vec2 moved(glm::vec2 pixel, bool fine) {
    at_ += (fine ? 0.1f : 1.0f) * (pixel - pointer_);
    pointer_ = pixel;
    return at_;
  }

 private:
  glm::vec2 pointer_{0.0f}, at_{0.0f};
};

}  // namespace lambent::editor
