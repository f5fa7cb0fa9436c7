// Turns boxes and lights into lines, for overlays and for a gizmo. It takes placed boxes and light
// components, and appends lines in world space. No GL; any thread; no errors: empty input adds nothing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/debug/overlay_options.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/shadows/key_shadows.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/distant_lights.hpp"
#include "runtime/surface/neighborhoods.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

// Appends the twelve edges.
void appendBox(const scene::Box& box, const glm::mat4& world_from_box, const glm::vec4& color,
               std::vector<OverlayLine>& lines);

// Appends the outline of a sphere or disc at its size, a cone for a spot, an arrow for a directional light,
// or a star for a point light. size_m is the length used for what has no size of its own. Lights shine along
// the node's -Z.
void appendLight(const scene::LocalLightComponent& light, const glm::mat4& world_from_node, float size_m,
                 const glm::vec4& color, std::vector<OverlayLine>& lines);

// Returns the size of glyphs in this world, in metres.
float signSize(const World& world);

struct PlacedBox {
  scene::Box box;
  glm::mat4 world_from_box{1.0f};
  bool wanted = false;
};
// Returns for each box whether it is drawn whole: all wanted boxes, and those others that overlap neither a
// wanted box nor one whose centre is nearer to the eye. Boxes that overlap would hide each other.
std::vector<bool> drawnWhole(const std::vector<PlacedBox>& boxes, const glm::vec3& eye);
// Returns the groups whose neighborhoods are drawn whole (OverlayOptions::foremost_groups), with their
// slices.
std::vector<std::uint32_t> foremostNeighborhoods(const World& world, const Neighborhoods& neighborhoods,
                                                 const OverlayOptions& options, const glm::vec3& eye);

// Returns the lines for everything that the options ask for and lines can show, including the options' own
// lines.
std::vector<OverlayLine> linesOf(const World& world, const Neighborhoods& neighborhoods,
                                 const OverlayOptions& options, const glm::vec3& eye);

// Turns key lights into lines for an overlay. It takes the key lights, what their shadow maps show, the
// bounds of the world and the view, and appends lines in world space: for each key light its outline on the
// sky, an arrow into the world along its light, and for some the box that the shadow map shows. Weak key
// lights are fainter than strong ones, and dark ones are grey. No GL; any thread; no errors.

// Returns the corners of what the map shows. Bits 1, 2 and 4 of the index select the far end along right, up
// and towards.
std::array<glm::vec3, 8> cornersOf(const KeyRegion& region);

// Appends the lines. `keys` are in world axes. The outline has the key light's angular radius, but at least 1
// degree; parallel views see a single direction and have none. `chosen` is the key whose box is drawn;
// without it, the boxes of the kMostBoxes strongest are drawn.
inline constexpr std::size_t kMostBoxes = 4;
void appendKeys(std::span<const spec::Disc> keys, std::span<const KeyShadows::ShownRegion> regions,
                std::optional<std::size_t> chosen, const scene::Box& world, const spec::View& view,
                std::vector<OverlayLine>& lines);

}  // namespace lambent::frame
