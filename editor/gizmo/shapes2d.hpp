// Measures and draws lines and polygons in pixels. Only this room uses it.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>

#include "editor/gizmo/painting.hpp"

namespace lambent::editor {

double distanceToLine(const std::vector<glm::dvec2>& points, const glm::dvec2& pixel);
// Returns the distance in pixels, 0 inside the polygon.
double distanceToPolygon(const std::vector<glm::dvec2>& points, const glm::dvec2& pixel);
// Returns some dozen points on the line, or inside the polygon; none where there are fewer than two points.
std::vector<glm::dvec2> samplesOf(const std::vector<glm::dvec2>& points, bool filled);
// Draws the end of an axis: an arrow head, or a box.
Stroke tip(const glm::dvec2& from, const glm::dvec2& to, bool arrow, std::uint32_t color);
// Draws a small filled disc.
Stroke dot(const glm::dvec2& center, double radius, std::uint32_t color);

}  // namespace lambent::editor
