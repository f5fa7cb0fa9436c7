#include "baker/effects/neighborhood/light_change.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "baker/jobs/parallel.hpp"
#include "baker/jobs/stage.hpp"
#include "baker/trace/transfer_field.hpp"
#include "baker/transport/samples.hpp"
#include "runtime/sh/basis.hpp"

namespace lambent::baker {

namespace {

// The cap is a little wider, so that rounding leaves no part of the body out.
constexpr double kWider = 1.0 + 1e-3;

}  // namespace

double Cap::steradians() const {
  return 2.0 * std::numbers::pi * past;
}

Cap capOf(const glm::vec3& point, const glm::vec3& centre, float radius) {
  const glm::dvec3 to = glm::dvec3(centre) - glm::dvec3(point);
  const double distance = glm::length(to), wide = kWider * double{radius};
  if (!(distance > wide)) return {};
  const double sine = wide / distance;
  return {.frame = glm::mat3(localFrame(to / distance)),
          .past = sine * sine / (1.0 + std::sqrt(1.0 - sine * sine))};
}

CapDirections::CapDirections(std::size_t rays) {
  // The table's points have z = 1 - r² under Lambert's equal-area map of the disc.
  const DirectionTable table = uniformTable(rays);
  for (std::size_t r = 0; r < table.size(); ++r) {
    const double stretch = std::sqrt(1.0 + double{table.z[r]});
    disc_.emplace_back(double{table.x[r]} / stretch, double{table.y[r]} / stretch);
  }
}

void CapDirections::packet(std::size_t p, const Cap& cap, DirectionPacket& out) const {
  for (std::size_t k = 0; k < kPacketWidth; ++k) {
    const glm::dvec2 at = disc_[p * kPacketWidth + k];
    // The map from the disc to the cap is equal-area too: 1 - z = r² past, and sin = r sqrt(past (2 - r²
    // past)).
    const double below = glm::dot(at, at) * cap.past;
    const double stretch = std::sqrt(std::max(0.0, cap.past * (2.0 - below)));
    out[k] = cap.frame * glm::vec3(static_cast<float>(stretch * at.x), static_cast<float>(stretch * at.y),
                                   static_cast<float>(1.0 - below));
  }
}

namespace {

constexpr double kInsideShare = 0.5;
constexpr BandPower kDiffusePower = {1.0, 4.0 / 9.0, 1.0 / 16.0, 0.0, 1.0 / 576.0, 0.0};
constexpr BandPower kShadowedPower = {1.0, 0.625, 0.25, 0.072, 0.019, 0.01};

}  // namespace

PointChange::PointChange(const Body& body, const CapDirections& directions, const ChangeShape& shape)
    : body_(body),
      directions_(directions),
      shape_(shape),
      harmonics_(shape.visibilitySize() * kPacketWidth),
      visibility_(shape.visibilitySize()),
      bounced_(shape.bouncedSize()),
      sums_(shape.bouncedSize()) {
  assert(shape.channels == 0 || shape.channels == body.channels());
  assert(shape.order == body.order());
  look_.sent.resize(kPacketWidth * shape.channels * shape.columns());
}

void PointChange::look(const glm::vec3& point) {
  cap_ = capOf(point, body_.centre(), body_.radius());
  weight_ = cap_.steradians() / static_cast<double>(directions_.size());
  std::fill(visibility_.begin(), visibility_.end(), 0.0f);
  std::fill(sums_.begin(), sums_.end(), 0.0f);
  backs_ = 0.0;
  nearest_back_ = std::numeric_limits<float>::infinity();
  std::array<float, kPacketWidth> x, y, z;
  for (std::size_t p = 0; p < directions_.packets(); ++p) {
    directions_.packet(p, cap_, along_);
    body_.look(point, along_, p * kPacketWidth, shape_.channels > 0, look_);
    const bool stops =
        std::any_of(look_.stopped.begin(), look_.stopped.end(), [](float s) { return s != 0.0f; });
    if (!stops && look_.sends == 0) continue;
    for (std::size_t k = 0; k < kPacketWidth; ++k) x[k] = along_[k].x, y[k] = along_[k].y, z[k] = along_[k].z;
    sh::evaluateBatch<float>(shape_.visibilityBands(), x.data(), y.data(), z.data(), kPacketWidth,
                             harmonics_.data(), kPacketWidth);
    addVisibility();
    if (shape_.channels > 0 && look_.sends != 0) addBounced();
    backs_ += weight_ * std::popcount(look_.backs);
    if (look_.backs != 0 && look_.nearest_back < nearest_back_)
      nearest_back_ = look_.nearest_back, nearest_point_ = look_.nearest_point,
      nearest_normal_ = look_.nearest_normal;
  }
  const std::size_t columns = shape_.columns(), row = shape_.channels * columns;
  for (std::size_t c = 0; c < shape_.channels; ++c)
    for (std::size_t i = 0; i < shape_.outputs(); ++i)
      for (std::size_t j = 0; j < columns; ++j)
        bounced_[(c * shape_.outputs() + i) * columns + j] = sums_[i * row + c * columns + j];
}

void PointChange::addVisibility() {
  const auto weight = static_cast<float>(weight_);
  for (std::size_t i = 0; i < visibility_.size(); ++i) {
    float sum = 0.0f;
    const float* of = harmonics_.data() + i * kPacketWidth;
    for (std::size_t k = 0; k < kPacketWidth; ++k) sum += of[k] * look_.stopped[k];
    visibility_[i] -= weight * sum;
  }
}

void PointChange::addBounced() {
  const std::size_t row = shape_.channels * shape_.columns();
  const auto weight = static_cast<float>(weight_);
  for (std::uint32_t left = look_.sends; left != 0; left &= left - 1) {
    const auto k = static_cast<std::size_t>(std::countr_zero(left));
    const float* sent = look_.sent.data() + k * row;
    for (std::size_t i = 0; i < shape_.outputs(); ++i) {
      const float factor = weight * harmonics_[i * kPacketWidth + k];
      float* out = sums_.data() + i * row;
      for (std::size_t j = 0; j < row; ++j) out[j] += factor * sent[j];
    }
  }
}

bool PointChange::inside() const {
  return backs_ > kInsideShare * 4.0 * std::numbers::pi;
}

const BandPower& receiverPower(const ChangeShape& shape) {
  return shape.order_out > kDiffuseBands ? kShadowedPower : kDiffusePower;
}

ChangeMeter::ChangeMeter(const ChangeShape& shape)
    : shape_(shape), gaunt_(sh::makeGauntTable(shape.order, shape.order_out)) {
  const std::size_t columns = shape.columns();
  weights_.resize(shape.outputs() * columns);
  for (std::size_t i = 0; i < shape.outputs(); ++i) {
    const auto band_out = static_cast<std::size_t>(sh::bandOf(static_cast<int>(i)));
    for (std::size_t j = 0; j < columns; ++j)
      weights_[i * columns + j] =
          static_cast<float>(receiverPower(shape)[band_out] *
                             kBandPower[static_cast<std::size_t>(sh::bandOf(static_cast<int>(j)))]);
    if (i < columns) light_ += double{weights_[i * columns + i]};
  }
}

double ChangeMeter::measure(std::span<const float> visibility, std::span<const float> bounced) const {
  std::vector<float> shadow(weights_.size(), 0.0f);
  sh::addVisibilityMatrix(gaunt_, visibility, shadow);
  double sum = 0.0;
  const std::size_t channels = bounced.empty() ? 1 : shape_.channels;
  for (std::size_t c = 0; c < channels; ++c)
    for (std::size_t at = 0; at < shadow.size(); ++at) {
      const float change = shadow[at] + (bounced.empty() ? 0.0f : bounced[c * shadow.size() + at]);
      sum += double{weights_[at] * change * change};
    }
  return std::sqrt(sum / (static_cast<double>(channels) * light_));
}

double ChangeMeter::lightEnergy() const {
  return 3.0 * light_;
}

namespace {

constexpr std::size_t kGridPointsPerRange = 64;
// Distance from the surface, relative to the spacing of points, that counts as on the surface.
constexpr float kOnSurface = 1e-3f;

struct Back {
  glm::vec3 point{0.0f}, normal{0.0f};
};

}  // namespace

template <>
inline constexpr bool kPlainBytes<Back> = sizeof(Back) == 6 * sizeof(float);

namespace {

bool besideOutside(const GridPlacement& grid, const std::vector<std::uint8_t>& outside, std::size_t p) {
  const glm::ivec3 size(grid.size);
  const auto index = static_cast<int>(p);
  const glm::ivec3 at(index % size.x, index / size.x % size.y, index / (size.x * size.y));
  for (int z = -1; z <= 1; ++z)
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x) {
        const glm::ivec3 other = glm::clamp(at + glm::ivec3(x, y, z), glm::ivec3(0), size - 1);
        if (outside[static_cast<std::size_t>(other.x + size.x * (other.y + size.y * other.z))]) return true;
      }
  return false;
}

// Continues the values to points inside that are beside points outside. Sets known[p] to 1 if that was
// possible. Returns false if stopped.
bool continueInside(const Body& body, const CapDirections& directions, const GridPlacement& grid,
                    const std::vector<Back>& backs, std::vector<std::uint8_t>& known, GridChange& change,
                    const std::stop_token& stop) {
  std::vector<std::size_t> border;
  for (std::size_t p = 0; p < grid.count(); ++p)
    if (!change.outside[p] && besideOutside(grid, change.outside, p)) border.push_back(p);
  return parallelRanges(border.size(), kGridPointsPerRange, stop, [&](std::size_t begin, std::size_t end) {
    PointChange on(body, directions, change.shape), before(body, directions, change.shape);
    for (std::size_t b = begin; b < end; ++b) {
      const std::size_t p = border[b];
      const glm::vec3 spacing = grid.spacing();
      const float least = kOnSurface * std::min({spacing.x, spacing.y, spacing.z});
      on.look(backs[p].point + least * backs[p].normal);
      if (on.inside()) continue;
      const float behind = glm::distance(backs[p].point, grid.point(p));
      before.look(backs[p].point + std::max(behind, least) * backs[p].normal);
      const auto put = [&](std::span<const float> is, std::span<const float> was, std::vector<float>& all) {
        for (std::size_t i = 0; i < is.size(); ++i)
          all[p * is.size() + i] = before.inside() ? is[i] : 2.0f * is[i] - was[i];
      };
      put(on.visibility(), before.visibility(), change.visibility);
      put(on.bounced(), before.bounced(), change.bounced);
      known[p] = 1;
    }
  });
}

void fillRest(const GridPlacement& grid, const std::vector<std::uint8_t>& known, GridChange& change) {
  const auto size = grid.size;
  SampleEdges edges;
  const std::size_t strides[3] = {1, size.x, std::size_t{size.x} * size.y};
  for (std::size_t p = 0; p < grid.count(); ++p)
    for (int axis = 0; axis < 3; ++axis) {
      if (p / strides[axis] % size[axis] + 1 == size[axis]) continue;
      const std::size_t q = p + strides[axis];
      if (!known[p] || !known[q])
        edges.emplace_back(static_cast<std::uint32_t>(p), static_cast<std::uint32_t>(q));
    }
  if (edges.empty()) return;
  fillFromNeighbours(edges, known, 0, change.shape.visibilitySize(), change.visibility);
  fillFromNeighbours(edges, known, 0, change.shape.bouncedSize(), change.bounced);
}

}  // namespace

