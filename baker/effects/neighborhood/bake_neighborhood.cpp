#include "baker/effects/neighborhood/bake_neighborhood.hpp"

#include <algorithm>

#include "baker/effects/neighborhood/fit_between_points.hpp"
#include "baker/effects/neighborhood/receiver_meter.hpp"
#include "baker/jobs/stage.hpp"

namespace lambent::baker {

namespace {

constexpr std::size_t kProbeRays = 256;
constexpr int kLeastMatrixBands = 4;

// Changed holds a grid and the change at its points. The grid is empty if nothing is to be baked.
struct Changed {
  std::optional<GridPlacement> grid;
  std::optional<GridChange> change;
};

std::optional<Changed> changeAround(const Body& body, const NeighborhoodSettings& settings,
                                    const ChangeShape& shape, const BakeContext& context) {
  context.progress.begin("reach of the neighborhood");
  const CapDirections probe_directions(kProbeRays);
  PointChange probe(body, probe_directions, shape);
  const ReceiverMeter meter(shape, settings.facing);
  Changed out;
  out.grid = placeGrid(settings.placement, [&](const glm::vec3& point) {
    if (context.stopped()) return 0.0;
    probe.look(point);
    return meter.measure(probe.visibility(), probe.bounced());
  });
  if (context.stopped()) return std::nullopt;
  if (!out.grid) return out;
  out.change = changeOnGrid(body, *out.grid, shape, settings.rays, context.part("change"));
  if (!out.change) return std::nullopt;
  if (settings.fit_between_points) {
    GridChange& change = *out.change;
    fitBetweenPoints(*out.grid, change.outside, shape.visibilitySize(), change.visibility);
    fitBetweenPoints(*out.grid, change.outside, shape.bouncedSize(), change.bounced);
  }
  return out;
}

}  // namespace

void write(const BakedAround& around, ByteWriter& out) {
  const NeighborhoodFigures& f = around.figures;
  out.add(f.size), out.add(f.bounds_min), out.add(f.bounds_max), out.add(std::uint64_t{f.inside_points});
  out.add(f.rays + f.rays_kept), out.add(f.error), out.add(f.change_error);
  out.add(around.grid.has_value());
  if (!around.grid) return;
  out.add(around.grid->size), out.add(around.grid->bounds_min), out.add(around.grid->bounds_max);
  write(around.grid->cells, out);
}

bool read(ByteReader& in, BakedAround& around) {
  NeighborhoodFigures& f = around.figures;
  std::uint64_t inside = 0;
  bool any = false;
  in.read(f.size), in.read(f.bounds_min), in.read(f.bounds_max), in.read(inside);
  in.read(f.rays_kept), in.read(f.error), in.read(f.change_error);
  f.inside_points = inside;
  if (!in.read(any)) return false;
  if (!any) return true;
  BakedNeighborhood& grid = around.grid.emplace();
  in.read(grid.size), in.read(grid.bounds_min), in.read(grid.bounds_max);
  return read(in, grid.cells);
}

std::optional<BakedAround> bakeNeighborhood(const Body& body, const NeighborhoodSettings& settings,
                                            const BakeContext& context) {
  BakedAround out;
  if (findKept(context, out)) return out;
  out = {};
  const bool all_bands = settings.matrices && body.order() >= kLeastMatrixBands;
  const ChangeShape shape{.order = body.order(),
                          .order_out = all_bands ? body.order() : kDiffuseBands,
                          .channels = body.channels()};
  if (!(body.radius() > 0.0f)) return out;
  const auto changed = changeAround(body, settings, shape, context);
  if (!changed) return std::nullopt;
  if (!changed->grid) return out;
  const GridPlacement& grid = *changed->grid;
  context.progress.begin("coding the neighborhood", grid.count(), "points");
  CachedCoding coding(context);
  auto coded = codeChange(*changed->change, grid, settings.origin, settings.coding, coding, context.progress);
  if (!coded) return std::nullopt;
  out.figures = {.size = grid.size,
                 .bounds_min = settings.origin + grid.box.low,
                 .bounds_max = settings.origin + grid.box.high,
                 .inside_points = changed->change->insidePoints(),
                 .rays = changed->change->rays,
                 .rays_kept = changed->change->rays_kept,
                 .error = coded->error,
                 .change_error = coded->change_error};
  out.grid = BakedNeighborhood{.size = grid.size,
                               .bounds_min = out.figures.bounds_min,
                               .bounds_max = out.figures.bounds_max,
                               .cells = std::move(coded->cells)};
  keepValue(context, out);
  coding.drop();
  dropChange(context.part("change"), grid.count());
  return out;
}

}  // namespace lambent::baker
