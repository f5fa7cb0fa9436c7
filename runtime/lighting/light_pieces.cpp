#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numeric>

#include <glm/geometric.hpp>

#include "runtime/lighting/key_lights.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::lighting {

namespace {

using sh::kPi;

// Returns p_l; see the header.
double transferPower(int l) {
  return l == 0 ? 1.0 : std::pow(l + 0.5, -3.0);
}

// Holds the normalised associated Legendre functions at the centres of the rows, times sqrt(4pi) so that band
// 0 is 1, and with the sqrt(2) of m > 0 (their sign does not matter here); and the cosine and sine of m times
// the azimuth.
struct Tables {
  static constexpr int kBands = FluxGrid::kBands;
  static constexpr std::size_t kRows = FluxGrid::kRows, kColumns = FluxGrid::kColumns;
  std::array<std::array<std::array<double, kRows>, kBands>, kBands> legendre{};  // [m][l][row]
  std::array<std::array<double, kColumns>, kBands> cosines{}, sines{};           // [m][column]

  Tables() {
    for (unsigned m = 0; m < kBands; ++m)
      for (unsigned l = m; l < kBands; ++l)
        for (std::size_t row = 0; row < kRows; ++row)
          legendre[m][l][row] = std::sqrt((m > 0 ? 8.0 : 4.0) * kPi) *
                                std::sph_legendre(l, m, kPi * (static_cast<double>(row) + 0.5) / kRows);
    for (std::size_t m = 0; m < cosines.size(); ++m)
      for (std::size_t x = 0; x < kColumns; ++x) {
        const double angle = 2 * kPi * static_cast<double>(m * x % kColumns) / kColumns;
        cosines[m][x] = std::cos(angle);
        sines[m][x] = std::sin(angle);
      }
  }
};

const Tables& tables() {
  static const Tables made;
  return made;
}

}  // namespace

FluxGrid::Place FluxGrid::place(const glm::dvec3& dir) {
  const double azimuth = std::atan2(dir.z, dir.x), polar = std::atan2(std::hypot(dir.x, dir.z), dir.y);
  const double x = (0.5 + azimuth / (2 * kPi)) * kColumns - 0.5, y = polar / kPi * kRows - 0.5;
  const double left = std::floor(x), top = std::floor(y);
  Place at;
  for (int corner = 0; corner < 4; ++corner) {
    const int right = corner & 1, below = corner >> 1;
    int column = static_cast<int>(left) + right, row = static_cast<int>(top) + below;
    if (row < 0 || row >= kRows) {  // beyond a pole
      row = std::clamp(row, 0, kRows - 1);
      column += kColumns / 2;
    }
    column = (column + 2 * kColumns) % kColumns;
    const auto i = static_cast<std::size_t>(corner);
    at.cells[i] = static_cast<std::uint16_t>(row * kColumns + column);
    at.shares[i] = static_cast<float>((right ? x - left : left + 1 - x) * (below ? y - top : top + 1 - y));
  }
  return at;
}

double FluxGrid::flux() const {
  double sum = 0.0;
  for (const double cell : cells_) sum += cell;
  return sum;
}

double FluxGrid::lostPower(int first_band) const {
  const Tables& table = tables();
  std::vector<double> even(kRows), odd(kRows);
  double lost = 0.0;
  for (int m = 0; m < kBands; ++m) {
    const auto& cosines = table.cosines[static_cast<std::size_t>(m)];
    const auto& sines = table.sines[static_cast<std::size_t>(m)];
    for (std::size_t row = 0; row < kRows; ++row) {
      const double* cells = cells_.data() + row * kColumns;
      double even_sum = 0.0, odd_sum = 0.0;
      for (std::size_t x = 0; x < kColumns; ++x) {
        even_sum += cells[x] * cosines[x];
        odd_sum += cells[x] * sines[x];
      }
      even[row] = even_sum;
      odd[row] = odd_sum;
    }
    for (int l = std::max(m, first_band); l < kBands; ++l) {
      const auto& legendre = table.legendre[static_cast<std::size_t>(m)][static_cast<std::size_t>(l)];
      double a = 0.0, b = 0.0;
      for (std::size_t row = 0; row < kRows; ++row) {
        a += legendre[row] * even[row];
        b += legendre[row] * odd[row];
      }
      lost += transferPower(l) * (a * a + b * b);
    }
  }
  return lost;
}

