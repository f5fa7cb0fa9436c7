#include "baker/bake/bake_around.hpp"

#include <fmt/format.h>

#include "baker/effects/neighborhood/bake_neighborhood.hpp"
#include "baker/effects/neighborhood/volume_body.hpp"

namespace lambent::baker {

namespace {

// A medium has no rims that many rays would have to find, and each ray is a march.
constexpr std::size_t kSampleRaysPerMarch = 4;
// Of the bound on coded transfer: a neighborhood is seen against nearly open sky, where errors show.
constexpr double kShareOfBound = 1.0 / 3.0;

}  // namespace

bool bakeAround(const Body& body, const Box3& bounds, const glm::vec3& origin, const std::string& name,
                const PlannedNeighborhood& plan, std::size_t rays, const BakeOptions& options,
                Progress& progress, const std::stop_token& stop, BakeReport& report,
                std::optional<BakedNeighborhood>& out) {
  NeighborhoodSettings settings;
  settings.origin = origin;
  settings.matrices = plan.matrices;
  settings.rays = rays;
  settings.placement.body = bounds;
  if (!plan.receivers.empty())
    settings.placement.receivers = Box3{plan.receivers_min - origin, plan.receivers_max - origin};
  settings.placement.size = plan.size;
  settings.placement.extent = plan.extent;
  settings.placement.by_length = options.neighborhood_grid;
  settings.placement.few_points = !plan.asked && !plan.matrices;
  settings.coding.bound = kShareOfBound * double{options.effectiveErrorBound()};
  auto baked = bakeNeighborhood(body, settings, progress, stop);
  if (!baked) return false;
  if (!baked->grid) {
    report.notices.push_back(fmt::format(
        "rigid group \"{}\": nothing comes within reach of its neighborhood, and none was baked", name));
    return true;
  }
  out = std::move(baked->grid);
  const NeighborhoodFigures& figures = baked->figures;
  report.rays += figures.rays;
  report.neighborhoods.push_back({.name = name,
                                  .size = figures.size,
                                  .bounds_min = figures.bounds_min,
                                  .bounds_max = figures.bounds_max,
                                  .inside_points = figures.inside_points,
                                  .error = figures.error,
                                  .change_error = figures.change_error});
  return true;
}

bool bakeAroundVolume(BakedGroup& volume, const std::string& name, const PlannedNeighborhood& plan,
                      const BakeOptions& options, Progress& progress, const std::stop_token& stop,
                      BakeReport& report) {
  const auto [low, high] = volume.volume->bounds();
  const VolumeBody body(*volume.volume_light, low, high, /*scatters=*/true);
  return bakeAround(body, Box3{low, high}, glm::vec3(0.0f), name, plan,
                    options.effectiveRays() / kSampleRaysPerMarch, options, progress, stop, report,
                    volume.neighborhood);
}

}  // namespace lambent::baker
