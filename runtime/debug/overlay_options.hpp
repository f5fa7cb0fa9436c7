// Defines the options of overlays, which are drawn over a finished picture: light probes as balls,
// slices through neighborhoods, boxes of volumes and groups, lights as glyphs, key lights with what their
// shadow maps show, wires of the triangles, and lines that a caller adds. Overlays use the scene's depth, so
// hidden parts show faintly, and are laid over the tone-mapped picture. The picture keeps its exposure and
// alpha. With all overlays off the picture is unchanged to the last bit, and nothing is held, compiled or
// dispatched for them. docs/views.md explains how to read them. Types and parsing only; parseOverlays() fails
// on unknown names.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/base/result.hpp"

namespace lambent::frame {

// Describes a line in world space. Colours are sRGB with alpha, as picture programs show them.
struct OverlayLine {
  glm::vec3 from_ws{0.0f}, to_ws{0.0f};
  glm::vec4 color{1.0f};
  float width_px = 1.5f;
  bool operator==(const OverlayLine&) const = default;
};

// Describes a plane through the grid of a neighborhood, in the axes of its body.
struct NeighborhoodSlice {
  int axis = 1;           // the axis that it is perpendicular to: 0, 1, 2 for x, y, z
  float position = 0.5f;  // 0: at the first points, 1: at the last
  // The slice shows the change of E/pi at this normal (world axes), or of the mean radiance if it is 0,
  // relative to what arrives there without the body.
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
  // Lists the groups of the residency whose light probes, neighborhoods, volumes and bounds are shown; empty:
  // all.
  std::vector<std::uint32_t> selected_groups{};
  // Among overlapping neighborhoods, those of these groups are drawn whole, and of the rest the one nearest
  // to the eye. The others are faint boxes without slices.
  std::vector<std::uint32_t> foremost_groups{};
  // Holds the index in Environment::keys() of the key light whose shadow map's box is drawn. If there is
  // none, the boxes of the few strongest are drawn, since more would hide each other.
  std::optional<std::size_t> key{};
  std::vector<OverlayLine> lines{};
  bool operator==(const OverlayOptions&) const = default;

  bool any() const {
    return light_probes || neighborhoods || volumes || groups || lights || keys || !lines.empty();
  }
  bool shows(std::uint32_t group) const;
};

std::string knownOverlays();

// Parses comma-separated names; neighborhoods:AXIS,POSITION places the slice.
Result<OverlayOptions> parseOverlays(std::string_view list);

}  // namespace lambent::frame
