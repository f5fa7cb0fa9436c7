#include <optional>

#include <fmt/format.h>

#include "baker/bake/bake_group.hpp"
#include "baker/effects/neighborhood/neighborhood.hpp"
#include "baker/jobs/stage.hpp"

namespace lambent::baker {

namespace {

// Neighborhoods get this share of the bound on coded transfer, since they are seen against nearly open sky,
// where errors show.
constexpr double kShareOfBound = 1.0 / 3.0;
// The bound on the change at the faces of grids around bodies that are moved by hand. These grids have no
// more points than others, and lie close around the body, where its contact with what it stands on shows.
constexpr double kBoundByHand = 0.03;

void take(const Around& around, BakedAround baked, BakedGroup& out) {
  BakeReport& report = around.report;
  const std::string& name = around.bake.plan.groups[around.group].name;
  if (!baked.grid) {
    report.notices.push_back(fmt::format(
        "rigid group \"{}\": nothing comes within reach of its neighborhood, and none was baked", name));
    return;
  }
  out.neighborhood = std::move(baked.grid);
  const NeighborhoodFigures& figures = baked.figures;
  report.rays += figures.rays;
  report.rays_kept += figures.rays_kept;
  report.neighborhoods.push_back({.name = name,
                                  .size = figures.size,
                                  .bounds_min = figures.bounds_min,
                                  .bounds_max = figures.bounds_max,
                                  .inside_points = figures.inside_points,
                                  .error = figures.error,
                                  .change_error = figures.change_error});
}

// Returns the bounds of the surfaces that come within reach, relative to the origin.
std::optional<Box3> receiversOf(const Around& around) {
  const PlannedNeighborhood& plan = around.plan();
  if (plan.receivers.empty() || plan.by_hand) return std::nullopt;
  return Box3{plan.receivers_min - around.origin, plan.receivers_max - around.origin};
}

}  // namespace

BakeContext contextOf(const Around& around, const BakeContext& body) {
  if (!body.keeps()) return body;
  const PlannedNeighborhood& plan = around.plan();
  const BakeOptions& options = around.bake.options;
  const std::optional<Box3> receivers = receiversOf(around);
  KeyMaker key = KeyMaker::ofStage("neighborhood");
  key.add(body.key).add(around.origin).add(std::uint64_t{around.rays});
  key.add(plan.asked).add(plan.by_hand).add(plan.matrices).add(plan.size).add(plan.extent);
  key.add(receivers.has_value());
  if (receivers) key.add(receivers->low).add(receivers->high);
  key.add(plan.receivers_face);
  key.add(options.neighborhood_grid).add(options.effectiveErrorBound());
  return body.keyed(key.key());
}

bool findAround(const Around& around, const BakeContext& context, BakedGroup& out) {
  BakedAround found;
  if (!findKept(context, found)) return false;
  take(around, std::move(found), out);
  return true;
}

bool bakeAround(const Around& around, const Body& body, const Box3& bounds, const BakeContext& context,
                BakedGroup& out) {
  const PlannedNeighborhood& plan = around.plan();
  const BakeOptions& options = around.bake.options;
  NeighborhoodSettings settings;
  settings.origin = around.origin;
  settings.matrices = plan.matrices;
  settings.rays = around.rays;
  settings.placement.body = bounds;
  if (const auto receivers = receiversOf(around)) settings.placement.receivers = *receivers;
  settings.facing = plan.receivers_face;
  settings.placement.size = plan.size;
  settings.placement.extent = plan.extent;
  settings.placement.by_length = options.neighborhood_grid;
  if (plan.by_hand) settings.placement.bound = kBoundByHand;
  settings.placement.few_points = !plan.asked && !plan.matrices;
  settings.fit_between_points = true;
  settings.coding.bound = kShareOfBound * double{options.effectiveErrorBound()};
  auto baked = bakeNeighborhood(body, settings, context);
  if (!baked) return false;
  take(around, std::move(*baked), out);
  return true;
}

}  // namespace lambent::baker
