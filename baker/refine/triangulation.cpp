#include "baker/refine/triangulation.hpp"

#include <algorithm>
#include <cstddef>
#include <deque>
#include <utility>

namespace lambent::baker {

namespace {

std::size_t after(std::size_t k) {
  return (k + 1) % 3;
}
std::size_t before(std::size_t k) {
  return (k + 2) % 3;
}

std::size_t indexIn(const std::array<std::uint32_t, 3>& points, std::uint32_t point) {
  return static_cast<std::size_t>(std::ranges::find(points, point) - points.begin());
}

}  // namespace

Triangulation::Triangulation()
    : points_{{-kMost, -kMost}, {kMost, -kMost}, {kMost, kMost}, {-kMost, kMost}},
      triangles_{{.points = {0, 1, 2}, .across = {kNone, 1, kNone}},
                 {.points = {0, 2, 3}, .across = {kNone, kNone, 0}}},
      of_point_{0, 0, 0, 1} {}

std::int64_t Triangulation::turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
  const glm::i64vec2 origin(points_[a]), u = glm::i64vec2(points_[b]) - origin,
                                         v = glm::i64vec2(points_[c]) - origin;
  return u.x * v.y - u.y * v.x;
}

bool Triangulation::inCircle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) const {
  __extension__ using Wide = __int128;
  const glm::i64vec2 origin(points_[d]);
  const std::array v = {glm::i64vec2(points_[a]) - origin, glm::i64vec2(points_[b]) - origin,
                        glm::i64vec2(points_[c]) - origin};
  Wide sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::i64vec2 &p = v[k], &q = v[after(k)], &r = v[before(k)];
    sum += Wide{p.x * p.x + p.y * p.y} * Wide{q.x * r.y - q.y * r.x};
  }
  return sum > 0;
}

Triangulation::Side Triangulation::otherSide(const Side& side) const {
  const std::uint32_t across = triangles_[side.triangle].across[side.k];
  if (across == kNone) return {kNone, 0};
  for (std::size_t k = 0; k < 3; ++k)
    if (triangles_[across].points[after(k)] == triangles_[side.triangle].points[before(side.k)])
      return {across, k};
  return {kNone, 0};
}

void Triangulation::link(const Side& side, std::uint32_t across, Edge edge) {
  triangles_[side.triangle].across[side.k] = across;
  triangles_[side.triangle].edges[side.k] = edge;
  if (across == kNone) return;
  Triangle& other = triangles_[across];
  const std::uint32_t end = triangles_[side.triangle].points[before(side.k)];
  const std::size_t k = before(indexIn(other.points, end));
  other.across[k] = side.triangle;
  other.edges[k] = edge;
}

void Triangulation::flip(const Side& side) {
  const Side other = otherSide(side);
  const Triangle first = triangles_[side.triangle], second = triangles_[other.triangle];
  const std::uint32_t p = first.points[side.k], a = first.points[after(side.k)],
                      b = first.points[before(side.k)], q = second.points[other.k];
  // The quadrangle p, a, q, b.
  triangles_[side.triangle].points = {a, q, p};
  triangles_[other.triangle].points = {b, p, q};
  link({side.triangle, 1}, first.across[before(side.k)], first.edges[before(side.k)]);
  link({side.triangle, 2}, second.across[after(other.k)], second.edges[after(other.k)]);
  link({other.triangle, 1}, second.across[before(other.k)], second.edges[before(other.k)]);
  link({other.triangle, 2}, first.across[after(side.k)], first.edges[after(side.k)]);
  link({side.triangle, 0}, other.triangle, Edge::Free);
  of_point_[a] = of_point_[p] = of_point_[q] = side.triangle;
  of_point_[b] = other.triangle;
}

void Triangulation::makeDelaunay(std::vector<Side> sides) {
  while (!sides.empty()) {
    const Side side = sides.back();
    sides.pop_back();
    const Triangle& t = triangles_[side.triangle];
    const Side other = otherSide(side);
    if (other.triangle == kNone || t.edges[side.k] != Edge::Free) continue;
    const std::uint32_t p = t.points[side.k], a = t.points[after(side.k)], b = t.points[before(side.k)];
    // A triangle is flat while its newest point lies on its edge.
    if (turn(a, b, p) != 0 && !inCircle(p, a, b, triangles_[other.triangle].points[other.k])) continue;
    flip(side);
    sides.insert(sides.end(),
                 {{side.triangle, 1}, {side.triangle, 2}, {other.triangle, 1}, {other.triangle, 2}});
  }
}

std::uint32_t Triangulation::add(const glm::ivec2& point) {
  const auto number = static_cast<std::uint32_t>(points_.size());
  points_.push_back(point);
  for (bool moved = true; moved;) {
    moved = false;
    for (std::size_t k = 0; k < 3 && !moved; ++k) {
      const Triangle& t = triangles_[last_];
      if (turn(t.points[after(k)], t.points[before(k)], number) >= 0) continue;
      last_ = t.across[k];
      moved = true;
    }
  }
  const Triangle old = triangles_[last_];
  for (const std::uint32_t corner : old.points)
    if (points_[corner] == point) {
      points_.pop_back();
      return corner - kCorners;
    }
  const std::array parts = {last_, static_cast<std::uint32_t>(triangles_.size()),
                            static_cast<std::uint32_t>(triangles_.size() + 1)};
  triangles_.resize(triangles_.size() + 2);
  of_point_.push_back(last_);
  for (std::size_t k = 0; k < 3; ++k) {
    triangles_[parts[k]].points = {number, old.points[after(k)], old.points[before(k)]};
    of_point_[old.points[after(k)]] = parts[k];
  }
  for (std::size_t k = 0; k < 3; ++k) {
    link({parts[k], 0}, old.across[k], old.edges[k]);
    link({parts[k], 1}, parts[after(k)], Edge::Free);
  }
  makeDelaunay({{parts[0], 0}, {parts[1], 0}, {parts[2], 0}});
  return number - kCorners;
}

