// Samples are the points where transfer is computed. Vertices of a group with the same position and normal
// share one sample, whatever their texture coordinates. Samples are cut into cells along a Morton curve;
// those of normal-mapped and of glossy draws get cells of their own, which come last. Within a cell, samples
// keep the order in which vertices first use them: Draco walks over the mesh, so neighbours in memory are
// neighbours on the surface and rows code to nearly nothing.
//
// Rays of a sample start from several origins, one for each face around the vertex, pulled a little into the
// face and offset along its geometric normal; at concave edges anything else sees through walls. Faces that
// turn away from the vertex normal, such as flipped faces of a scan, have no origin unless all faces do,
// since nobody sees what they see. A vertex that stands inside or under something has its origins moved
// further into the faces (findSeenOrigins).
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "baker/transport/group_geometry.hpp"

namespace lambent::baker {

inline constexpr float kPullIntoFace = 0.03f;            // share of the way to the face's centroid
inline constexpr std::uint32_t kMaxCellSamples = 65536;  // "64 Ki samples" in the format
inline constexpr std::uint32_t kNoSample = 0xffffffffu;  // marks a vertex that is shown unshadowed

// A SampleOrigin is one place from which a sample's rays start.
struct SampleOrigin {
  glm::vec3 position;          // as GroupGeometry::positions
  glm::vec3 geometric_normal;  // unit; rays below its horizon are blocked
  float weight;                // by the corner's angle; origins of one sample sum to 1
  // In metres, this is as long as the face's longest edge, but at most a small share of the group. If all of
  // the sky is hidden from nearer than this, something lies on the face itself.
  float reach = 0.0f;
  // This leads to the middle of the face. If this place is hidden, others on the way may not be.
  glm::vec3 inward{0.0f};
};

// Samples of one kind stand side by side.
struct SampleStretch {
  std::size_t begin = 0, end = 0;
  std::size_t size() const { return end - begin; }
  bool empty() const { return begin == end; }
};

struct SampleCell {
  std::uint32_t first = 0, count = 0;
  glm::vec3 bounds_min{0.0f}, bounds_max{0.0f};
  SampleKind kind = SampleKind::Diffuse;
};

// A TexelMap says which sample each texel of a draw's texture has.
struct TexelMap {
  std::uint32_t draw = 0, side = 0;
  std::uint32_t first_triangle = 0, triangle_count = 0;
  std::vector<std::uint32_t> sample_of;    // side² entries, row by row; kNoSample outside charts
  std::vector<std::uint32_t> triangle_of;  // where that sample lies
};

struct SampleSet {
  std::vector<glm::vec3> positions;          // as GroupGeometry::positions
  std::vector<glm::vec3> normals;            // unit shading normals
  std::vector<std::uint32_t> vertex_sample;  // GroupGeometry vertex -> sample
  std::vector<SampleOrigin> origins;
  std::vector<std::uint32_t> origin_offsets;  // size() + 1; a sample without a face has no origins
  std::vector<SampleCell> cells;
  SampleStretch diffuse, normal_mapped, glossy;  // one after the other
  std::vector<TexelMap> texels;                  // of the draws that have texels; their samples are diffuse

  std::size_t size() const { return positions.size(); }
  std::span<const SampleOrigin> originsOf(std::size_t sample) const {
    return std::span(origins).subspan(origin_offsets[sample],
                                      origin_offsets[sample + 1] - origin_offsets[sample]);
  }
};

// Returns how far an origin stands off its face, metres: as much as float rounding of positions and rays
// needs, plus a little of the face's size (metres, of an edge). A fixed length would not suit all scales.
float standOff(const glm::vec3& position, float face_size);

// Returns SampleOrigin::reach for a face with these corners, metres.
float reachOf(const glm::uvec3& corners, const GroupGeometry& geometry);

// Without texels, draws that have some get the samples of their vertices alone, as refinement needs them.
SampleSet buildSamples(const GroupGeometry& geometry, bool with_texels = true);

using SampleEdges = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

// Returns the pairs of samples that share an edge of a face, or of neighbouring texels, each once as
// (smaller, larger), sorted. The list is empty if samples do not belong to vertices.
SampleEdges sampleEdges(const GroupGeometry& geometry, const SampleSet& samples);

// Returns square metres per sample; a third of each triangle goes to each of its corners, or all of it in
// equal parts to its texels. Both sides of a double-sided surface count.
std::vector<float> sampleAreas(const GroupGeometry& geometry, const SampleSet& samples);

// Makes samples inside faces, beside those at vertices. Transfer at them is what interpolation over the faces
// is fitted to (effects/surface/inside_faces.hpp).

struct FacePoints {
  SampleSet samples;                     // without vertices and cells
  std::vector<std::uint32_t> triangles;  // of each sample, into GroupGeometry::triangles
};

// A FacePoint is a point of a triangle as a sample.
struct FacePoint {
  glm::vec3 position, normal;  // interpolated; the normal is unit
  SampleOrigin origin;         // a little off the face
};
// `weights` are those of the corners and sum to 1. The triangle must have an area.
FacePoint facePoint(const GroupGeometry& geometry, const glm::uvec3& corners, const glm::vec3& weights);

// Returns the centroids of the triangles listed: first those of diffuse draws, then of normal-mapped and of
// glossy ones, as in SampleSet. Faces that turn away from their normal have no origins, since nobody sees
// their front. Triangles without area give no point.
FacePoints facePoints(const GroupGeometry& geometry, const SampleSet& samples,
                      std::span<const std::uint32_t> triangles);

// A DirectionTable holds the directions of every sample's rays over the local hemisphere (z up). They are
// low-discrepancy and sorted along a Hilbert curve, so that sixteen neighbours make a coherent ray packet.
// All samples share one table, so its spherical harmonics are evaluated once.

inline constexpr std::size_t kPacketWidth = 16;

struct DirectionTable {
  // These are unit vectors, with one array per axis; the size is a multiple of kPacketWidth.
  std::vector<float> x, y, z;

  std::size_t size() const { return x.size(); }
  std::size_t packets() const { return x.size() / kPacketWidth; }
};

// Makes directions with pdf = cos/pi: a Fibonacci lattice on the unit square goes through the concentric map
// to the disc (Shirley and Chiu 1997) and is lifted to the hemisphere (Malley). `rays` is rounded up to whole
// packets.
DirectionTable cosineTable(std::size_t rays);

// Spreads the same points evenly over the hemisphere: pdf = 1/(2 pi). This serves light that is evaluated at
// any normal, for which light near the horizon counts.
DirectionTable uniformTable(std::size_t rays);

// Builds the local frame of a sample, with z along its normal, without a singularity at the poles (Duff et
// al., JCGT 6(1), 2017).

// Returns group_from_local, whose columns are tangent, bitangent and normal. `n` is a unit vector.
inline glm::dmat3 localFrame(const glm::dvec3& n) {
  const double sign = std::copysign(1.0, n.z);
  const double a = -1.0 / (sign + n.z);
  const double b = n.x * n.y * a;
  return {glm::dvec3(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
          glm::dvec3(b, sign + n.y * n.y * a, -n.y), n};
}

}  // namespace lambent::baker