double discLoss(int order, double radius_rad) {
  const double radius = std::max(radius_rad, 1e-5);  // approaches a point
  const double mean = sh::discZonal(0, radius);
  double lost = 0.0;
  for (int l = order; l < FluxGrid::kBands; ++l) {
    const double zonal = sh::discZonal(l, radius) / mean;
    lost += transferPower(l) * zonal * zonal;
  }
  return std::sqrt(lost);
}

namespace {

using sh::kPi;
constexpr int kShifts = 4, kRounds = 8;
constexpr std::size_t kSeeds = 64;  // more than the pieces wanted
// Discs side by side leave gaps, so a piece also takes the light in the gaps around it.
constexpr double kReach = 1.25;

LightPiece pieceFrom(const LightMoment& sum) {
  return {sum.direction(), sum.flux, sum.radius()};
}

// Moves each piece repeatedly to the centre of the points that are nearest to it (k-means).
template <typename Owner>
void settle(std::span<const LightPoint> points, std::vector<LightPiece>& pieces, Owner&& owner) {
  for (int round = 0; round < kRounds; ++round) {
    std::vector<LightMoment> sums(pieces.size());
    for (const LightPoint& point : points)
      if (const std::optional<std::size_t> i = owner(point.dir)) sums[*i].add(point.dir, point.flux);
    for (std::size_t i = 0; i < pieces.size(); ++i)
      if (sums[i].flux > 0.0) pieces[i] = pieceFrom(sums[i]);
  }
}

std::optional<std::size_t> nearest(std::span<const LightPiece> pieces, const glm::dvec3& dir,
                                   double cos_reach) {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < pieces.size(); ++i)
    if (const double cosine = glm::dot(pieces[i].dir, dir); cosine >= cos_reach) {
      cos_reach = cosine;
      found = i;
    }
  return found;
}

}  // namespace

glm::dvec3 LightMoment::direction() const {
  const double length = glm::length(moment);
  return length > 0.0 ? moment / length : glm::dvec3(0.0, 1.0, 0.0);
}

double LightMoment::radius() const {
  if (flux <= 0.0) return 0.0;
  return std::acos(std::clamp(2.0 * glm::length(moment) / flux - 1.0, -1.0, 1.0));
}

std::optional<std::size_t> pieceOf(std::span<const LightPiece> pieces, const PieceLimits& limits,
                                   const glm::dvec3& dir) {
  return nearest(pieces, dir, std::cos(std::min(kReach * limits.radius_rad, kPi)));
}

// Seeds are the brightest points that belong to no piece yet; each moves uphill to the centre of the light
// around it and takes that light. There are more seeds than wanted pieces, since a wide piece need not have a
// bright point.
std::vector<LightPiece> gatherPieces(std::span<const LightPoint> points, const PieceLimits& limits) {
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return points[a].flux > points[b].flux; });
  std::vector<std::uint32_t> open = order;
  std::vector<LightPiece> pieces;
  const double cos_radius = std::cos(std::min(limits.radius_rad, kPi));
  double left = 0.0;
  for (const LightPoint& point : points) left += point.flux;
  while (!open.empty() && left > limits.least_flux && pieces.size() < kSeeds + limits.most) {
    glm::dvec3 middle = points[open.front()].dir;
    LightMoment sum;
    for (int shift = 0; shift < kShifts; ++shift) {
      sum = {};
      for (const std::uint32_t i : open)
        if (glm::dot(points[i].dir, middle) >= cos_radius) sum.add(points[i].dir, points[i].flux);
      if (sum.flux <= 0.0) break;
      if (shift + 1 < kShifts) middle = sum.direction();
    }
    const std::size_t before = open.size();
    const std::uint32_t seed = open.front();
    std::erase_if(
        open, [&](std::uint32_t i) { return i == seed || glm::dot(points[i].dir, middle) >= cos_radius; });
    left -= sum.flux;
    if (sum.flux > limits.least_flux) pieces.push_back(pieceFrom(sum));
    if (open.size() == before) break;
  }

  const auto rank = [&] {
    std::vector<std::pair<double, LightPiece>> ranked;
    for (const LightPiece& piece : pieces)
      if (piece.flux > limits.least_flux)
        ranked.emplace_back(piece.flux * discLoss(limits.order, piece.radius_rad), piece);
    std::stable_sort(ranked.begin(), ranked.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    pieces.clear();
    for (const auto& [loss, piece] : ranked)
      if (pieces.size() < limits.most) pieces.push_back(piece);
  };
  rank();
  settle(points, pieces, [&](const glm::dvec3& dir) { return pieceOf(pieces, limits, dir); });
  rank();
  return pieces;
}

