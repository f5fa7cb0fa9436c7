// Measures and makes lines and polygons in pixels: how far away they are, places on them, tips of axes. Only
// this room uses it.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>

#include "editor/gizmo/painting.hpp"

namespace lambent::editor {

double distanceToLine(const std::vector<glm::dvec2>& points, const glm::dvec2& pixel);
// Returns 0 inside.
double distanceToPolygon(const std::vector<glm::dvec2>& points, const glm::dvec2& pixel);
// Returns some dozen places along the line, or inside the polygon.
std::vector<glm::dvec2> samplesOf(const std::vector<glm::dvec2>& points, bool filled);
// Draws an arrow's head, or a box, at the end of an axis.
Stroke tip(const glm::dvec2& from, const glm::dvec2& to, bool arrow, std::uint32_t color);
// Draws a small filled disc.
Stroke dot(const glm::dvec2& center, double radius, std::uint32_t color);

}  // namespace lambent::editor
