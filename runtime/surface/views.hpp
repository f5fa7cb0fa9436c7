// What a picture shows of surfaces: the final light, or one of the numbers behind it. The table has a row for
// each view, which drives the command line, its help and menus alike. Comes in: words as they are typed. Goes
// out: a ViewChoice for FrameOptions and Frame::setView, and the legend by which a false-coloured picture is
// read. Types and words only, no GL; any thread. Errors: a word that is no view, a band that there is not,
// with what is known. docs/views.md says what each view means.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "runtime/base/result.hpp"

namespace lambent::frame {

enum class SurfaceView : std::uint8_t {
  Final,
  Irradiance,
  TransferDc,
  TransferBand,
  ErrorEstimate,
  ClusterIds,
  Normals,
  Wireframe
};

struct ViewChoice {
  SurfaceView view = SurfaceView::Final;
  std::uint32_t band = 1;  // of TransferBand
  bool operator==(const ViewChoice&) const = default;
};

enum class ViewColors : std::uint8_t {
  Light,      // exposed and tone-mapped as ever
  Scale,      // a value from min to max on viridis; grey where there is none
  Distinct,   // a colour for each number, equal numbers have equal colours
  Directions  // 0.5 n + 0.5
};

struct SurfaceViewRow {
  SurfaceView view;
  std::string_view name;   // on the command line
  std::string_view label;  // in a menu
  std::string_view help;
  ViewColors colors;
};

inline constexpr std::array<SurfaceViewRow, 8> kSurfaceViews = {{
    {SurfaceView::Final, "final", "Final", "the light as it is", ViewColors::Light},
    {SurfaceView::Irradiance, "irradiance", "Irradiance",
     "E/pi that arrives at surfaces, without their own colour", ViewColors::Light},
    {SurfaceView::TransferDc, "transfer-dc", "Transfer, DC",
     "coefficient 0 of the transfer: what of uniform light arrives", ViewColors::Scale},
    {SurfaceView::TransferBand, "transfer-band", "Transfer, band",
     "energy of one band of the transfer: transfer-band:BAND", ViewColors::Scale},
    {SurfaceView::ErrorEstimate, "error", "Coding error",
     "error of the coded transfer, as the bake measured it in each cell", ViewColors::Scale},
    {SurfaceView::ClusterIds, "clusters", "Clusters", "which samples are coded together",
     ViewColors::Distinct},
    {SurfaceView::Normals, "normals", "Normals", "shading normals, world axes", ViewColors::Directions},
    {SurfaceView::Wireframe, "wireframe", "Wireframe", "the triangles over the final picture",
     ViewColors::Light},
}};

constexpr const SurfaceViewRow& rowOf(SurfaceView view) {
  return kSurfaceViews[static_cast<std::size_t>(view)];
}

// NAME or, for the view that has bands, NAME:BAND with 0..7.
Result<ViewChoice> parseView(std::string_view word);
// The same back.
std::string wordOf(const ViewChoice& choice);
// "final, irradiance, ..."
std::string knownViews();

// Whether it shows numbers of the coded transfer, which are then worked out for it.
constexpr bool showsTransfer(SurfaceView view) {
  return view == SurfaceView::TransferDc || view == SurfaceView::TransferBand ||
         view == SurfaceView::ErrorEstimate || view == SurfaceView::ClusterIds;
}
// Whether the picture is of light: with a sky and volumes, exposed and tone-mapped.
constexpr bool showsLight(SurfaceView view) {
  return rowOf(view).colors == ViewColors::Light;
}

struct ViewLegend {
  std::string name, unit;
  ViewColors colors = ViewColors::Light;
  float min = 0.0f, max = 1.0f;  // of Scale; what lies beyond has the colour of the end
  bool operator==(const ViewLegend&) const = default;
};

// largest_error: where the range of that view ends.
ViewLegend legendOf(const ViewChoice& choice, float largest_error);

}  // namespace lambent::frame
