// Describes what gizmos paint: lines and filled polygons in pixels, back to front, for ImDrawList or another
// canvas.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>

namespace lambent::editor {

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

}  // namespace lambent::editor
