#include "baker/effects/neighborhood/neighborhood.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "baker/effects/neighborhood/grid_placement.hpp"
#include "baker/jobs/stage.hpp"
#include "baker/plan/counted.hpp"
#include "baker/plan/neighborhoods.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/gaunt.hpp"

namespace lambent::baker {

EffectChoice chooseNeighborhood(const Scene& scene, const std::vector<RigidGroup>& groups) {
  const std::vector<PlannedNeighborhood> plans = planNeighborhoods(scene, groups);
  std::vector<std::string> names;
  std::string against;
  for (std::size_t k = 0; k < groups.size(); ++k) {
    if (plans[k].baked)
      names.push_back(groups[k].name);
    else if (against.empty() && !plans[k].reason.empty())
      against = fmt::format("{}: {}", groups[k].name, plans[k].reason);
  }
  if (names.empty())
    return {
        "neighborhood", false,
        against.empty() ? "no body comes within the bounds of a group of more than twice its size" : against};
  return {
      "neighborhood", true,
      fmt::format("grids of matrices around {}: their shadows, and light that they reflect, on what comes "
                  "near",
                  fmt::join(names, ", "))};
}

namespace {

constexpr int kCosineBands = 3;
constexpr double kCosine[kCosineBands] = {1.0, 2.0 / 3.0, 1.0 / 4.0};  // A_l / pi

double cosineOf(std::size_t i) {
  return kCosine[sh::bandOf(static_cast<int>(i))];
}

}  // namespace

ReceiverMeter::ReceiverMeter(const ChangeShape& shape, const FacingArea& facing) : shape_(shape) {
  const std::size_t columns = shape.columns();
  const sh::GauntTable gaunt = sh::makeGauntTable(shape.order, kCosineBands);
  for (std::size_t i = 0; i < kOutputs; ++i)
    for (std::uint32_t t = gaunt.offsets[i]; t < gaunt.offsets[i + 1]; ++t)
      terms_.push_back({static_cast<std::uint32_t>(i * columns) + gaunt.terms[t].j, gaunt.terms[t].k,
                        gaunt.terms[t].value});
  for (std::size_t j = 0; j < columns; ++j)
    light_power_.push_back(kBandPower[static_cast<std::size_t>(sh::bandOf(static_cast<int>(j)))]);

  // The product of two functions of three bands has five, which is what `facing` has.
  constexpr double kY0 = 0.28209479177387814;
  const double area = double{facing[0]} / kY0;
  for (auto& row : seen_) row.fill(0.0);
  const sh::GauntTable products = sh::makeGauntTable(kCosineBands, kCosineBands);
  for (std::size_t i = 0; i < kOutputs; ++i)
    for (std::uint32_t t = products.offsets[i]; t < products.offsets[i + 1]; ++t) {
      const sh::GauntTerm& term = products.terms[t];
      const double mean = area > 0.0 ? double{facing[term.k]} / area : term.k == 0 ? kY0 : 0.0;
      seen_[i][term.j] += cosineOf(i) * cosineOf(term.j) * double{term.value} * mean;
    }
  for (std::size_t i = 0; i < kOutputs && i < columns; ++i)
    light_ += light_power_[i] * cosineOf(i) * cosineOf(i) / (4.0 * std::numbers::pi);
}

double ReceiverMeter::measure(std::span<const float> visibility, std::span<const float> bounced) const {
  const std::size_t columns = shape_.columns();
  std::vector<float> shadow(kOutputs * columns, 0.0f);
  for (const Term& term : terms_) shadow[term.at] += term.value * visibility[term.k];
  const std::size_t channels = bounced.empty() ? 1 : shape_.channels;
  double sum = 0.0;
  for (std::size_t c = 0; c < channels; ++c)
    for (std::size_t j = 0; j < columns; ++j) {
      std::array<double, kOutputs> change;
      for (std::size_t i = 0; i < kOutputs; ++i) {
        change[i] = double{shadow[i * columns + j]};
        if (!bounced.empty()) change[i] += double{bounced[(c * shape_.outputs() + i) * columns + j]};
      }
      for (std::size_t i = 0; i < kOutputs; ++i)
        for (std::size_t k = 0; k < kOutputs; ++k)
          sum += light_power_[j] * seen_[i][k] * change[i] * change[k];
    }
  return std::sqrt(std::max(sum, 0.0) / (static_cast<double>(channels) * light_));
}

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
