#include "runtime/lighting/triangle_tree.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace lambent::lighting {

namespace {

constexpr std::uint32_t kMissed = 0xffffffffu;
constexpr std::size_t kDeepest =
    128;  // of the stack: each part has at most 7/8 of the triangles of the whole

struct Bounds {
  glm::vec3 low{std::numeric_limits<float>::infinity()}, high{-std::numeric_limits<float>::infinity()};
  void add(const RayTriangle& triangle) {
    for (const glm::vec3& corner : triangle.corners) {
      low = glm::min(low, corner);
      high = glm::max(high, corner);
    }
  }
  float area() const {
    const glm::vec3 size = high - low;
    return size.x * size.y + size.y * size.z + size.z * size.x;
  }
};

glm::vec3 middleOf(const RayTriangle& triangle) {
  return triangle.corners[0] + triangle.corners[1] + triangle.corners[2];
}

}  // namespace

TriangleTree::TriangleTree(std::vector<RayTriangle> triangles, float least_distance)
    : triangles_(std::move(triangles)), least_distance_(least_distance) {
  if (triangles_.empty()) return;
  std::vector<std::uint32_t> order(triangles_.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  nodes_.emplace_back();
  divide(0, order, 0, order.size());
}

// Divides where the sum of areas times counts is least (the surface area heuristic; MacDonald and Booth
// 1990).
void TriangleTree::divide(std::size_t node, std::vector<std::uint32_t>& order, std::size_t begin,
                          std::size_t end) {
  const std::size_t count = end - begin;
  Bounds bounds;
  for (std::size_t i = begin; i < end; ++i) bounds.add(triangles_[order[i]]);
  // Rounding must not let a ray miss a box of which it meets the contents.
  const glm::vec3 margin = 1e-6f * (glm::abs(bounds.low) + glm::abs(bounds.high));
  nodes_[node].low = bounds.low - margin;
  nodes_[node].high = bounds.high + margin;
  if (count <= kWidth) {
    nodes_[node].leaf = true;
    nodes_[node].place = static_cast<std::uint32_t>(leaves_.size());
    Leaf& leaf = leaves_.emplace_back();
    leaf.count = static_cast<std::uint32_t>(count);
    for (std::size_t i = 0; i < count; ++i) {
      const RayTriangle& triangle = triangles_[order[begin + i]];
      const auto& [a, b, c] = triangle.corners;
      for (std::size_t k = 0; k < 9; ++k)
        leaf.corners[k][i] = triangle.corners[k / 3][static_cast<int>(k % 3)];
      leaf.double_area[i] = glm::length(glm::cross(b - a, c - a));
      leaf.front_only[i] = triangle.front_only ? 1u : 0u;
      leaf.index[i] = order[begin + i];
    }
    return;
  }
  const auto sortAlong = [&](int axis) {
    std::sort(order.begin() + static_cast<std::ptrdiff_t>(begin),
              order.begin() + static_cast<std::ptrdiff_t>(end), [&](std::uint32_t i, std::uint32_t j) {
                const float a = middleOf(triangles_[i])[axis], b = middleOf(triangles_[j])[axis];
                return a != b ? a < b : i < j;
              });
  };
  int best_axis = 0;
  std::size_t best = begin + count / 2;
  float least = std::numeric_limits<float>::infinity();
  std::vector<float> below(count);
  for (int axis = 0; axis < 3; ++axis) {
    sortAlong(axis);
    Bounds so_far;
    for (std::size_t i = 0; i < count; ++i) {
      below[i] = so_far.area() * static_cast<float>(i);
      so_far.add(triangles_[order[begin + i]]);
    }
    Bounds rest;
    for (std::size_t i = count; i-- > 1;) {
      rest.add(triangles_[order[begin + i]]);
      // A part of less than an eighth would make the tree deep for little.
      if (8 * i < count || 8 * (count - i) < count) continue;
      const float cost = below[i] + rest.area() * static_cast<float>(count - i);
      if (cost < least) {
        least = cost;
        best = begin + i;
        best_axis = axis;
      }
    }
  }
  sortAlong(best_axis);
  const std::size_t children = nodes_.size();
  nodes_[node].place = static_cast<std::uint32_t>(children);
  nodes_.resize(children + 2);
  divide(children, order, begin, best);
  divide(children + 1, order, best, end);
}

TriangleTree::Met TriangleTree::meet(const Leaf& leaf, const glm::vec3& origin,
                                     const glm::vec3& direction) const {
  Met met;
  const float x = direction.x, y = direction.y, z = direction.z;
  for (std::size_t i = 0; i < kWidth; ++i) {
    const float ax = leaf.corners[0][i] - origin.x, ay = leaf.corners[1][i] - origin.y,
                az = leaf.corners[2][i] - origin.z;
    const float bx = leaf.corners[3][i] - origin.x, by = leaf.corners[4][i] - origin.y,
                bz = leaf.corners[5][i] - origin.z;
    const float cx = leaf.corners[6][i] - origin.x, cy = leaf.corners[7][i] - origin.y,
                cz = leaf.corners[8][i] - origin.z;
    // These are the normals of the planes through the origin and the edges b c, c a and a b.
    const float nax = by * cz - bz * cy, nay = bz * cx - bx * cz, naz = bx * cy - by * cx;
    const float nbx = cy * az - cz * ay, nby = cz * ax - cx * az, nbz = cx * ay - cy * ax;
    const float ncx = ay * bz - az * by, ncy = az * bx - ax * bz, ncz = ax * by - ay * bx;
    const float volume = ax * nax + ay * nay + az * naz;  // negative for front hits
    const float sign = volume > 0.0f ? 1.0f : -1.0f;
    const float a = sign * (x * nax + y * nay + z * naz);
    const float b = sign * (x * nbx + y * nby + z * nbz);
    const float c = sign * (x * ncx + y * ncy + z * ncz);
    const float sum = a + (b + c);  // the same if b and c are swapped, as in the other side of a sheet
    const bool back = volume > 0.0f;
    const bool apart = std::abs(volume) > least_distance_ * leaf.double_area[i];
    const bool inside =
        (a >= 0.0f) & (b >= 0.0f) & (c >= 0.0f) & (sum > 0.0f) & apart & !(back & (leaf.front_only[i] != 0));
    // The bits of positive floats order like the floats.
    const std::uint32_t missed = static_cast<std::uint32_t>(inside) - 1u;  // all bits set if missed
    met.distance[i] = std::bit_cast<std::uint32_t>(sign * volume / sum) | missed;
    met.back[i] = back ? 1u : 0u;
  }
  return met;
}

template <typename Visit>
void TriangleTree::follow(const glm::vec3& origin, const glm::vec3& direction, float lengths,
                          const Visit& visit) const {
  if (nodes_.empty()) return;
  constexpr float kLeast = 1e-30f;
  glm::vec3 inverse;
  for (int axis = 0; axis < 3; ++axis)
    inverse[axis] = 1.0f / (std::abs(direction[axis]) < kLeast ? kLeast : direction[axis]);
  const auto reaches = [&](const Node& node) {  // lengths to the box; infinity if it is missed
    const glm::vec3 low = (node.low - origin) * inverse, high = (node.high - origin) * inverse;
    const glm::vec3 near = glm::min(low, high), far = glm::max(low, high);
    const float in = std::max({near.x, near.y, near.z, 0.0f}), out = std::min({far.x, far.y, far.z});
    return in <= out * 1.00001f ? in * 0.99999f : std::numeric_limits<float>::infinity();
  };
  std::array<std::pair<std::uint32_t, float>, kDeepest> stack;
  std::size_t size = 0;
  stack[size++] = {0u, reaches(nodes_[0])};
  while (size > 0) {
    const auto [index, distance] = stack[--size];
    if (!(distance <= lengths) || distance == std::numeric_limits<float>::infinity()) continue;
    const Node& node = nodes_[index];
    if (node.leaf) {
      lengths = visit(leaves_[node.place], lengths);
      continue;
    }
    std::pair near = {node.place, reaches(nodes_[node.place])};
    std::pair far = {node.place + 1, reaches(nodes_[node.place + 1])};
    if (far.second < near.second) std::swap(near, far);
    if (far.second <= lengths) stack[size++] = far;
    if (near.second <= lengths) stack[size++] = near;
  }
}

std::optional<RayHit> TriangleTree::first(const glm::vec3& origin, const glm::vec3& direction) const {
  std::uint32_t nearest = kMissed;
  RayHit hit;
  follow(origin, direction, std::numeric_limits<float>::max(), [&](const Leaf& leaf, float lengths) {
    const Met met = meet(leaf, origin, direction);
    for (std::size_t i = 0; i < leaf.count; ++i) {
      const bool back = met.back[i] != 0;
      if (met.distance[i] == kMissed || met.distance[i] > nearest) continue;
      // If two are equally far, the front counts, then the first in order, however the tree comes to them.
      if (met.distance[i] == nearest && (back != hit.back ? back : leaf.index[i] > hit.triangle)) continue;
      nearest = met.distance[i];
      hit.triangle = leaf.index[i];
      hit.back = back;
    }
    return nearest == kMissed ? lengths : std::bit_cast<float>(nearest);
  });
  if (nearest == kMissed) return std::nullopt;
  const auto& [first, second, third] = triangles_[hit.triangle].corners;
  const glm::vec3 a = first - origin, b = second - origin, c = third - origin;
  const float at_a = glm::dot(direction, glm::cross(b, c)), at_b = glm::dot(direction, glm::cross(c, a)),
              at_c = glm::dot(direction, glm::cross(a, b));
  const float sum = at_a + at_b + at_c;
  hit.b = at_b / sum;
  hit.c = at_c / sum;
  return hit;
}

bool TriangleTree::blocked(const glm::vec3& origin, const glm::vec3& direction, float lengths) const {
  bool hit = false;
  const std::uint32_t limit = std::bit_cast<std::uint32_t>(lengths);
  follow(origin, direction, lengths, [&](const Leaf& leaf, float rest) {
    const Met met = meet(leaf, origin, direction);
    for (std::size_t i = 0; i < leaf.count; ++i) hit |= met.distance[i] < limit;
    return hit ? -1.0f : rest;
  });
  return hit;
}

void TriangleTree::findNear(const glm::vec3& point, float distance, std::vector<std::uint32_t>& found) const {
  found.clear();
  if (nodes_.empty()) return;
  std::array<std::uint32_t, kDeepest> stack{};
  std::size_t size = 1;
  while (size > 0) {
    const Node& node = nodes_[stack[--size]];
    const glm::vec3 outside = glm::max(node.low - point, point - node.high);
    if (!(std::max({outside.x, outside.y, outside.z}) <= distance)) continue;
    if (node.leaf) {
      const Leaf& leaf = leaves_[node.place];
      found.insert(found.end(), leaf.index.begin(), leaf.index.begin() + leaf.count);
      continue;
    }
    stack[size++] = node.place;
    stack[size++] = node.place + 1;
  }
  std::ranges::sort(found);
}

}  // namespace lambent::lighting
