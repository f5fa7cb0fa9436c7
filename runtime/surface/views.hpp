// Defines what a picture shows of surfaces: the final light, or one of the numbers behind it; and overlays. A
// table has a row for each view, from which the command line, its help and menus are made. It turns typed
// words into a ViewChoice for FrameOptions and Frame::setView, and gives the legend by which a false-coloured
// picture is read. No GL; any thread. docs/views.md says what each view means.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/base/result.hpp"

namespace lambent::frame {

enum class SurfaceView : std::uint8_t {
  Final,
  Irradiance,
  TransferDc,
  ErrorEstimate,
  Importance,
  ClusterIds,
  Normals,
  Wireframe
};

struct ViewChoice {
  SurfaceView view = SurfaceView::Final;
  bool operator==(const ViewChoice&) const = default;
};

enum class ViewColors : std::uint8_t {
  Light,      // exposed and tone-mapped
  Scale,      // viridis from min to max; grey where there is no value
  Distinct,   // a colour per number; equal numbers have equal colours
  Directions  // the colour is 0.5 n + 0.5
};

struct SurfaceViewRow {
  SurfaceView view;
  std::string_view name;   // as typed on the command line
  std::string_view label;  // as shown in a menu
  std::string_view help;
  ViewColors colors;
  std::string_view unit{};
  float min = 0.0f, max = 1.0f;  // range of Scale
};

// The value of an unoccluded surface in TransferDc: E/pi = A_0/pi y_00 under the light whose only coefficient
// is l_00 = 1.
inline constexpr float kOpenDc = 0.28209479177387814f;

inline constexpr std::array<SurfaceViewRow, 8> kSurfaceViews = {{
    {SurfaceView::Final, "final", "Final", "the light as it is", ViewColors::Light, "radiance"},
    {SurfaceView::Irradiance, "irradiance", "Irradiance",
     "E/pi that arrives at surfaces, without their own color", ViewColors::Light, "E/pi, radiance"},
    {SurfaceView::TransferDc, "transfer-dc", "Average visibility",
     "coefficient 0 of the transfer: what of uniform light arrives", ViewColors::Scale,
     "E/pi of the light y_00", 0.0f, kOpenDc},
    {SurfaceView::ErrorEstimate, "error", "Coding error",
     "error of the coded transfer, as the bake measured it in each cell", ViewColors::Scale, "relative RMS",
     0.0f, 0.01f},
    {SurfaceView::Importance, "importance", "Importance",
     "how much the bake took each part of the surfaces to matter to pictures", ViewColors::Scale,
     "times the mean of pictures, log2", -8.0f, 2.0f},
    {SurfaceView::ClusterIds, "clusters", "Clusters", "which samples are coded together",
     ViewColors::Distinct},
    {SurfaceView::Normals, "normals", "Normals", "shading normals, world axes", ViewColors::Directions},
    {SurfaceView::Wireframe, "wireframe", "Wireframe", "the triangles over the final picture",
     ViewColors::Light, "radiance"},
}};

constexpr const SurfaceViewRow& rowOf(SurfaceView view) {
  return kSurfaceViews[static_cast<std::size_t>(view)];
}

// Fails, naming what is known, if there is no such view.
Result<ViewChoice> parseView(std::string_view word);
// Returns the word that parseView() accepts for the choice.
std::string wordOf(const ViewChoice& choice);

// Returns whether the view shows numbers of the coded transfer, which are then computed for it.
constexpr bool showsTransfer(SurfaceView view) {
  return rowOf(view).colors == ViewColors::Scale || rowOf(view).colors == ViewColors::Distinct;
}
// Returns whether the picture shows light, and so has a sky and volumes and is exposed and tone-mapped.
constexpr bool showsLight(SurfaceView view) {
  return rowOf(view).colors == ViewColors::Light;
}

struct ViewLegend {
  std::string name, unit;
  ViewColors colors = ViewColors::Light;
  float min = 0.0f, max = 1.0f;  // range of Scale; values beyond it have the colour of its end
  bool operator==(const ViewLegend&) const = default;
};

// `largest_error` is the end of the range of ErrorEstimate.
ViewLegend legendOf(const ViewChoice& choice, float largest_error);

// Describes a line in world space. Colours are sRGB with alpha, as picture programs show them.
struct OverlayLine {
  glm::vec3 from_ws{0.0f}, to_ws{0.0f};
  glm::vec4 color{1.0f};
  float width_px = 1.5f;
  bool operator==(const OverlayLine&) const = default;
};

// Lists what is drawn over a finished picture: light probes as balls, boxes of neighborhoods, volumes and
// groups, lights as glyphs, key lights, and lines that a caller adds. Overlays use the scene's depth, so
// hidden parts show faintly, and are laid over the tone-mapped picture. The picture keeps its exposure and
// alpha. With all overlays off the picture is unchanged to the last bit, and nothing is held, compiled or
// dispatched for them.
struct OverlayOptions {
  bool light_probes = false;
  bool neighborhoods = false;
  bool volumes = false;
  bool groups = false;
  bool lights = false;
  bool keys = false;
  std::vector<OverlayLine> lines{};
  bool operator==(const OverlayOptions&) const = default;

  bool any() const {
    return light_probes || neighborhoods || volumes || groups || lights || keys || !lines.empty();
  }
};

// Parses comma-separated names. Fails if one is not known.
Result<OverlayOptions> parseOverlays(std::string_view list);

}  // namespace lambent::frame
