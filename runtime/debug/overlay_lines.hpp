// Boxes and the glyphs of lights as lines, for overlays and for a gizmo. Comes in: boxes and where they
// stand, lights as components. Goes out: lines in world space, appended. No GL; any thread; no errors: what
// is empty adds nothing.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include "runtime/debug/overlay_options.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/shadows/lit_scene.hpp"
#include "runtime/surface/neighborhoods.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

// The twelve edges.
void appendBox(const scene::Box& box, const glm::mat4& world_from_box, const glm::vec4& color,
               std::vector<OverlayLine>& lines);

// Outlines of spheres and discs at their size, a cone for a spot, an arrow for light from infinity, a star
// for a point; size_m is the length of what has none of its own. Lights shine along the node's -Z.
void appendLight(const scene::LocalLightComponent& light, const glm::mat4& world_from_node, float size_m,
                 const glm::vec4& color, std::vector<OverlayLine>& lines);

// How large signs are drawn in this world, metres.
float signSize(const World& world);

struct PlacedBox {
  scene::Box box;
  glm::mat4 world_from_box{1.0f};
  bool wanted = false;
};
// Whether each of the boxes is drawn whole: those that are wanted, and of the others those that meet neither
// a wanted one nor one that is nearer to the eye by its middle. For boxes that overlap, which together would
// hide each other.
std::vector<bool> drawnWhole(const std::vector<PlacedBox>& boxes, const glm::vec3& eye);
// The groups whose neighborhoods are drawn whole (OverlayOptions::foremost_groups), with their slices.
std::vector<std::uint32_t> foremostNeighborhoods(const World& world, const Neighborhoods& neighborhoods,
                                                 const OverlayOptions& options, const glm::vec3& eye);

// Everything that the options ask for and lines can show, those of the options included.
std::vector<OverlayLine> linesOf(const World& world, const Neighborhoods& neighborhoods,
                                 const OverlayOptions& options, const glm::vec3& eye);

}  // namespace lambent::frame