namespace {

std::vector<LightPoint> spiral(const LightPiece& disc, std::size_t count) {
  const auto& [dir, flux, radius_rad] = disc;
  const glm::dvec3 side = std::abs(dir.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  const glm::dvec3 right = glm::normalize(glm::cross(dir, side)), up = glm::cross(right, dir);
  const double golden_angle = kPi * (3.0 - std::sqrt(5.0));
  const double half = std::sin(radius_rad / 2), depth = 2 * half * half;  // 1 - cos(radius)
  std::vector<LightPoint> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double below = depth * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double out = std::sqrt(below * (2.0 - below)), angle = golden_angle * static_cast<double>(i);
    points[i].dir =
        glm::normalize((1.0 - below) * dir + out * (std::cos(angle) * right + std::sin(angle) * up));
    points[i].flux = flux / static_cast<double>(count);
    points[i].at = FluxGrid::place(points[i].dir);
  }
  return points;
}

std::vector<DiscPiece> dividedInto(const LightPiece& disc, std::size_t count) {
  const std::vector<LightPoint> points = spiral(disc, 256 * count);
  std::vector<LightPiece> pieces;
  for (const LightPoint& point : spiral(disc, count)) pieces.push_back({point.dir, point.flux, 0.0});
  settle(points, pieces, [&](const glm::dvec3& dir) { return nearest(pieces, dir, -1.0); });
  std::vector<DiscPiece> divided(count);
  std::vector<LightMoment> sums(count);
  for (const LightPoint& point : points) {
    const std::size_t i = nearest(pieces, point.dir, -1.0).value_or(0);
    sums[i].add(point.dir, point.flux);
    divided[i].points.push_back(point);
  }
  for (std::size_t i = 0; i < count; ++i) divided[i].piece = pieceFrom(sums[i]);
  return divided;
}

}  // namespace

double solidAngle(double radius_rad) {
  const double half = std::sin(std::min(radius_rad, kPi) / 2);
  return 4 * kPi * half * half;
}

std::vector<LightPoint> discPoints(const LightPiece& disc) {
  return spiral(disc, 64 + static_cast<std::size_t>(solidAngle(disc.radius_rad) / 3e-4));
}

void addDisc(FluxGrid& grid, const LightPiece& disc, double factor) {
  for (const LightPoint& point : discPoints(disc)) grid.add(point.at, factor * point.flux);
}

// A disc is never divided into two halves, which are far from round.
std::vector<DiscPiece> dividedDisc(const LightPiece& disc, double radius_rad, std::size_t most,
                                   double allowed) {
  most = std::max<std::size_t>(most, 3);
  const double areas = std::ceil(solidAngle(disc.radius_rad) / solidAngle(radius_rad));
  for (auto count = static_cast<std::size_t>(std::clamp(areas, 3.0, static_cast<double>(most)));; ++count) {
    std::vector<DiscPiece> pieces = dividedInto(disc, count);
    FluxGrid misshapen;
    addDisc(misshapen, disc);
    for (const DiscPiece& part : pieces) addDisc(misshapen, part.piece, -1.0);
    if (count == most || std::sqrt(misshapen.lostPower(1)) <= allowed) return pieces;
  }
}

namespace {

// The number of blocks in a picture lies in this range if its size has a suitable divisor.
constexpr std::size_t kMostBlocks = 60'000, kFewestBlocks = 8'000;
// Pictures with fewer rows are searched in parts of texels, because points too far apart would show up as
// light in high bands.
constexpr std::uint32_t kFewestRows = 64;
// Each threshold is one such step below the previous one.
constexpr double kStepsPerOctave = 4.0;
constexpr std::size_t kMostLevels = 400;

}  // namespace

double luminance(const glm::vec3& radiance) {
  const glm::dvec3 rgb(radiance);
  return 0.2126 * rgb.r + 0.7152 * rgb.g + 0.0722 * rgb.b;
}

