#include "baker/effects/neighborhood/neighborhood.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include <glm/common.hpp>

#include "baker/effects/neighborhood/grid_placement.hpp"
#include "baker/jobs/parallel.hpp"
#include "baker/jobs/stage.hpp"
#include "baker/plan/neighborhoods.hpp"
#include "baker/transport/samples.hpp"
#include "runtime/bundle/container.hpp"
#include "runtime/sh/basis.hpp"

namespace lambent::baker {

namespace {

constexpr std::size_t kCodesPerRange = 256;
constexpr int kMostAttempts = 4;
constexpr double kFiner = 0.6, kLooser = 2.0;  // least factors from one attempt to the next
// A looser bound changes nothing while all the components that are looked for miss it. One just above their
// error makes codes smaller, and soon by much.
constexpr double kBeyondReached = 1.1, kLooserBeyond = 1.2;
// Bound on the error at a point relative to the change there, for points where the change is above a share of
// irradiance, and for most of those points.
constexpr double kOfChange = 0.05, kWhereChanged = 0.02, kPointsWithin = 0.99;
constexpr int kQuickLevel = 3;  // of zstd; the bundle's payloads are compressed better

double bytesOf(const std::vector<CodedTransfer>& coded) {
  std::size_t bytes = 0;
  const auto add = [&](const std::vector<std::byte>& raw) {
    bytes += std::min(raw.size(), bundle::compressZstd(raw, kQuickLevel).size());
  };
  for (const CodedTransfer& part : coded) {
    add(transfer::encodeCodebook(part.codebook));
    add(transfer::encodeClusterIds(part.cluster_of, static_cast<std::uint32_t>(part.codebook.clusters())));
    for (const CodedPlane& plane : part.planes) add(transfer::encodeWeightPlane(plane.codes, plane.bits));
  }
  return static_cast<double>(bytes);
}

// Codes samples [first, first + count) of the grid.
class CellCoder {
 public:
  CellCoder(const GridChange& change, std::size_t first, std::size_t count, const ChangeMeter& meter)
      : shape_(change.shape), meter_(meter), count_(count) {
    const auto part = [&](const std::vector<float>& values, std::size_t size) {
      return std::span(values).subspan(first * size, count * size);
    };
    visibility_ = part(change.visibility, shape_.visibilitySize());
    bounced_ = part(change.bounced, shape_.bouncedSize());
    sends_ = std::any_of(bounced_.begin(), bounced_.end(), [](float value) { return value != 0.0f; });
  }

  // Each part has half of the square error; the bound of bounced light is `looser` times as large.
  std::vector<CodedTransfer> code(double bound, double looser, CachedCoding& coding) const {
    const double energy = meter_.lightEnergy() * static_cast<double>(count_);
    const auto order = static_cast<std::uint32_t>(shape_.order),
               outputs = static_cast<std::uint32_t>(shape_.outputs());
    CodingSettings settings{.bound = static_cast<float>(ofPart(bound)),
                            .shown_energy = energy,
                            .kernel_power = receiverPower(shape_)};
    std::vector<CodedTransfer> coded;
    const transfer::TransferShape visibility{
        .order = order,
        .outputs = outputs,
        .visibility_bands = static_cast<std::uint32_t>(shape_.visibilityBands())};
    coded.push_back(coding.code(visibility_, count_, visibility, settings));
    if (sends_ && !coding.stopped()) {
      const transfer::TransferShape bounced{
          .order = order, .shadowed_channels = 0, .full_channels = shape_.channels, .outputs = outputs};
      settings.bound *= static_cast<float>(looser);
      coded.push_back(coding.code(bounced_, count_, bounced, settings));
    }
    return coded;
  }

  // Returns what `looser` the error of bounced light would keep.
  double looserOf(const std::vector<CodedTransfer>& coded, double bound) const {
    return sends_ ? double{coded[1].error} / ofPart(bound) : 0.0;
  }

  // Returns the error relative to the change that kPointsWithin of the points with more change than
  // kWhereChanged stay below, or 0 if there are no such points.
  double changeError(const std::vector<CodedTransfer>& coded) const {
    std::vector<float> wrong_visibility = decodeTransfer(coded[0]), wrong_bounced;
    for (std::size_t i = 0; i < wrong_visibility.size(); ++i) wrong_visibility[i] -= visibility_[i];
    if (sends_) {
      wrong_bounced = decodeTransfer(coded[1]);
      for (std::size_t i = 0; i < wrong_bounced.size(); ++i) wrong_bounced[i] -= bounced_[i];
    }
    std::vector<double> ratios(count_, -1.0);
    parallelRanges(count_, kCodesPerRange, {}, [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = begin; p < end; ++p) {
        const auto of = [&](std::span<const float> visibility, std::span<const float> bounced) {
          return meter_.measure(visibility.subspan(p * shape_.visibilitySize(), shape_.visibilitySize()),
                                sends_ ? bounced.subspan(p * shape_.bouncedSize(), shape_.bouncedSize())
                                       : std::span<const float>());
        };
        const double change = of(visibility_, bounced_);
        if (change > kWhereChanged) ratios[p] = of(wrong_visibility, wrong_bounced) / change;
      }
    });
    std::erase_if(ratios, [](double ratio) { return ratio < 0.0; });
    if (ratios.empty()) return 0.0;
    const auto at = ratios.begin() +
                    static_cast<std::ptrdiff_t>(std::min(kPointsWithin * static_cast<double>(ratios.size()),
                                                         static_cast<double>(ratios.size() - 1)));
    std::nth_element(ratios.begin(), at, ratios.end());
    return *at;
  }

 private:
  double ofPart(double bound) const { return sends_ ? bound * std::sqrt(0.5) : bound; }

