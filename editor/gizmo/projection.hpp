// Maps between the world and the pixels of one view: tells where a point is seen, and which ray a pixel looks
// along.
// Pixels count from the top left corner of the window that the viewport lies in, y down, as windows and Dear
// ImGui have them. It takes perspective and orthographic views alike, and computes in double precision:
// handles are dragged by single pixels far from the origin, too.
#pragma once

#include <optional>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "runtime/spec/camera.hpp"

namespace lambent::editor {

struct Viewport {
  float x = 0.0f, y = 0.0f;  // its top left corner
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
  bool perspective() const { return perspective_; }
  // Returns none behind the eye. Points beyond the picture's edges are given.
  std::optional<glm::dvec2> toScreen(const glm::dvec3& point_ws) const;
  Ray ray(const glm::dvec2& pixel) const;
  // Returns the unit direction from the point to the eye.
  glm::dvec3 toEye(const glm::dvec3& point_ws) const;
  glm::dvec3 eye() const { return eye_; }
  glm::dvec3 right() const { return right_; }
  glm::dvec3 up() const { return up_; }
  glm::dvec3 back() const { return back_; }
  // Returns how many pixels a metre across the view takes at the point's depth; 0 behind the eye.
  double pixelsPerMetre(const glm::dvec3& point_ws) const;

  // Returns the t at which p + t d is seen at `coordinate` along the screen direction u (both in pixels):
  // where a line is dragged to. Returns none where the line is seen from its end, or the place lies behind
  // the eye.
  std::optional<double> alongLine(const glm::dvec3& p, const glm::dvec3& d, const glm::dvec2& u,
                                  double coordinate) const;
  // Returns the t at which the ray meets the plane, or none where they run along each other or it lies
  // behind.
  static std::optional<double> hitPlane(const Ray& ray, const glm::dvec3& point, const glm::dvec3& normal);

 private:
  // In pixels times w.
  glm::dvec3 pixelHomogeneous(const glm::dvec4& point) const;

  Viewport viewport_;
  glm::dmat4 clip_from_world_{1.0}, world_from_clip_{1.0};
  glm::dvec3 eye_{0.0}, right_{1.0, 0.0, 0.0}, up_{0.0, 1.0, 0.0}, back_{0.0, 0.0, 1.0};
  bool perspective_ = true;
};

}  // namespace lambent::editor
