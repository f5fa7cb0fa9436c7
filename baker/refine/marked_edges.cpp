#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>

#include <glm/geometric.hpp>

#include "baker/import/mesh_edits.hpp"
#include "baker/refine/group_refiner.hpp"
#include "baker/transport/samples.hpp"

namespace lambent::baker {

CopiesOfMeshes copiesOf(const std::vector<RigidGroup>& groups,
                        const std::vector<std::vector<bundle::MeshData>>& meshes) {
  CopiesOfMeshes copies;
  for (const auto& primitives : meshes) copies.emplace_back(primitives.size(), 0);
  for (const RigidGroup& group : groups)
    for (const PlannedDraw& draw : group.draws)
      if (!draw.back) ++copies[draw.mesh][draw.primitive];
  for (auto& primitives : copies)
    for (std::size_t& count : primitives) count = std::max<std::size_t>(count, 1);
  return copies;
}

std::size_t countDrawn(const CopiesOfMeshes& copies,
                       const std::vector<std::vector<bundle::MeshData>>& meshes) {
  std::size_t count = 0;
  for (std::size_t m = 0; m < meshes.size(); ++m)
    for (std::size_t p = 0; p < meshes[m].size(); ++p) count += copies[m][p] * meshes[m][p].positions.size();
  return count;
}

namespace {

// A vertex lies before a surface that cuts its face by this share of the extent, which is a few steps of the
// lattice of positions. An edge that begins nearer than this many times as far before it is not cut again.
constexpr float kBeforeCut = 1.0f / 32768.0f, kLeastCut = 2.0f;

// Returns a unit normal, or 0 for a triangle without area.
glm::vec3 unitNormal(const GroupGeometry& geometry, std::uint32_t triangle) {
  const glm::vec3 normal = areaNormal(geometry, geometry.triangles[triangle]);
  const float length = glm::length(normal);
  return length > 0.0f ? normal / length : glm::vec3(0.0f);
}

}  // namespace

std::vector<float> cutShares(const GroupGeometry& scene, const RayScene& rays, float extent,
                             const GroupGeometry& geometry, std::span<const FaceEdge> edges, float longest) {
  const float before = kBeforeCut * extent;  // the distance of a vertex from a cut
  std::vector<RaySegment> ways;
  for (const FaceEdge& edge : edges) {
    const glm::vec3 a = geometry.positions[edge.a], b = geometry.positions[edge.b];
    const auto area = static_cast<float>(triangleArea(geometry, geometry.triangles[edge.triangle]));
    const glm::vec3 off = standOff(a, std::sqrt(area)) * unitNormal(geometry, edge.triangle);
    const float length = glm::distance(a, b);  // 0 where two vertices of a face are in one place
    const glm::vec3 along = length > 0.0f ? (b - a) / length : glm::vec3(0.0f);
    ways.push_back({a + off, along, length});
    ways.push_back({b + off, -along, length});
  }
  std::vector<FirstHit> hits(ways.size());
  rays.firstHits(ways, hits);
  // Returns the share of a way that lies before the surface that cuts it, less what its vertex keeps away, or
  // 0 if none does: surfaces that touch an end, as walls do the rim of a floor, cut nothing.
  const auto shareBefore = [&](std::size_t way) {
    if (!hits[way].any() || ways[way].length > longest) return 0.0f;
    const float steep = std::abs(glm::dot(unitNormal(scene, hits[way].triangle), ways[way].direction));
    const float distance = hits[way].distance;
    const bool cuts =
        distance * steep > kLeastCut * before && (ways[way].length - distance) * steep > 0.5f * before;
    return cuts ? (distance - before / steep) / ways[way].length : 0.0f;
  };
  std::vector<float> shares(edges.size(), 0.0f);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    shares[i] = shareBefore(2 * i);
    if (const float other = shareBefore(2 * i + 1); shares[i] == 0.0f && other > 0.0f)
      shares[i] = 1.0f - other;
  }
  return shares;
}

namespace {

// Shares of edges are multiples of its inverse, so that 1 - share has the same bits whichever end comes
// first.
constexpr float kShareSteps = 65536.0f;

std::uint64_t pairOf(std::uint32_t a, std::uint32_t b) {
  const auto [low, high] = std::minmax(a, b);
  return std::uint64_t{low} << 32 | high;
}

// Returns a number for each vertex; vertices at exactly the same position have the same one.
std::vector<std::uint32_t> placesIn(const GroupGeometry& geometry) {
  std::vector<std::uint32_t> order(geometry.positions.size()), places(geometry.positions.size());
  for (std::uint32_t v = 0; v < order.size(); ++v) order[v] = v;
  const auto key = [&](std::uint32_t v) {
    const glm::vec3& p = geometry.positions[v];
    return std::array{p.x, p.y, p.z};
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  std::uint32_t place = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i > 0 && key(order[i]) != key(order[i - 1])) ++place;
    places[order[i]] = place;
  }
  return places;
}

