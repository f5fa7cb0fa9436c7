#include "baker/refine/face_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <tuple>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "baker/refine/triangulation.hpp"

namespace lambent::baker {

namespace {

constexpr double kGrowth = 0.5;  // of the distance between points, with that from a rim or cut
// Squares that take up less of all pictures are not divided, up to so many times the distance of points.
constexpr double kLeastOfSquare = 4e-6, kLargestHidden = 8.0;
constexpr std::uint32_t kNone = 0xffffffffu;

double distanceTo(const Line& line, const glm::dvec2& p) {
  const glm::dvec2 way = line.b - line.a;
  const double square = glm::dot(way, way);
  const double t = square > 0.0 ? std::clamp(glm::dot(p - line.a, way) / square, 0.0, 1.0) : 0.0;
  return glm::distance(p, line.a + t * way);
}

// Returns the part of a line within a box; an empty one if there is none.
Line clipped(const Line& line, const glm::dvec2& low, const glm::dvec2& high) {
  const glm::dvec2 way = line.b - line.a;
  double from = 0.0, to = 1.0;
  for (int k = 0; k < 2; ++k) {
    if (way[k] == 0.0) {
      if (line.a[k] < low[k] || line.a[k] > high[k]) return {};
      continue;
    }
    const double s = (low[k] - line.a[k]) / way[k], e = (high[k] - line.a[k]) / way[k];
    from = std::max(from, std::min(s, e)), to = std::min(to, std::max(s, e));
  }
  return to > from ? Line{line.a + from * way, line.a + to * way} : Line{};
}

// Joins lines along one, as the triangles of a wall make them, and divides them where they cross each other
// or the rim. Those that meet keep a little apart, so that the rows of points beside them do not cross.
std::vector<Line> joined(std::span<const Line> lines, std::span<const Line> rim, double beside) {
  struct Along {
    std::int64_t angle, offset;
    double from, to;
    glm::dvec2 way, base;
  };
  std::vector<Along> all, whole;
  for (const Line& line : lines) {
    if (!(glm::distance(line.a, line.b) > 4.0 * beside)) continue;
    glm::dvec2 way = glm::normalize(line.b - line.a);
    if (way.x < -1e-6 || (std::abs(way.x) <= 1e-6 && way.y < 0.0)) way = -way;
    const auto [from, to] = std::minmax({glm::dot(way, line.a), glm::dot(way, line.b)});
    all.push_back({std::llround(std::atan2(way.y, way.x) * 1e3), std::llround(cross(way, line.a) / beside),
                   from, to, way, line.a - glm::dot(way, line.a) * way});
  }
  std::ranges::sort(all, {}, [](const Along& l) { return std::tuple(l.angle, l.offset, l.from, l.to); });
  for (const Along& line : all)
    if (!whole.empty() && whole.back().angle == line.angle && whole.back().offset == line.offset &&
        line.from <= whole.back().to + beside)
      whole.back().to = std::max(whole.back().to, line.to);
    else
      whole.push_back(line);
  std::vector<Line> divided;
  for (const Along& line : whole) {
    std::vector<double> ends = {line.from, line.to};
    const Line self{line.base + line.from * line.way, line.base + line.to * line.way};
    const auto divide = [&](const Line& other) {
      const glm::dvec2 way = other.b - other.a;
      const double turn = cross(line.way, way);
      if (std::abs(turn) < 1e-3 * glm::length(way)) return;
      const double s = cross(other.a - self.a, way) / turn, t = cross(other.a - self.a, line.way) / turn;
      if (s > 0.0 && line.from + s < line.to && t >= 0.0 && t <= 1.0) ends.push_back(line.from + s);
    };
    for (const Along& other : whole)
      divide({other.base + other.from * other.way, other.base + other.to * other.way});
    for (const Line& other : rim) divide(other);
    std::ranges::sort(ends);
    for (std::size_t i = 0; i + 1 < ends.size(); ++i)
      if (ends[i + 1] - ends[i] > 6.0 * beside)
        divided.push_back({line.base + (ends[i] + 2.0 * beside) * line.way,
                           line.base + (ends[i + 1] - 2.0 * beside) * line.way});
  }
  return divided;
}

class FaceGrid {
 public:
  explicit FaceGrid(const Outline& outline) : outline_(outline), low_(1e300), high_(-1e300) {
    for (const glm::dvec2& p : outline.points) low_ = glm::min(low_, p), high_ = glm::max(high_, p);
    const glm::dvec2 size = high_ - low_;
    lattice_ = 0.9 * Triangulation::kMost / std::max(0.5 * std::max(size.x, size.y), 1e-30);
    for (const glm::dvec2& p : outline.points) numbers_.push_back(add(p));
    for (const auto& [a, b] : outline.edges) lines_.push_back({outline.points[a], outline.points[b]});
  }

