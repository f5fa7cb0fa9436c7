#include "baker/import/details.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "baker/import/mesh_edits.hpp"

namespace lambent::baker {

std::vector<std::vector<std::size_t>> connectedParts(std::span<const CornerTriangle> triangles,
                                                     std::size_t corners) {
  std::vector<std::uint32_t> parent(corners);
  std::iota(parent.begin(), parent.end(), 0u);
  const auto rootOf = [&](std::uint32_t corner) {
    while (parent[corner] != corner) corner = parent[corner] = parent[parent[corner]];
    return corner;
  };
  for (const CornerTriangle& triangle : triangles)
    for (const std::uint32_t corner : triangle) parent[rootOf(corner)] = rootOf(triangle[0]);
  std::map<std::uint32_t, std::vector<std::size_t>> parts;  // by root
  for (std::size_t t = 0; t < triangles.size(); ++t) parts[rootOf(triangles[t][0])].push_back(t);
  std::vector<std::vector<std::size_t>> list;
  for (auto& [root, part] : parts) list.push_back(std::move(part));
  return list;
}

bool isClosed(std::span<const CornerTriangle> triangles, std::span<const std::size_t> part) {
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  std::vector<std::pair<Edge, int>> edges;  // the lower corner first, and which way it is passed
  for (const std::size_t t : part)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      if (a != b) edges.push_back({std::minmax(a, b), a < b ? 1 : -1});
    }
  std::ranges::sort(edges);
  for (std::size_t i = 0; i < edges.size();) {
    int balance = 0;
    const Edge edge = edges[i].first;
    for (; i < edges.size() && edges[i].first == edge; ++i) balance += edges[i].second;
    if (balance != 0) return false;
  }
  return true;
}

namespace {

using bundle::MeshData;

// Scans have a few slivers in a hundred thousand triangles.
constexpr double kFewTriangles = 0.005;
// Fewer triangles make no shape that is worth a draw.
constexpr std::size_t kLeastPart = 12;
constexpr float kUsualSteps = 262144.0f;  // of a lattice along what it is for

std::vector<float> longestEdges(const MeshData& mesh) {
  std::vector<float> edges;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const auto corner = [&](std::size_t c) { return mesh.positions[mesh.indices[i + c]]; };
    edges.push_back(std::max({glm::distance(corner(0), corner(1)), glm::distance(corner(1), corner(2)),
                              glm::distance(corner(2), corner(0))}));
  }
  return edges;
}

// Returns the value that this share of them is less than.
float quantile(std::vector<float> values, double share) {
  if (values.empty()) return 0.0f;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  std::ranges::nth_element(values, at);
  return *at;
}

std::vector<std::vector<std::size_t>> weldedParts(const MeshData& mesh) {
  std::map<std::array<float, 3>, std::uint32_t> numbers;
  std::vector<CornerTriangle> triangles(mesh.indices.size() / 3);
  for (std::size_t i = 0; i < 3 * triangles.size(); ++i) {
    const glm::vec3 p = mesh.positions[mesh.indices[i]] + 0.0f;  // -0 is 0
    const auto next = static_cast<std::uint32_t>(numbers.size());
    triangles[i / 3][i % 3] = numbers.try_emplace({p.x, p.y, p.z}, next).first->second;
  }
  return connectedParts(triangles, numbers.size());
}

MeshData pick(const MeshData& mesh, const std::vector<std::size_t>& triangles) {
  MeshData picked = mesh;
  picked.indices.clear();
  std::vector<std::uint32_t> sources;
  std::vector<std::int64_t> place(mesh.positions.size(), -1);
  for (const std::size_t t : triangles)
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t vertex = mesh.indices[3 * t + c];
      if (place[vertex] < 0) {
        place[vertex] = static_cast<std::int64_t>(sources.size());
        sources.push_back(vertex);
      }
      picked.indices.push_back(static_cast<std::uint32_t>(place[vertex]));
    }
  gatherVertices(picked, sources);
  return picked;
}

// Returns the triangles of the fine parts by the exponent of their distance, and those of the rest under the
// key `rest`. Returns nothing if there are not both.
std::map<int, std::vector<std::size_t>> divide(const MeshData& mesh, int rest) {
  PlacedBox box;
  for (const glm::vec3& position : mesh.positions) box.add(glm::dvec3(position));
  const float step = static_cast<float>(box.side()) / kUsualSteps;
  const std::vector<float> edges = longestEdges(mesh);
  if (std::ranges::none_of(edges, [&](float edge) { return bends(step, edge); })) return {};
  std::map<int, std::vector<std::size_t>> found;
  for (const std::vector<std::size_t>& part : weldedParts(mesh)) {
    std::vector<float> own;
    double farthest = 0.0;
    for (const std::size_t t : part) {
      own.push_back(edges[t]);
      for (std::size_t c = 0; c < 3; ++c)
        farthest = std::max(farthest, largest(glm::dvec3(mesh.positions[mesh.indices[3 * t + c]])));
    }
    const bool fine = part.size() >= kLeastPart && bends(step, quantile(own, 0.5));
    std::vector<std::size_t>& list = found[fine ? std::ilogb(farthest) : rest];
    list.insert(list.end(), part.begin(), part.end());
  }
  if (found.size() < 2) return {};
  for (auto& [key, triangles] : found) std::ranges::sort(triangles);  // as in the file
  return found;
}

}  // namespace

float detailOf(const MeshData& mesh) {
  return quantile(longestEdges(mesh), kFewTriangles);
}

void separateDetails(SceneMesh& mesh) {
  constexpr int kRest = 1 << 20;
  const std::size_t count = mesh.primitives.size();
  for (std::size_t p = 0; p < count; ++p) {
    const auto parts = divide(mesh.primitives[p].mesh, kRest);
    if (parts.empty()) continue;
    const ScenePrimitive whole = std::move(mesh.primitives[p]);
    bool first = true;
    for (auto part = parts.rbegin(); part != parts.rend(); ++part) {  // the rest first
      ScenePrimitive divided{.mesh = pick(whole.mesh, part->second),
                             .material = whole.material,
                             .texels = whole.texels,
                             .texel_set = whole.texel_set};
      if (std::exchange(first, false))
        mesh.primitives[p] = std::move(divided);
      else
        mesh.primitives.push_back(std::move(divided));
    }
  }
}

}  // namespace lambent::baker