  ChangeShape shape_;
  const ChangeMeter& meter_;
  std::size_t count_;
  std::span<const float> visibility_, bounced_;
  bool sends_ = false;
};

}  // namespace

std::optional<CodedChange> codeChange(const GridChange& change, const GridPlacement& grid,
                                      const glm::vec3& origin, const ChangeCoding& settings,
                                      CachedCoding& coding, Progress& progress) {
  const ChangeMeter meter(change.shape);
  CodedChange out;
  for (std::size_t first = 0; first < grid.count(); first += kMaxCellSamples) {
    const std::size_t count = std::min<std::size_t>(kMaxCellSamples, grid.count() - first);
    const CellCoder coder(change, first, count, meter);
    CodedCell cell;
    cell.count = static_cast<std::uint32_t>(count);
    cell.bounds_min = cell.bounds_max = origin + grid.point(first);
    for (std::size_t p = first; p < first + count; ++p) {
      cell.bounds_min = glm::min(cell.bounds_min, origin + grid.point(p));
      cell.bounds_max = glm::max(cell.bounds_max, origin + grid.point(p));
    }
    bool beyond_reached = false;
    double bound = settings.bound, looser = 1.0, change_error = std::numeric_limits<double>::infinity();
    const double most_bytes = settings.most_bytes * static_cast<double>(count);
    for (int attempt = 0; attempt < kMostAttempts; ++attempt) {
      auto coded = coder.code(bound, looser, coding);
      if (coding.stopped()) return std::nullopt;
      const double bytes = bytesOf(coded);
      const bool fits = bytes <= most_bytes;
      if (!fits && attempt > 0 && looser == 1.0) break;  // the previous attempt stays
      change_error = coder.changeError(coded);
      const double reached = coder.looserOf(coded, bound);
      cell.transfers = std::move(coded);
      if (fits && (looser > 1.0 || change_error <= kOfChange)) break;
      if (fits) {
        bound *= std::min(kFiner, 0.95 * kOfChange / change_error);
      } else if (reached > looser) {
        looser = kBeyondReached * reached;
        beyond_reached = true;
      } else {
        const bool once_more = attempt + 2 < kMostAttempts;
        looser *=
            beyond_reached && once_more ? kLooserBeyond : std::max(kLooser, std::sqrt(bytes / most_bytes));
      }
    }
    double square = 0.0;
    for (const CodedTransfer& coded : cell.transfers) square += double{coded.error} * double{coded.error};
    out.error = std::max(out.error, std::sqrt(square));
    out.change_error = std::max(out.change_error, change_error);
    out.cells.push_back(std::move(cell));
    progress.add(count);
  }
  return out;
}

namespace {

constexpr int kCosineBands = 3;
constexpr double kCosine[kCosineBands] = {1.0, 2.0 / 3.0, 1.0 / 4.0};  // A_l / pi

double cosineOf(std::size_t i) {
  return kCosine[sh::bandOf(static_cast<int>(i))];
}

}  // namespace

ReceiverMeter::ReceiverMeter(const ChangeShape& shape, const FacingArea& facing)
    : shape_(shape), gaunt_(sh::makeGauntTable(shape.order, kCosineBands)) {
  const std::size_t columns = shape.columns();
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
  sh::addVisibilityMatrix(gaunt_, visibility, shadow);
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

}  // namespace

bool findNeighborhood(const BakeContext& context, BakedAround& around) {
  if (!findKept(context, around)) return false;
  around.figures.rays_kept += std::exchange(around.figures.rays, 0);
  return true;
}

std::optional<BakedAround> bakeNeighborhood(const Body& body, const NeighborhoodSettings& settings,
                                            const BakeContext& context) {
  BakedAround out;
  if (findNeighborhood(context, out)) return out;
  out = {};
  const bool all_bands = settings.matrices && body.order() >= kLeastMatrixBands;
  const ChangeShape shape{.order = body.order(),
                          .order_out = all_bands ? body.order() : kDiffuseBands,
                          .channels = body.channels()};
  if (!(body.radius() > 0.0f)) return out;
  context.progress.begin("reach of the neighborhood");
  const CapDirections probe_directions(kProbeRays);
  PointChange probe(body, probe_directions, shape);
  const ReceiverMeter meter(shape, settings.facing);
  const auto placed = placeGrid(settings.placement, [&](const glm::vec3& point) {
    if (context.stopped()) return 0.0;
    probe.look(point);
    return meter.measure(probe.visibility(), probe.bounced());
  });
  if (context.stopped()) return std::nullopt;
  if (!placed) return out;
  const GridPlacement& grid = *placed;
  auto change = changeOnGrid(body, grid, shape, settings.rays, context.part("change"));
  if (!change) return std::nullopt;
  if (settings.fit_between_points) {
    fitBetweenPoints(grid, change->outside, shape.visibilitySize(), change->visibility);
    fitBetweenPoints(grid, change->outside, shape.bouncedSize(), change->bounced);
  }
  context.progress.begin("coding the neighborhood", grid.count(), "points");
  CachedCoding coding(context);
  auto coded = codeChange(*change, grid, settings.origin, settings.coding, coding, context.progress);
  if (!coded) return std::nullopt;
  out.figures = {.inside_points = change->insidePoints(),
                 .rays = change->rays,
                 .rays_kept = change->rays_kept,
                 .error = coded->error,
                 .change_error = coded->change_error};
  out.grid = BakedNeighborhood{.size = grid.size,
                               .bounds_min = settings.origin + grid.box.low,
                               .bounds_max = settings.origin + grid.box.high,
                               .cells = std::move(coded->cells)};
  keepValue(context, out);
  coding.drop();
  dropChange(context.part("change"), grid.count());
  return out;
}

}  // namespace lambent::baker
