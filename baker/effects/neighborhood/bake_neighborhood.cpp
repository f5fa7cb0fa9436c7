#include "baker/effects/neighborhood/bake_neighborhood.hpp"

#include <algorithm>

#include "baker/effects/neighborhood/fit_between_points.hpp"
#include "baker/effects/neighborhood/receiver_meter.hpp"

namespace lambent::baker {

namespace {

constexpr std::size_t kProbeRays = 256;
constexpr int kDiffuseBands = 3, kLeastMatrixBands = 4;

void write(const BakedAround& around, ByteWriter& out) {
  const NeighborhoodFigures& f = around.figures;
  out.add(f.size), out.add(f.bounds_min), out.add(f.bounds_max), out.add(std::uint64_t{f.inside_points});
  out.add(f.rays + f.rays_kept), out.add(f.error), out.add(f.change_error);
  out.add(around.grid.has_value());
  if (!around.grid) return;
  out.add(around.grid->size), out.add(around.grid->bounds_min), out.add(around.grid->bounds_max);
  out.add(std::uint64_t{around.grid->cells.size()});
  for (const CodedCell& cell : around.grid->cells) {
    out.add(cell.count), out.add(cell.bounds_min), out.add(cell.bounds_max);
    out.add(std::uint64_t{cell.transfers.size()});
    for (const CodedTransfer& transfer : cell.transfers) write(transfer, out);
  }
}

bool read(ByteReader& in, BakedAround& around) {
  NeighborhoodFigures& f = around.figures;
  std::uint64_t inside = 0, cells = 0, transfers = 0;
  bool any = false;
  in.read(f.size), in.read(f.bounds_min), in.read(f.bounds_max), in.read(inside);
  in.read(f.rays_kept), in.read(f.error), in.read(f.change_error);
  f.inside_points = inside;
  if (!in.read(any)) return false;
  if (!any) return true;
  BakedNeighborhood& grid = around.grid.emplace();
  in.read(grid.size), in.read(grid.bounds_min), in.read(grid.bounds_max);
  if (!in.read(cells)) return false;
  for (std::uint64_t c = 0; c < cells; ++c) {
    CodedCell& cell = grid.cells.emplace_back();
    in.read(cell.count), in.read(cell.bounds_min), in.read(cell.bounds_max);
    if (!in.read(transfers)) return false;
    for (std::uint64_t t = 0; t < transfers; ++t)
      if (!read(in, cell.transfers.emplace_back())) return false;
  }
  return true;
}

// Grid, and what changes on it; the grid has no points where nothing is to be baked.
struct Changed {
  std::optional<GridPlacement> grid;
  std::optional<GridChange> change;
};

std::optional<Changed> changeAround(const Body& body, const NeighborhoodSettings& settings,
                                    const ChangeShape& shape, Progress& progress, const std::stop_token& stop,
                                    const Keep& keep) {
  progress.begin("reach of the neighborhood");
  const CapDirections probe_directions(kProbeRays);
  PointChange probe(body, probe_directions, shape);
  const ReceiverMeter meter(shape, settings.facing);
  Changed out;
  out.grid = placeGrid(settings.placement, [&](const glm::vec3& point) {
    if (stop.stop_requested()) return 0.0;
    probe.look(point);
    return meter.measure(probe.visibility(), probe.bounced());
  });
  if (stop.stop_requested()) return std::nullopt;
  if (!out.grid) return out;
  out.change = changeOnGrid(body, *out.grid, shape, settings.rays, progress, stop, keep.part("change"));
  if (!out.change) return std::nullopt;
  if (settings.fit_between_points) {
    GridChange& change = *out.change;
    fitBetweenPoints(*out.grid, change.outside, shape.visibilitySize(), change.visibility);
    fitBetweenPoints(*out.grid, change.outside, shape.bouncedSize(), change.bounced);
  }
  return out;
}

}  // namespace

std::optional<BakedAround> findNeighborhood(const Keep& keep) {
  if (!keep.cache) return std::nullopt;
  const auto bytes = keep.cache->find(keep.key);
  if (!bytes) return std::nullopt;
  ByteReader in(*bytes);
  BakedAround found;
  if (!read(in, found) || !in.atEnd()) return std::nullopt;
  return found;
}

std::optional<BakedAround> bakeNeighborhood(const Body& body, const NeighborhoodSettings& settings,
                                            Progress& progress, const std::stop_token& stop,
                                            const Keep& keep) {
  if (auto found = findNeighborhood(keep)) return found;
  const bool all_bands = settings.matrices && body.order() >= kLeastMatrixBands;
  const ChangeShape shape{.order = body.order(),
                          .order_out = all_bands ? body.order() : kDiffuseBands,
                          .channels = body.channels()};
  BakedAround out;
  if (!(body.radius() > 0.0f)) return out;
  const auto changed = changeAround(body, settings, shape, progress, stop, keep);
  if (!changed) return std::nullopt;
  if (!changed->grid) return out;
  const GridPlacement& grid = *changed->grid;
  progress.begin("coding the neighborhood", grid.count(), "points");
  CachedCoding coding(keep.cache);
  auto coded = codeChange(*changed->change, grid, settings.origin, settings.coding, coding, stop);
  if (!coded) return std::nullopt;
  progress.add(grid.count());
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
  if (keep.cache) {
    ByteWriter bytes;
    write(out, bytes);
    keep.cache->put(keep.key, bytes.bytes());
    coding.drop();
    dropChange(keep.part("change"), grid.count());
  }
  return out;
}

}  // namespace lambent::baker