  void addGrid(std::span<const Line> cuts, const GridRules& rules) {
    rules_ = &rules;
    std::vector<Line> within;
    for (const Line& cut : cuts) within.push_back(clipped(cut, low_, high_));
    const std::vector<Line> rim = lines_;
    for (const Line& cut : joined(within, rim, rules.beside)) addRows(cut, rim);
    std::vector<std::uint32_t> all(lines_.size());
    std::iota(all.begin(), all.end(), 0u);
    double size = rules.along;
    while (size < std::max(high_.x - low_.x, high_.y - low_.y)) size *= 2.0;
    addSquare(low_, size, all);
  }

  std::optional<FaceMesh> triangulate() {
    for (const auto& [a, b] : outline_.edges)
      if (numbers_[a] != numbers_[b] && !triangulation_.constrain(numbers_[a], numbers_[b], true))
        return std::nullopt;
    for (const auto& [a, b] : kept_)
      if (a != b) triangulation_.constrain(a, b, false);
    // Points of the outline that lie in one place on the lattice are one.
    FaceMesh mesh{.points = outline_.points, .triangles = triangulation_.inside()};
    std::vector<std::uint32_t> number(points_.size(), kNone);
    for (std::uint32_t i = 0; i < numbers_.size(); ++i)
      if (number[numbers_[i]] == kNone) number[numbers_[i]] = i;
    for (std::uint32_t i = 0; i < points_.size(); ++i)
      if (number[i] == kNone) {
        number[i] = static_cast<std::uint32_t>(mesh.points.size());
        mesh.points.push_back(points_[i]);
      }
    for (glm::uvec3& t : mesh.triangles) t = {number[t.x], number[t.y], number[t.z]};
    return mesh;
  }

 private:
  std::uint32_t add(const glm::dvec2& p) {
    const std::uint32_t number =
        triangulation_.add(glm::ivec2(glm::round((p - 0.5 * (low_ + high_)) * lattice_)));
    if (number == points_.size()) points_.push_back(p);
    return number;
  }

  bool isInside(const glm::dvec2& p) const {
    bool inside = false;
    for (const Line& line : std::span(lines_).first(outline_.edges.size()))
      if ((line.a.y > p.y) != (line.b.y > p.y) &&
          p.x < line.a.x + (line.b.x - line.a.x) * (p.y - line.a.y) / (line.b.y - line.a.y))
        inside = !inside;
    return inside;
  }

