#include "baker/effects/volume/grids.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>

namespace lambent::baker {

DensityField::DensityField(const glm::uvec3& size, std::span<const float> density,
                           const glm::mat4& group_from_grid)
    : size_(size),
      group_from_grid_(group_from_grid),
      grid_from_group_(glm::inverse(glm::dmat4(group_from_grid))),
      points_(glm::ivec3(size) + 2),
      blocks_((points_ - 2 + kBlock) / kBlock) {
  assert(density.size() == std::size_t{size.x} * size.y * size.z);
  const glm::ivec3 last = glm::ivec3(size) - 1;
  const auto at = [&](const glm::ivec3& point) {
    const glm::uvec3 voxel(glm::clamp(point - 1, glm::ivec3(0), last));
    return density[voxel.x + std::size_t{size.x} * (voxel.y + std::size_t{size.y} * voxel.z)];
  };
  brick_of_.assign(static_cast<std::size_t>(blocks_.x) * static_cast<std::size_t>(blocks_.y) *
                       static_cast<std::size_t>(blocks_.z),
                   -1);
  std::vector<float> brick(kBrick);
  for (int z = 0; z < blocks_.z; ++z)
    for (int y = 0; y < blocks_.y; ++y)
      for (int x = 0; x < blocks_.x; ++x) {
        const glm::ivec3 low = kBlock * glm::ivec3(x, y, z);
        bool any = false;
        std::size_t i = 0;
        for (int k = 0; k <= kBlock; ++k)
          for (int j = 0; j <= kBlock; ++j)
            for (int n = 0; n <= kBlock; ++n, ++i) {
              brick[i] = at(low + glm::ivec3(n, j, k));
              any = any || brick[i] != 0.0f;
            }
        if (!any) continue;
        brick_of_[block({x, y, z})] = static_cast<std::int32_t>(bricks_.size() / kBrick);
        bricks_.insert(bricks_.end(), brick.begin(), brick.end());
      }
}

// The box reaches from 1/2 to size + 1/2 in the lattice.
bool DensityField::clip(const LatticeRay& ray, float& begin, float& end) const {
  for (int axis = 0; axis < 3; ++axis) {
    const float low = 0.5f, high = static_cast<float>(size_[axis]) + 0.5f;
    if (ray.direction[axis] == 0.0f) {
      if (ray.origin[axis] < low || ray.origin[axis] > high) return false;
      continue;
    }
    const float a = (low - ray.origin[axis]) * ray.inverse[axis],
                b = (high - ray.origin[axis]) * ray.inverse[axis];
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  return begin < end;
}

float DensityField::atGrid(const glm::vec3& grid) const {
  if (glm::any(glm::lessThan(grid, glm::vec3(0.0f))) || glm::any(glm::greaterThan(grid, glm::vec3(size_))))
    return 0.0f;
  const glm::vec3 at = grid + 0.5f;
  const glm::ivec3 cell = glm::clamp(glm::ivec3(glm::floor(at)), glm::ivec3(0), points_ - 2),
                   b = cell / kBlock;
  if (brick_of_[block(b)] < 0) return 0.0f;
  return corners(brickAt(b), cell - kBlock * b).at(glm::clamp(at - glm::vec3(cell), 0.0f, 1.0f));
}

float DensityField::opticalDepth(const glm::vec3& origin, const glm::vec3& direction, float t_max) const {
  float sum = 0.0f;
  const auto any_length = [](float) { return std::numeric_limits<float>::infinity(); };
  march(origin, direction, t_max, any_length, [&](float, float, float depth) {
    sum += depth;
    return sum < kOpaqueDepth;
  });
  return sum;
}

namespace {

// Returns the voxels of the density that reach into the box of one voxel to every side of the centre of voxel
// i: the first, and one past the last. (A voxel of the density reaches one voxel to either side of its
// centre, too.)
std::pair<std::uint32_t, std::uint32_t> reachOf(std::uint32_t i, std::uint32_t size,
                                                std::uint32_t density_size) {
  const double ratio = static_cast<double>(density_size) / static_cast<double>(size);
  const double low = (double{static_cast<double>(i)} - 0.5) * ratio,
               high = (static_cast<double>(i) + 1.5) * ratio;
  const double first = std::ceil(low - 1.5), end = std::floor(high + 0.5) + 1.0, most = density_size;
  return {static_cast<std::uint32_t>(std::clamp(first, 0.0, most - 1.0)),
          static_cast<std::uint32_t>(std::clamp(end, 1.0, most))};
}

// Computes along one axis whether anything lies in reach; the axes follow one after the other.
std::vector<std::uint8_t> reduced(std::span<const std::uint8_t> filled, const glm::uvec3& from, int axis,
                                  std::uint32_t size) {
  glm::uvec3 to = from;
  to[axis] = size;
  std::vector<std::uint8_t> out(std::size_t{to.x} * to.y * to.z, 0);
  const std::size_t stride = axis == 0 ? 1 : axis == 1 ? from.x : std::size_t{from.x} * from.y;
  std::size_t at = 0;
  for (std::uint32_t z = 0; z < to.z; ++z)
    for (std::uint32_t y = 0; y < to.y; ++y)
      for (std::uint32_t x = 0; x < to.x; ++x, ++at) {
        glm::uvec3 base(x, y, z);
        const auto [first, end] = reachOf(base[axis], size, from[axis]);
        base[axis] = 0;
        const std::size_t row = base.x + std::size_t{from.x} * (base.y + std::size_t{from.y} * base.z);
        for (std::uint32_t j = first; j < end && out[at] == 0; ++j) out[at] = filled[row + j * stride];
      }
  return out;
}

}  // namespace

TransferGrid::TransferGrid(const DensityField& density, std::span<const float> values,
                           const glm::uvec3& size) {
  group_from_grid_ = glm::dmat4(density.groupFromGrid()) *
                     glm::scale(glm::dmat4(1.0), glm::dvec3(density.size()) / glm::dvec3(size));
  grid_from_group_ = glm::inverse(group_from_grid_);
  const glm::dmat3 axes(group_from_grid_);
  shortest_edge_ =
      static_cast<float>(std::min({glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2])}));
  mean_edge_ = static_cast<float>(std::cbrt(std::abs(glm::determinant(axes))));

