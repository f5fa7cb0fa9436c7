// Where transfer is computed. Vertices of a group with the same position and normal share one sample whatever
// their texture coordinates. Samples are cut into cells along a Morton curve, those of normal-mapped and
// those of glossy draws into cells of their own, which come last; in a cell they stand in the order in which
// vertices first use them: Draco walks over the mesh, so neighbours in memory are neighbours on the surface
// and rows code to nearly nothing. Rays of a sample start from several origins, one for each face around the
// vertex: pulled a little into the face and offset along its geometric normal. At concave edges anything else
// sees through walls. Faces that turn their back to the vertex' normal, flipped_faces of a scanned skin, have
// none, unless all do: what they see is seen by nobody.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/transport/group_geometry.hpp"

namespace lambent::baker {

inline constexpr float kPullIntoFace = 0.03f;            // share of the way to the face's centroid
inline constexpr std::uint32_t kMaxCellSamples = 65536;  // "64 Ki samples" of the format
inline constexpr std::uint32_t kNoSample = 0xffffffffu;  // of a vertex that is shown unshadowed

// One place from which a sample's rays start.
struct SampleOrigin {
  glm::vec3 position;          // as GroupGeometry::positions
  glm::vec3 geometric_normal;  // unit; rays below it are blocked
  float weight;                // the corner's angle; origins of one sample sum to 1
  // As far as the face is wide, but never far of the whole: what hides all of the sky from nearer than this
  // lies on the face, and not all over it.
  float reach = 0.0f;
};

struct SampleCell {
  std::uint32_t first = 0, count = 0;
  glm::vec3 bounds_min{0.0f}, bounds_max{0.0f};
  SampleKind kind = SampleKind::Diffuse;
};

struct SampleSet {
  std::vector<glm::vec3> positions;          // as GroupGeometry::positions
  std::vector<glm::vec3> normals;            // unit shading normals
  std::vector<std::uint32_t> vertex_sample;  // GroupGeometry vertex -> sample
  std::vector<SampleOrigin> origins;
  std::vector<std::uint32_t> origin_offsets;  // size() + 1; a sample without a face has none
  std::vector<SampleCell> cells;
  std::size_t first_normal_mapped =
      0;                         // samples from here on belong to normal-mapped draws that are not glossy
  std::size_t first_glossy = 0;  // and from here on to glossy ones

  std::size_t size() const { return positions.size(); }
  std::span<const SampleOrigin> originsOf(std::size_t sample) const {
    return std::span(origins).subspan(origin_offsets[sample],
                                      origin_offsets[sample + 1] - origin_offsets[sample]);
  }
};

// How far an origin stands off its face: what float rounding of positions and rays needs, and a little of the
// face's size (metres, of an edge); never a fixed length.
float standOff(const glm::vec3& position, float face_size);

// SampleOrigin::reach.
float reachOf(float face_size, const GroupGeometry& geometry);

SampleSet buildSamples(const GroupGeometry& geometry);

// Pairs of samples that share an edge of a face, each once as (smaller, larger), sorted. None where samples
// are not of vertices.
std::vector<std::pair<std::uint32_t, std::uint32_t>> sampleEdges(const GroupGeometry& geometry,
                                                                 const SampleSet& samples);

}  // namespace lambent::baker
