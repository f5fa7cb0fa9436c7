#include "baker/refine/face_cuts.hpp"

#include <cmath>

#include <glm/geometric.hpp>

#include "baker/transport/face_points.hpp"
#include "baker/transport/samples.hpp"

namespace lambent::baker {

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

FaceCuts::FaceCuts(const GroupGeometry& scene, const RayScene& rays, float extent)
    : rays_(rays), before_(kBeforeCut * extent) {
  for (std::uint32_t t = 0; t < scene.triangles.size(); ++t) normals_.push_back(unitNormal(scene, t));
}

std::vector<float> FaceCuts::sharesOf(const GroupGeometry& geometry, std::span<const FaceEdge> edges,
                                      float longest) const {
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
  rays_.firstHits(ways, hits);
  // Returns the share of a way that lies before the surface that cuts it, less what its vertex keeps away, or
  // 0 if none does: surfaces that touch an end, as walls do the rim of a floor, cut nothing.
  const auto shareBefore = [&](std::size_t way) {
    if (!hits[way].any() || ways[way].length > longest) return 0.0f;
    const float steep = std::abs(glm::dot(normals_[hits[way].triangle], ways[way].direction));
    const float distance = hits[way].distance;
    const bool cuts =
        distance * steep > kLeastCut * before_ && (ways[way].length - distance) * steep > 0.5f * before_;
    return cuts ? (distance - before_ / steep) / ways[way].length : 0.0f;
  };
  std::vector<float> shares(edges.size(), 0.0f);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    shares[i] = shareBefore(2 * i);
    if (const float other = shareBefore(2 * i + 1); shares[i] == 0.0f && other > 0.0f)
      shares[i] = 1.0f - other;
  }
  return shares;
}

}  // namespace lambent::baker