  std::vector<std::uint8_t> filled(values.size());
  std::transform(values.begin(), values.end(), filled.begin(),
                 [](float v) { return static_cast<std::uint8_t>(v > 0.0f); });
  glm::uvec3 now = density.size();
  for (int axis = 0; axis < 3; ++axis) {
    filled = reduced(filled, now, axis, size[axis]);
    now[axis] = size[axis];
  }
  Level& level = levels_.emplace_back(Level{size, std::vector<std::int32_t>(filled.size(), -1)});
  std::vector<double> mass;
  const glm::vec3 scale = glm::vec3(density.size()) / glm::vec3(size);
  for (std::uint32_t v = 0; v < filled.size(); ++v) {
    if (filled[v] == 0) continue;
    level.node[v] = static_cast<std::int32_t>(voxels_.size());
    voxels_.push_back(v);
    const glm::vec3 low(v % size.x, v / size.x % size.y, v / (size.x * size.y));
    double sum = 0.0;
    for (int k = 0; k < 8; ++k)
      sum += double{density.atGrid(scale * (low + 0.25f + 0.5f * glm::vec3(k & 1, k >> 1 & 1, k >> 2)))};
    mass.push_back(sum);
  }
  // Voxels that only reach into density have a small weight, so that every mean is defined.
  const double most = mass.empty() ? 0.0 : *std::max_element(mass.begin(), mass.end());
  for (double& m : mass) m += 1e-6 * most + 1e-30;
  nodes_ = voxels_.size();
  while (nodes_ > 0 && std::max({levels_.back().size.x, levels_.back().size.y, levels_.back().size.z}) > 2)
    addLevel(mass);
  linkNeighbors();
}

void TransferGrid::linkNeighbors() {
  neighbors_.resize(nodes_);
  for (const Level& level : levels_) {
    const std::size_t strides[] = {1, level.size.x, std::size_t{level.size.x} * level.size.y};
    for (std::size_t v = 0; v < level.node.size(); ++v) {
      if (level.node[v] < 0) continue;
      const glm::uvec3 at(v % level.size.x, v / level.size.x % level.size.y, v / strides[2]);
      auto& beside = neighbors_[static_cast<std::size_t>(level.node[v])];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto i = static_cast<int>(axis);
        beside[2 * axis] = at[i] > 0 ? level.node[v - strides[axis]] : -1;
        beside[2 * axis + 1] = at[i] + 1 < level.size[i] ? level.node[v + strides[axis]] : -1;
      }
    }
  }
}

