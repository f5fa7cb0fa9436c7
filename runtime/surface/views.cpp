#include "runtime/surface/views.hpp"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

namespace lambent::frame {

namespace {

constexpr std::uint32_t kTransferBands = 8;

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
    if (row.view == SurfaceView::TransferBand) known += fmt::format("[:0..{}]", kTransferBands - 1);
  }
  return known;
}

Result<ViewChoice> parseView(std::string_view word) {
  const std::size_t colon = word.find(':');
  const std::string_view name = word.substr(0, colon);
  const auto row = std::ranges::find(kSurfaceViews, name, &SurfaceViewRow::name);
  const auto unknown = [&](const std::string& problem) {
    return fail("view", fmt::format("\"{}\" {}", word, problem), "give one of " + knownViews());
  };
  if (row == kSurfaceViews.end()) return unknown("is not known");
  ViewChoice choice{.view = row->view};
  if (colon == std::string_view::npos) return choice;
  if (row->view != SurfaceView::TransferBand) return unknown("has no bands");
  const std::string_view band = word.substr(colon + 1);
  const auto [end, error] = std::from_chars(band.data(), band.data() + band.size(), choice.band);
  if (error != std::errc{} || end != band.data() + band.size() || choice.band >= kTransferBands)
    return unknown("names no band");
  return choice;
}

std::string wordOf(const ViewChoice& choice) {
  const std::string name(rowOf(choice.view).name);
  return choice.view == SurfaceView::TransferBand ? fmt::format("{}:{}", name, choice.band) : name;
}

ViewLegend legendOf(const ViewChoice& choice, float largest_error) {
  const SurfaceViewRow& row = rowOf(choice.view);
  ViewLegend legend{.name = std::string(row.label), .unit = "", .colors = row.colors};
  switch (choice.view) {
    case SurfaceView::TransferDc:
      legend.unit = "E/pi of the light y_00";
      legend.max = kOpenDc;
      break;
    case SurfaceView::TransferBand:
      legend.name = fmt::format("Transfer, band {}", choice.band);
      legend.unit = "squared E/pi, mean over channels";
      // Bands in which unoccluded surfaces have almost nothing show what shadows do.
      legend.max = std::max(openBandEnergy(choice.band), 0.01f);
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