// Calls visit(a, b) with the vertices at the ends of every edge of every triangle.
template <typename Visit>
void forEdges(const bundle::MeshData& mesh, const Visit& visit) {
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
    for (std::size_t c = 0; c < 3; ++c) visit(mesh.indices[i + c], mesh.indices[i + (c + 1) % 3]);
}

}  // namespace

MarkedEdges::MarkedEdges(const std::vector<RigidGroup>& groups, const std::vector<GroupGeometry>& geometries,
                         const std::vector<std::vector<bundle::MeshData>>& meshes)
    : groups_(groups),
      geometries_(geometries),
      meshes_(meshes),
      in_group_(groups.size()),
      copies_(copiesOf(groups, meshes)) {
  for (const GroupGeometry& geometry : geometries) place_.push_back(placesIn(geometry));
  for (const auto& primitives : meshes)
    in_mesh_.emplace_back(primitives.size()), counted_.emplace_back(primitives.size());
}

// Counts an edge once in all copies of its mesh.
std::size_t MarkedEdges::added(std::size_t group, std::uint32_t a, std::uint32_t b) {
  const auto& draws = geometries_[group].draws;
  const auto after = std::ranges::upper_bound(draws, a, {}, &DrawGeometry::first_vertex);
  const auto index = static_cast<std::size_t>(after - draws.begin()) - 1;
  const PlannedDraw& draw = groups_[group].draws[index];
  const std::uint32_t first = draws[index].first_vertex;
  const bool counted = !counted_[draw.mesh][draw.primitive].insert(pairOf(a - first, b - first)).second;
  return counted ? 0 : copies_[draw.mesh][draw.primitive];
}

std::uint64_t MarkedEdges::placesOf(std::size_t group, std::uint32_t a, std::uint32_t b) const {
  return pairOf(place_[group][a], place_[group][b]);
}

std::optional<std::size_t> MarkedEdges::mark(std::size_t group, std::uint32_t a, std::uint32_t b) {
  if (!in_group_[group].try_emplace(placesOf(group, a, b), 0.5f).second) return std::nullopt;
  return added(group, a, b);
}

void MarkedEdges::splitAt(std::size_t group, std::uint32_t a, std::uint32_t b, float share) {
  const float rounded = std::round(share * kShareSteps) / kShareSteps;
  in_group_[group][placesOf(group, a, b)] = place_[group][a] < place_[group][b] ? rounded : 1.0f - rounded;
}

// Carries marks from groups to the meshes that are drawn there, and back. Returns false once nothing is new.
bool MarkedEdges::spread() {
  bool any = false;
  for (std::size_t g = 0; g < groups_.size(); ++g)
    for (std::size_t d = 0; d < groups_[g].draws.size(); ++d) {
      const PlannedDraw& draw = groups_[g].draws[d];
      const std::uint32_t first = geometries_[g].draws[d].first_vertex;
      auto& marked = in_mesh_[draw.mesh][draw.primitive];
      if (in_group_[g].empty() && marked.empty()) continue;
      forEdges(meshes_[draw.mesh][draw.primitive], [&](std::uint32_t a, std::uint32_t b) {
        const bool turned = (place_[g][first + a] < place_[g][first + b]) != (a < b);
        const auto across = [&](float share) { return turned ? 1.0f - share : share; };
        const std::uint64_t places = placesOf(g, first + a, first + b), vertices = pairOf(a, b);
        if (const auto found = in_group_[g].find(places); found != in_group_[g].end())
          any |= marked.try_emplace(vertices, across(found->second)).second;
        else if (const auto own = marked.find(vertices); own != marked.end())
          any |= in_group_[g].try_emplace(places, across(own->second)).second;
      });
    }
  return any;
}

void MarkedEdges::split(std::vector<std::vector<bundle::MeshData>>& meshes) {
  while (spread()) {
  }
  for (std::size_t m = 0; m < in_mesh_.size(); ++m)
    for (std::size_t p = 0; p < in_mesh_[m].size(); ++p) {
      const auto& marked = in_mesh_[m][p];
      if (marked.empty()) continue;
      splitMarkedEdges(meshes[m][p], [&](std::uint32_t a, std::uint32_t b) {
        const auto found = marked.find(pairOf(a, b));
        return found == marked.end() ? 0.0f : a < b ? found->second : 1.0f - found->second;
      });
    }
}

}  // namespace lambent::baker