  // Adds a row of points on each side of a cut, where it is seen.
  void addRows(const Line& cut, std::span<const Line> rim) {
    const glm::dvec2 way = cut.b - cut.a;
    const double length = glm::length(way);
    const glm::dvec2 side = glm::dvec2(-way.y, way.x) * (rules_->beside / length);
    const double apart = rules_->along * rules_->scale(0.5 * (cut.a + cut.b));
    const auto parts = static_cast<std::size_t>(std::max(1.0, std::ceil(length / apart)));
    std::array<std::uint32_t, 2> last{kNone, kNone};
    for (std::size_t i = 0; i <= parts; ++i) {
      const glm::dvec2 on = cut.a + way * (static_cast<double>(i) / static_cast<double>(parts));
      bool any = false;
      for (std::size_t s = 0; s < 2; ++s) {
        const glm::dvec2 p = on + (s == 0 ? side : -side);
        const bool clear =
            isInside(p) && rules_->seen(p) > 0.0 && std::ranges::none_of(rim, [&](const Line& line) {
              return distanceTo(line, p) < 1.5 * rules_->beside;
            });
        const std::uint32_t next = clear ? add(p) : kNone;
        if (clear && last[s] != kNone) {
          kept_.emplace_back(last[s], next);
          any = true;
        }
        last[s] = next;
      }
      if (any) lines_.push_back({on - way / static_cast<double>(parts), on});
    }
  }

  // Divides a square until it is as wide as points are to be apart there, and adds its corners. `near` are
  // the lines that may lie near it.
  void addSquare(const glm::dvec2& corner, double size, std::span<const std::uint32_t> near) {
    const glm::dvec2 center = corner + 0.5 * size;
    const double scale = rules_->scale(center), inside = rules_->inside * scale,
                 along = rules_->along * scale;
    const double radius = 0.5 * std::sqrt(2.0) * size, reach = (inside - along) / kGrowth;
    std::vector<std::uint32_t> here;
    double nearest = reach;
    for (const std::uint32_t line : near)
      if (const double distance = distanceTo(lines_[line], center); distance < radius + reach) {
        here.push_back(line);
        nearest = std::min(nearest, distance);
      }
    const double wanted = std::min(inside, along + kGrowth * std::max(0.0, nearest - radius));
    if (size > wanted && !isHidden(corner, size, inside)) {
      for (int k = 0; k < 4; ++k)
        addSquare(corner + 0.5 * size * glm::dvec2(k & 1, k >> 1), 0.5 * size, here);
      return;
    }
    for (int k = 0; k < 4; ++k) {
      const glm::dvec2 p = corner + size * glm::dvec2(k & 1, k >> 1);
      const bool in_box = p.x > low_.x && p.y > low_.y && p.x < high_.x && p.y < high_.y;
      const auto clear = [&](std::uint32_t line) { return distanceTo(lines_[line], p) > 0.6 * size; };
      if (in_box && std::ranges::all_of(here, clear) && isInside(p)) add(p);
    }
  }

  // Returns whether a square stays coarse because nobody sees it.
  bool isHidden(const glm::dvec2& corner, double size, double inside) const {
    if (size <= inside || size > kLargestHidden * inside) return false;
    double seen = 0.0;
    for (int k = 0; k < 9; ++k)
      seen = std::max(seen, rules_->seen(corner + size * (glm::dvec2(k % 3, k / 3) + 0.5) / 3.0));
    return size * size * seen < kLeastOfSquare;
  }

  const Outline& outline_;
  const GridRules* rules_ = nullptr;
  glm::dvec2 low_, high_;
  double lattice_ = 0.0;  // steps per metre
  Triangulation triangulation_;
  std::vector<glm::dvec2> points_;      // by number in the triangulation
  std::vector<std::uint32_t> numbers_;  // of the outline's points
  std::vector<Line> lines_;             // the outline's edges, then cuts
  std::vector<std::pair<std::uint32_t, std::uint32_t>> kept_;
};

}  // namespace

std::optional<FaceMesh> fillOutline(const Outline& outline, std::span<const Line> cuts,
                                    const GridRules* rules) {
  const auto finite = [](const glm::dvec2& p) { return std::isfinite(p.x) && std::isfinite(p.y); };
  if (outline.edges.size() < 3 || !std::ranges::all_of(outline.points, finite)) return std::nullopt;
  FaceGrid grid(outline);
  if (rules) grid.addGrid(cuts, *rules);
  return grid.triangulate();
}

}  // namespace lambent::baker