LightBlocks::Search LightBlocks::searchOf(const spec::EnvironmentMap& environment_map,
                                          std::size_t first_block) {
  const spec::RgbImage& image = environment_map.image;
  Search search{&environment_map, static_cast<int>(image.width), static_cast<int>(image.height), 1, 1,
                first_block};
  const bool cross =
      environment_map.layout == sh::ImageLayout::VerticalCross;  // blocks must stay within a face
  const std::uint32_t side = cross ? image.width / 3 : image.width;
  const auto blocks = [&](std::uint32_t texels) { return image.texels.size() / texels / texels; };
  for (std::uint32_t n = 2; n <= side && blocks(search.texels) > kMostBlocks; ++n)
    if (side % n == 0 && (cross || image.height % n == 0) && blocks(n) >= kFewestBlocks) search.texels = n;
  if (image.height < kFewestRows) search.parts = (kFewestRows - 1) / image.height + 1;
  search.width = search.width * static_cast<int>(search.parts) / static_cast<int>(search.texels);
  search.height = search.height * static_cast<int>(search.parts) / static_cast<int>(search.texels);
  return search;
}

// Calls visit(block, luminance) for every texel, or for every part of each texel.
template <typename Visit>
void LightBlocks::eachBlock(const Search& search, Visit&& visit) {
  const spec::RgbImage& image = search.environment_map->image;
  const std::uint32_t parts = search.parts, texels = search.texels;
  const auto width = static_cast<std::size_t>(search.width);
  for (std::uint32_t y = 0; y < image.height; ++y)
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const double value = luminance(image.texels[std::size_t{y} * image.width + x]);
      for (std::uint32_t part = 0; part < parts * parts; ++part) {
        const std::uint32_t column = (x * parts + part % parts) / texels;
        const std::uint32_t row = (y * parts + part / parts) / texels;
        visit(search.first_block + row * width + column, value);
      }
    }
}

LightBlocks::LightBlocks(std::span<const spec::EnvironmentMap> environment_maps) {
  for (const spec::EnvironmentMap& environment_map : environment_maps) {
    const Search search = searchOf(environment_map, blocks_.size());
    searches_.push_back(search);
    for (int y = 0; y < search.height; ++y)
      for (int x = 0; x < search.width; ++x) {
        Block block;
        block.texel_sr = sh::texelSolidAngle(environment_map.layout, search.width, search.height, x, y) /
                         (search.texels * search.texels);
        block.point.dir = sh::texelDirection(environment_map.layout, search.width, search.height, x, y);
        if (block.texel_sr > 0.0) block.point.at = FluxGrid::place(block.point.dir);
        blocks_.push_back(block);
      }
    eachBlock(search, [&](std::size_t i, double value) {
      if (blocks_[i].texel_sr <= 0.0) return;
      blocks_[i].all += value;
      brightest_ = std::max(brightest_, value);
    });
  }
}

void LightBlocks::addTo(FluxGrid& grid) const {
  for (const Block& block : blocks_)
    if (block.texel_sr > 0.0) grid.add(block.point.at, block.all * block.texel_sr);
}

double LightBlocks::threshold(std::size_t level) const {
  return top_ * std::exp2(-static_cast<double>(level + 1) / kStepsPerOctave);
}

std::size_t LightBlocks::levelOf(double value) const {
  return static_cast<std::size_t>(std::max(0.0, std::floor(kStepsPerOctave * std::log2(top_ / value))));
}

void LightBlocks::setLevels(double brightest, double lowest) {
  assert(brightest > 0.0 && lowest > 0.0);
  top_ = brightest;
  levels_.assign(std::min(levelOf(lowest) + 1, kMostLevels), {});
  const double least = threshold(levels_.size() - 1);
  for (const Search& search : searches_)
    eachBlock(search, [&](std::size_t block, double value) {
      if (value <= least || blocks_[block].texel_sr <= 0.0) return;
      levels_[std::min(levelOf(value), levels_.size() - 1)].push_back(
          {static_cast<std::uint32_t>(block), static_cast<float>(value)});
    });
}

void LightBlocks::lowerTo(std::size_t level) {
  if (level < next_level_) {  // the threshold rises: start at the top
    for (Block& block : blocks_) block.light = block.solid_angle_sr = 0.0;
    lit_.clear();
    next_level_ = 0;
  }
  for (; next_level_ <= level; ++next_level_)
    for (const Bright& texel : levels_[next_level_]) {
      Block& block = blocks_[texel.block];
      if (block.solid_angle_sr <= 0.0) lit_.push_back(texel.block);
      block.solid_angle_sr += block.texel_sr;
      block.light += block.texel_sr * static_cast<double>(texel.luminance);
    }
  points_.clear();
  for (const std::uint32_t i : lit_) {
    Block& block = blocks_[i];
    block.point.flux = std::max(0.0, block.light - threshold(level) * block.solid_angle_sr);
    points_.push_back(block.point);
  }
}

}  // namespace lambent::lighting
