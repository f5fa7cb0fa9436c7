// What is drawn over a picture that is done: light probes as cubes and balls, slices through neighborhoods,
// boxes of volumes and groups, lights as glyphs, key lights with what their shadow maps show, wires of the
// triangles, and lines that a caller adds. Comes in: the world as the frame shows it. Goes out: a layer with
// the depth of the scene in it, laid over the tone-mapped picture, which keeps its exposure, its alpha and,
// with all overlays off, every bit; parts behind something show faintly. A frame without overlays holds,
// compiles and dispatches nothing for them. Render thread only. Errors: shaders that do not compile on this
// device. docs/views.md says how to read them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/base/result.hpp"

namespace lambent::frame {

// World space. Colours are sRGB values as a picture program shows them, with alpha.
struct OverlayLine {
  glm::vec3 from_ws{0.0f}, to_ws{0.0f};
  glm::vec4 color{1.0f};
  float width_px = 1.5f;
  bool operator==(const OverlayLine&) const = default;
};

// A plane through the grid of a neighborhood, in the axes of its body.
struct NeighborhoodSlice {
  int axis = 1;           // across which it lies: 0, 1, 2 for x, y, z
  float position = 0.5f;  // 0: the first points, 1: the last
  // Change of E/pi at this normal, world; 0: of the mean radiance that arrives. Against what arrives there
  // when nothing stands around.
  glm::vec3 normal_ws{0.0f, 1.0f, 0.0f};
  bool operator==(const NeighborhoodSlice&) const = default;
};

struct OverlayOptions {
  bool light_probes = false;
  bool neighborhoods = false;
  NeighborhoodSlice slice{};
  bool volumes = false;
  bool groups = false;
  bool lights = false;
  bool keys = false;
  // Of light probes, neighborhoods, volumes and groups, these of the residency; empty: all.
  std::vector<std::uint32_t> selected_groups{};
  // Of neighborhoods that overlap, those of these groups are drawn whole; of the others, and where none is
  // given, the one nearest to the eye. The rest are faint boxes without slices.
  std::vector<std::uint32_t> foremost_groups{};
  // Of key lights, in the order of Environment::keys(): the one whose shadow map's box is drawn. None: those
  // of the strongest few, since more would hide each other.
  std::optional<std::size_t> key{};
  std::vector<OverlayLine> lines{};
  bool operator==(const OverlayOptions&) const = default;

  bool any() const {
    return light_probes || neighborhoods || volumes || groups || lights || keys || !lines.empty();
  }
  bool shows(std::uint32_t group) const;
};

struct OverlayRow {
  std::string_view name, label, help;
  bool OverlayOptions::*flag;
};
std::span<const OverlayRow> overlayRows();
std::string knownOverlays();

// Comma-separated names; neighborhoods:AXIS,POSITION says where its slice lies.
Result<OverlayOptions> parseOverlays(std::string_view list);

}  // namespace lambent::frame
