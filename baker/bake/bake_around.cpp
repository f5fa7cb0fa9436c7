#include "baker/bake/bake_around.hpp"

#include <fmt/format.h>

#include "baker/effects/neighborhood/bake_neighborhood.hpp"

namespace lambent::baker {

namespace {

// Of the bound on coded transfer: a neighborhood is seen against nearly open sky, where errors show.
constexpr double kShareOfBound = 1.0 / 3.0;
// Of the change on the faces of grids around bodies that are moved by hand: these have no more points than
// others, and lie close around the body, where its contact with what it stands on shows.
constexpr double kBoundByHand = 0.03;

void tell(const Around& around, BakedAround baked, BakeReport& report,
          std::optional<BakedNeighborhood>& out) {
  if (!baked.grid) {
    report.notices.push_back(
        fmt::format("rigid group \"{}\": nothing comes within reach of its neighborhood, and none was baked",
                    around.name));
    return;
  }
  out = std::move(baked.grid);
  const NeighborhoodFigures& figures = baked.figures;
  report.rays += figures.rays;
  report.rays_kept += figures.rays_kept;
  report.neighborhoods.push_back({.name = around.name,
                                  .size = figures.size,
                                  .bounds_min = figures.bounds_min,
                                  .bounds_max = figures.bounds_max,
                                  .inside_points = figures.inside_points,
                                  .error = figures.error,
                                  .change_error = figures.change_error});
}

// Of the surfaces that come within reach, from the origin.
std::optional<Box3> receiversOf(const Around& around) {
  if (around.plan.receivers.empty() || around.plan.by_hand) return std::nullopt;
  return Box3{around.plan.receivers_min - around.origin, around.plan.receivers_max - around.origin};
}

}  // namespace

Keep keepOf(const Around& around, Cache* cache, const Key& body) {
  if (!cache) return {};
  const std::optional<Box3> receivers = receiversOf(around);
  KeyMaker key = KeyMaker::ofStage("neighborhood");
  key.add(body).add(around.origin).add(std::uint64_t{around.rays});
  key.add(around.plan.asked)
      .add(around.plan.by_hand)
      .add(around.plan.matrices)
      .add(around.plan.size)
      .add(around.plan.extent);
  key.add(receivers.has_value());
  if (receivers) key.add(receivers->low).add(receivers->high);
  key.add(around.plan.receivers_face);
  key.add(around.options.neighborhood_grid).add(around.options.effectiveErrorBound());
  return {cache, key.key()};
}

bool findAround(const Around& around, const Keep& keep, BakeReport& report,
                std::optional<BakedNeighborhood>& out) {
  auto found = findNeighborhood(keep);
  if (!found) return false;
  tell(around, std::move(*found), report, out);
  return true;
}

bool bakeAround(const Around& around, const Body& body, const Box3& bounds, Progress& progress,
                const std::stop_token& stop, const Keep& keep, BakeReport& report,
                std::optional<BakedNeighborhood>& out) {
  const PlannedNeighborhood& plan = around.plan;
  NeighborhoodSettings settings;
  settings.origin = around.origin;
  settings.matrices = plan.matrices;
  settings.rays = around.rays;
  settings.placement.body = bounds;
  if (const auto receivers = receiversOf(around)) settings.placement.receivers = *receivers;
  settings.facing = plan.receivers_face;
  settings.placement.size = plan.size;
  settings.placement.extent = plan.extent;
  settings.placement.by_length = around.options.neighborhood_grid;
  if (plan.by_hand) settings.placement.bound = kBoundByHand;
  settings.placement.few_points = !plan.asked && !plan.matrices;
  settings.fit_between_points = true;
  settings.coding.bound = kShareOfBound * double{around.options.effectiveErrorBound()};
  auto baked = bakeNeighborhood(body, settings, progress, stop, keep);
  if (!baked) return false;
  tell(around, std::move(*baked), report, out);
  return true;
}

}  // namespace lambent::baker
