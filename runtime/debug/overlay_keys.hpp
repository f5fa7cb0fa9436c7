// Turns key lights into lines for an overlay. It takes the key lights, what their shadow maps show, the
// bounds of the world and the view, and appends lines in world space: for each key light its outline on the
// sky, an arrow into the world along its light, and for some the box that the shadow map shows. Weak key
// lights are fainter than strong ones, and dark ones are grey. No GL; any thread; no errors.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/debug/overlay_options.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/shadows/key_shadows.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/distant_lights.hpp"

namespace lambent::frame {

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