std::size_t GridChange::insidePoints() const {
  return static_cast<std::size_t>(std::count(outside.begin(), outside.end(), std::uint8_t{0}));
}

std::optional<GridChange> changeOnGrid(const Body& body, const GridPlacement& grid, const ChangeShape& shape,
                                       std::size_t rays, const BakeContext& context) {
  const CapDirections directions(rays);
  GridChange change{.shape = shape,
                    .visibility = std::vector<float>(grid.count() * shape.visibilitySize()),
                    .bounced = std::vector<float>(grid.count() * shape.bouncedSize()),
                    .outside = std::vector<std::uint8_t>(grid.count())};
  std::vector<Back> backs(grid.count());  // the nearest, of points inside
  const auto compute = [&](std::size_t begin, std::size_t end) {
    PointChange point(body, directions, shape);
    for (std::size_t p = begin; p < end; ++p) {
      point.look(grid.point(p));
      change.outside[p] = !point.inside();
      if (point.inside()) backs[p] = {point.nearestPoint(), point.nearestNormal()};
      std::ranges::copy(point.visibility(), &change.visibility[p * shape.visibilitySize()]);
      if (shape.channels > 0) std::ranges::copy(point.bounced(), &change.bounced[p * shape.bouncedSize()]);
    }
  };
  const auto looked = runStage(
      {.name = "neighborhood",
       .unit = "points",
       .count = grid.count(),
       .grain = kGridPointsPerRange,
       .writes = {rowsOf(change.outside), rowsOf(backs), rowsOf(change.visibility, shape.visibilitySize()),
                  rowsOf(change.bounced, shape.bouncedSize())},
       .compute = compute},
      context);
  if (!looked) return std::nullopt;
  change.rays = looked->computed * directions.size();
  change.rays_kept = looked->found * directions.size();
  std::vector<std::uint8_t> known = change.outside;
  if (!continueInside(body, directions, grid, backs, known, change, context.stop)) return std::nullopt;
  fillRest(grid, known, change);
  return change;
}

void dropChange(const BakeContext& context, std::size_t points) {
  dropStage(context, points, kGridPointsPerRange);
}

}  // namespace lambent::baker
