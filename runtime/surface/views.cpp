#include "runtime/surface/views.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace lambent::frame {

namespace {

constexpr bool inOrder() {
  for (std::size_t i = 0; i < kSurfaceViews.size(); ++i)
    if (static_cast<std::size_t>(kSurfaceViews[i].view) != i) return false;
  return true;
}
static_assert(inOrder(), "rowOf looks up by the enumeration");

}  // namespace

std::string knownViews() {
  std::string known;
  for (const SurfaceViewRow& row : kSurfaceViews) {
    if (!known.empty()) known += ", ";
    known += row.name;
  }
  return known;
}

Result<ViewChoice> parseView(std::string_view word) {
  const auto row = std::ranges::find(kSurfaceViews, word, &SurfaceViewRow::name);
  if (row == kSurfaceViews.end())
    return fail("view", fmt::format("\"{}\" is not known", word), "give one of " + knownViews());
  return ViewChoice{.view = row->view};
}

std::string wordOf(const ViewChoice& choice) {
  return std::string(rowOf(choice.view).name);
}

ViewLegend legendOf(const ViewChoice& choice, float largest_error) {
  const SurfaceViewRow& row = rowOf(choice.view);
  ViewLegend legend{.name = std::string(row.label), .unit = "", .colors = row.colors};
  switch (choice.view) {
    case SurfaceView::TransferDc:
      legend.unit = "E/pi of the light y_00";
      legend.max = kOpenDc;
      break;
    case SurfaceView::ErrorEstimate:
      legend.unit = "relative RMS";
      legend.max = largest_error > 0.0f ? largest_error : 0.01f;
      break;
    case SurfaceView::Importance:
      legend.unit = "times the mean of pictures, log2";
      legend.min = -8.0f, legend.max = 2.0f;
      break;
    case SurfaceView::Irradiance:
      legend.unit = "E/pi, radiance";
      break;
    case SurfaceView::Final:
    case SurfaceView::Wireframe:
      legend.unit = "radiance";
      break;
    case SurfaceView::ClusterIds:
    case SurfaceView::Normals:
      break;
  }
  return legend;
}

}  // namespace lambent::frame
