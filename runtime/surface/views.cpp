#include "runtime/surface/views.hpp"

#include <algorithm>
#include <array>
#include <ranges>

#include <fmt/format.h>

namespace lambent::frame {

namespace {

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
  }
  return known;
}

}  // namespace

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
  ViewLegend legend{.name = std::string(row.label),
                    .unit = std::string(row.unit),
                    .colors = row.colors,
                    .min = row.min,
                    .max = row.max};
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
