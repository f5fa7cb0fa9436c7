// Key lights at infinity as lines for an overlay. Comes in: the key lights, what their shadow maps show, the
// bounds of the world and the view. Goes out: lines in world space, appended: for each key light its outline
// on the sky, an arrow that points into the world the way that it shines, and of some the box that the shadow
// map shows. Weak key lights are fainter than strong ones, and dark ones are grey. No GL; any thread; no
// errors.
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

// The corners of what the map shows: bits 1, 2 and 4 stand for the far end along right, up and towards.
std::array<glm::vec3, 8> cornersOf(const KeyRegion& region);

// keys: world axes. The outline has the key light's angular radius, and at least 1 degree; parallel views see
// one direction only, and have none.
// chosen: the one of the keys whose box is drawn; none: those of the kMostBoxes strongest.
inline constexpr std::size_t kMostBoxes = 4;
void appendKeys(std::span<const spec::Disc> keys, std::span<const KeyShadows::ShownRegion> regions,
                std::optional<std::size_t> chosen, const scene::Box& world, const spec::View& view,
                std::vector<OverlayLine>& lines);

}  // namespace lambent::frame