void TransferGrid::addLevel(std::vector<double>& mass) {
  const Level& below = levels_.back();
  Level above{(below.size + 1u) / 2u, {}};
  above.node.assign(std::size_t{above.size.x} * above.size.y * above.size.z, -1);
  const std::size_t first_link = children_.size();
  std::size_t v = 0;
  for (std::uint32_t z = 0; z < below.size.z; ++z)
    for (std::uint32_t y = 0; y < below.size.y; ++y)
      for (std::uint32_t x = 0; x < below.size.x; ++x, ++v) {
        if (below.node[v] < 0) continue;
        std::int32_t& parent =
            above.node[x / 2 + std::size_t{above.size.x} * (y / 2 + std::size_t{above.size.y} * (z / 2))];
        if (parent < 0) {
          parent = static_cast<std::int32_t>(nodes_++);
          mass.push_back(0.0);
        }
        const auto child = static_cast<std::uint32_t>(below.node[v]);
        children_.push_back({static_cast<std::uint32_t>(parent), child, 0.0f});
        mass[static_cast<std::size_t>(parent)] += mass[child];
      }
  for (std::size_t i = first_link; i < children_.size(); ++i)
    children_[i].weight = static_cast<float>(mass[children_[i].child] / mass[children_[i].parent]);
  levels_.push_back(std::move(above));
}

glm::vec3 TransferGrid::place(std::size_t sample) const {
  const std::uint32_t v = voxels_[sample];
  const glm::uvec3& n = size();
  return glm::vec3(group_from_grid_ *
                   glm::dvec4(glm::dvec3(v % n.x, v / n.x % n.y, v / (n.x * n.y)) + 0.5, 1.0));
}

TransferGrid::Stencil TransferGrid::stencil(const glm::dvec3& grid, int level, bool beyond) const {
  const Level& l = levels_[static_cast<std::size_t>(level)];
  const glm::dvec3 last(glm::ivec3(l.size) - 1);
  glm::dvec3 at = grid * std::ldexp(1.0, -level) - 0.5;
  const glm::dvec3 inside = glm::clamp(at, glm::dvec3(0.0), last);
  // In the half voxel towards a face, `beyond` extends the line through the two voxels beside it.
  for (int axis = 0; axis < 3; ++axis)
    if (!beyond || last[axis] == 0.0) at[axis] = inside[axis];
  const glm::dvec3 base = glm::clamp(glm::floor(at), glm::dvec3(0.0), glm::max(last - 1.0, 0.0)),
                   f = at - base;
  const glm::uvec3 low(base), high = glm::min(low + 1u, l.size - 1u);
  Stencil out;
  out.fraction = f;
  double sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const bool x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
    const double weight = (x ? f.x : 1.0 - f.x) * (y ? f.y : 1.0 - f.y) * (z ? f.z : 1.0 - f.z);
    if (weight == 0.0) continue;
    const std::int32_t node =
        l.node[(x ? high.x : low.x) +
               std::size_t{l.size.x} * ((y ? high.y : low.y) + std::size_t{l.size.y} * (z ? high.z : low.z))];
    if (node < 0) continue;
    out.node[static_cast<std::size_t>(out.count)] = static_cast<std::uint32_t>(node);
    out.weight[static_cast<std::size_t>(out.count++)] = weight;
    sum += weight;
  }
  // If nodes are missing, the others stand in for them; beyond a face there is no line then.
  if (beyond && out.count < 8 && sum < 0.1) return stencil(grid, level, /*beyond=*/false);
  if (out.count < 8)
    for (int i = 0; i < out.count; ++i) out.weight[static_cast<std::size_t>(i)] /= sum;
  return out;
}

void TransferGrid::raise(std::span<float> values, std::size_t width) const {
  std::fill(values.begin() + static_cast<std::ptrdiff_t>(samples() * width), values.end(), 0.0f);
  for (const Child& link : children_) {
    float* to = &values[link.parent * width];
    const float* from = &values[link.child * width];
    for (std::size_t i = 0; i < width; ++i) to[i] += link.weight * from[i];
  }
}

}  // namespace lambent::baker