Triangulation::Side Triangulation::between(std::uint32_t a, std::uint32_t b) const {
  if (a < kCorners) return otherSide(between(b, a));  // triangles around others close a ring
  std::uint32_t t = of_point_[a];
  const std::uint32_t first = t;
  do {
    const std::size_t at = indexIn(triangles_[t].points, a);
    if (triangles_[t].points[after(at)] == b) return {t, before(at)};
    t = triangles_[t].across[after(at)];  // the next one clockwise or, below, counter-clockwise
  } while (t != first && t != kNone);
  return {kNone, 0};
}

bool Triangulation::constrain(std::uint32_t from, std::uint32_t to, bool outline) {
  const Edge kind = outline ? Edge::Outline : Edge::Kept;
  std::uint32_t a = from + kCorners;
  const std::uint32_t end = to + kCorners;
  while (a != end) {
    // Finds the triangle at `a` that the way enters, or the edge along which it goes.
    std::uint32_t b = kNone;
    Side entered{kNone, 0};
    std::uint32_t t = of_point_[a];
    for (const std::uint32_t first = t;;) {
      const std::size_t k = indexIn(triangles_[t].points, a);
      const std::uint32_t u = triangles_[t].points[after(k)], v = triangles_[t].points[before(k)];
      const std::int64_t left = turn(a, end, v), right = turn(a, end, u);
      const glm::i64vec2 way = glm::i64vec2(points_[end]) - glm::i64vec2(points_[a]),
                         edge = glm::i64vec2(points_[u]) - glm::i64vec2(points_[a]);
      if (right == 0 && way.x * edge.x + way.y * edge.y > 0) {
        b = u;
        break;
      }
      if (right < 0 && left > 0) {
        entered = {t, k};
        break;
      }
      t = triangles_[t].across[after(k)];
      if (t == first || t == kNone) return false;
    }
    if (b == kNone) {
      // Edges between here and the next point on the way are turned until none crosses it.
      std::deque<std::pair<std::uint32_t, std::uint32_t>> crossing;
      for (Side side = entered; b == kNone;) {
        const Triangle& crossed = triangles_[side.triangle];
        if (crossed.edges[side.k] != Edge::Free) return false;
        const std::uint32_t u = crossed.points[after(side.k)], v = crossed.points[before(side.k)];
        crossing.emplace_back(u, v);
        const Side other = otherSide(side);
        const std::uint32_t q = triangles_[other.triangle].points[other.k];
        const std::int64_t where = turn(a, end, q);
        if (where == 0)
          b = q;
        else
          side = {other.triangle, where > 0 ? after(other.k) : before(other.k)};
      }
      std::vector<std::pair<std::uint32_t, std::uint32_t>> turned;
      while (!crossing.empty()) {
        const auto [u, v] = crossing.front();
        crossing.pop_front();
        const Side side = between(u, v), other = otherSide(side);
        const std::uint32_t p = triangles_[side.triangle].points[side.k],
                            q = triangles_[other.triangle].points[other.k];
        if (turn(p, u, q) <= 0 || turn(p, q, v) <= 0) {  // the quadrangle is not convex
          crossing.emplace_back(u, v);
          continue;
        }
        flip(side);
        const auto crosses = [&](std::uint32_t point) { return turn(a, b, point); };
        if (p != a && q != a && p != b && q != b && (crosses(p) > 0) != (crosses(q) > 0))
          crossing.emplace_back(p, q);
        else
          turned.emplace_back(p, q);
      }
      const Side kept = between(a, b);
      link(kept, triangles_[kept.triangle].across[kept.k], kind);
      std::vector<Side> sides;
      for (const auto& [p, q] : turned) sides.push_back(between(p, q));
      makeDelaunay(std::move(sides));
    } else {
      const Side side = between(a, b);
      const Triangle& triangle = triangles_[side.triangle];
      // Two edges of an outline in one place have the same on both sides.
      const bool is_outline = triangle.edges[side.k] == Edge::Outline;
      link(side, triangle.across[side.k], is_outline == outline ? Edge::Kept : Edge::Outline);
    }
    a = b;
  }
  return true;
}

std::vector<glm::uvec3> Triangulation::inside() const {
  std::vector<std::int8_t> depth(triangles_.size(), -1);
  std::vector<std::uint32_t> next = {of_point_[0]};
  depth[next.front()] = 0;
  std::vector<glm::uvec3> found;
  while (!next.empty()) {
    const std::uint32_t t = next.back();
    next.pop_back();
    const Triangle& triangle = triangles_[t];
    const bool at_corner = std::ranges::any_of(triangle.points, [](std::uint32_t p) { return p < kCorners; });
    if (depth[t] == 1 && at_corner) return {};  // an outline is open
    if (depth[t] == 1)
      found.emplace_back(triangle.points[0] - kCorners, triangle.points[1] - kCorners,
                         triangle.points[2] - kCorners);
    for (std::size_t k = 0; k < 3; ++k)
      if (const std::uint32_t other = triangle.across[k]; other != kNone && depth[other] < 0) {
        depth[other] = static_cast<std::int8_t>(depth[t] ^ (triangle.edges[k] == Edge::Outline ? 1 : 0));
        next.push_back(other);
      }
  }
  return found;
}

}  // namespace lambent::baker
