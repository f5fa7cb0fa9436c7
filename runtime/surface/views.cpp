#include "runtime/surface/views.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <ranges>

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

// Returns the names of all views, as in "final, irradiance, ...".
std::string knownViews() {
  std::string known;
  for (const SurfaceViewRow& row : kSurfaceViews) {
    if (!known.empty()) known += ", ";
    known += row.name;
    if (row.view == SurfaceView::TransferBand) known += fmt::format("[:0..{}]", kTransferBands - 1);
  }
  return known;
}

}  // namespace

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
  ViewLegend legend{.name = std::string(row.label),
                    .unit = std::string(row.unit),
                    .colors = row.colors,
                    .min = row.min,
                    .max = row.max};
  if (choice.view == SurfaceView::TransferBand) {
    legend.name = fmt::format("Transfer, band {}", choice.band);
    // Bands in which unoccluded surfaces have almost nothing show what shadows do.
    legend.max = std::max(openBandEnergy(choice.band), 0.01f);
  }
  if (choice.view == SurfaceView::ErrorEstimate && largest_error > 0.0f) legend.max = largest_error;
  return legend;
}

namespace {

struct OverlayRow {
  std::string_view name;
  bool OverlayOptions::*flag;
  std::string_view former{};  // its former name, which is still understood; may be empty
};

constexpr std::array<OverlayRow, 6> kOverlays = {
    {{"light-probes", &OverlayOptions::light_probes, "light-samples"},
     {"neighborhoods", &OverlayOptions::neighborhoods},
     {"volumes", &OverlayOptions::volumes},
     {"groups", &OverlayOptions::groups},
     {"lights", &OverlayOptions::lights},
     {"keys", &OverlayOptions::keys}}};

}  // namespace

Result<OverlayOptions> parseOverlays(std::string_view list) {
  OverlayOptions options;
  const auto names = kOverlays | std::views::transform(&OverlayRow::name);
  while (!list.empty()) {
    const std::size_t end = std::min(list.find(','), list.size());
    const std::string_view name = list.substr(0, end);
    const auto row = std::ranges::find_if(kOverlays, [&](const OverlayRow& known) {
      return !name.empty() && (name == known.name || name == known.former);
    });
    if (row == kOverlays.end())
      return fail("overlay", fmt::format("\"{}\" is not known", name),
                  fmt::format("give a list of {}", fmt::join(names, ", ")));
    options.*row->flag = true;
    list.remove_prefix(std::min(end + 1, list.size()));
  }
  return options;
}

}  // namespace lambent::frame
