#include "baker/effects/neighborhood/bake_neighborhood.hpp"

#include <algorithm>

namespace lambent::baker {

namespace {

constexpr std::size_t kProbeRays = 256;
constexpr int kDiffuseBands = 3, kLeastMatrixBands = 4;

}  // namespace

std::optional<BakedAround> bakeNeighborhood(const Body& body, const NeighborhoodSettings& settings,
                                            Progress& progress, const std::stop_token& stop) {
  const bool all_bands = settings.matrices && body.order() >= kLeastMatrixBands;
  const ChangeShape shape{.order = body.order(),
                          .order_out = all_bands ? body.order() : kDiffuseBands,
                          .channels = body.channels()};
  BakedAround out;
  if (!(body.radius() > 0.0f)) return out;
  progress.begin("reach of the neighborhood");
  const CapDirections probe_directions(kProbeRays);
  PointChange probe(body, probe_directions, shape);
  const ChangeMeter meter(shape);
  const auto grid = placeGrid(settings.placement, [&](const glm::vec3& point) {
    if (stop.stop_requested()) return 0.0;
    probe.look(point);
    return meter.measure(probe.visibility(), probe.bounced());
  });
  if (stop.stop_requested()) return std::nullopt;
  if (!grid) return out;

  const auto change = changeOnGrid(body, *grid, shape, settings.rays, progress, stop);
  if (!change) return std::nullopt;
  progress.begin("coding the neighborhood", grid->count(), "points");
  auto coded = codeChange(*change, *grid, settings.origin, settings.coding, stop);
  if (!coded) return std::nullopt;
  progress.add(grid->count());
  out.figures = {.size = grid->size,
                 .bounds_min = settings.origin + grid->box.low,
                 .bounds_max = settings.origin + grid->box.high,
                 .inside_points = change->insidePoints(),
                 .rays = change->rays,
                 .error = coded->error,
                 .change_error = coded->change_error};
  out.grid = BakedNeighborhood{.size = grid->size,
                               .bounds_min = out.figures.bounds_min,
                               .bounds_max = out.figures.bounds_max,
                               .cells = std::move(coded->cells)};
  return out;
}

}  // namespace lambent::baker
