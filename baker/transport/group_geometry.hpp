// GroupGeometry is one rigid group as rays see it: the decoded meshes of all its draws, side by side in the
// group's frame. Triangles wind counter-clockwise seen from the outside, also under mirroring nodes. Back
// sides of double-sided materials are draws of their own, but share the triangles of the front for
// visibility. Transfer does not depend on position, so a group that stands far from its frame's origin is
// moved near it, where floats are fine enough for rays.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "baker/plan/rigid_groups.hpp"
#include "runtime/bundle/mesh.hpp"

namespace lambent::baker {

// SampleKind says what is stored for the samples of a draw.
enum class SampleKind : std::uint8_t {
  Diffuse,       // E/pi at the sample's normal
  NormalMapped,  // transferred light in bands 0..2, for any normal
  Glossy,        // transferred light in all bands, for any BRDF and normal
};

struct DrawGeometry {
  std::uint32_t first_vertex = 0, vertex_count = 0;
  std::uint32_t first_triangle = 0, triangle_count = 0;
  std::int32_t material = -1;
  bool back = false;  // the back of a double-sided material; the draw before it is its front
  SampleKind kind = SampleKind::Diffuse;
  bool layered = false;  // a smooth dielectric, which has no matrices (baker/plan/smooth_dielectrics.hpp)
  // Side of the texture whose texels have samples of their own (texel_samples.hpp); 0: vertices alone.
  std::uint32_t texels = 0;
};

struct GroupGeometry {
  glm::vec3 origin{0.0f};             // group frame, metres; 0 unless the group stands far away
  std::vector<glm::vec3> positions;   // relative to `origin`, along the group frame's axes, metres
  std::vector<glm::vec3> normals;     // unit; negated for back draws
  std::vector<float> normal_weights;  // as in MeshData, 1 where it has none
  // These are for the material's base-colour texture, transformed; 0 where it has none.
  std::vector<glm::vec2> texcoords;
  std::vector<glm::vec2> emissive_texcoords;  // for its emissive texture
  std::vector<glm::vec4> colors;              // vertex colours, linear; 1 where there are none
  // For the transmission texture of panes; 0 for vertices before those, and it ends with the last pane that
  // has one.
  std::vector<glm::vec2> pane_texcoords;
  // These two serve the textures of glossy surfaces. They hold values for the vertices of glossy draws, 0 for
  // those before them, and end with the last glossy one. `texcoord_sets` are as in the file, 0 if it has
  // none. `tangents` are unit, along the group's axes; w is the sign of the bitangent cross(normal, tangent)
  // w on that side of the surface; all are 0 if absent.
  std::array<std::vector<glm::vec2>, 2> texcoord_sets;
  std::vector<glm::vec4> tangents;
  // Place of each vertex in the texture, 0 to 1, of draws with texels; 0 for those before them, and it ends
  // with the last of them.
  std::vector<glm::vec2> chart_coordinates;
  std::vector<glm::uvec3> triangles;             // into positions; corners 1 and 2 are swapped for back draws
  std::vector<DrawGeometry> draws;               // in the order of RigidGroup::draws
  glm::vec3 bounds_min{0.0f}, bounds_max{0.0f};  // relative to `origin`
};

// Returns a normal that is twice the triangle's area long, in square metres.
glm::vec3 areaNormal(const GroupGeometry& geometry, const glm::uvec3& corners);
// Returns square metres.
double triangleArea(const GroupGeometry& geometry, const glm::uvec3& corners);
// Returns metres.
float longestEdge(const GroupGeometry& geometry, const glm::uvec3& corners);

// Interpolates the normals of a triangle's corners by their shares; returns a unit vector, or 0 where they
// cancel.
glm::vec3 interpolatedNormal(const GroupGeometry& geometry, const glm::uvec3& corners,
                             const glm::vec3& shares);

// decoded[mesh][primitive] is the mesh as it ships. With `with_glossy`, surfaces whose materials
// have matrices get glossy samples; without it all materials are Lambertian.
GroupGeometry buildGroupGeometry(const RigidGroup& group, const Scene& scene,
                                 const std::vector<std::vector<bundle::MeshData>>& decoded,
                                 bool with_glossy = false);

// Finds faces that are turned over: slivers that scanning and decimation leave, whose fronts look into the
// body. They are only seen from behind, but they lie on the faces beside them like lids, and a vertex under
// one would spread its darkness over all faces around it.

// Returns 1 for each triangle of a single-sided draw that faces away from the normals of at least two of its
// corners, else 0. If these make up more than a hundredth of a draw's area they are no accident, and none
// counts.
std::vector<std::uint8_t> findFlippedFaces(const GroupGeometry& geometry);

}  // namespace lambent::baker
