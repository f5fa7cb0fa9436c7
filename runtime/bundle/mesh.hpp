// A mesh as the runtime draws it and as the baker bakes it: what Draco gives back, never what went in ("bake
// what ships"). One float array per attribute; empty where the mesh has none.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/base/result.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::bundle {

struct MeshData {
  std::vector<glm::vec3> positions;  // mesh space
  std::vector<glm::vec3> normals;    // unit length
  // By which normals count where they are interpolated, above 0 and at most 1; empty: all 1. The mean of two
  // normals is shorter than they are, and a vertex that splits an edge keeps that: else the two halves of the
  // edge would turn from one normal to the other in another way than the whole did.
  std::vector<float> normal_weights = {};
  // Vertices of one position and normal hold transfer of their own where these differ, each of the faces
  // around that use it (a fan of them); empty: all 0.
  std::vector<std::uint8_t> fans = {};
  std::vector<glm::vec2> texcoords0;   // may be empty
  std::vector<glm::vec2> texcoords1;   // may be empty
  std::vector<glm::vec4> colors;       // linear, 0..1; may be empty
  std::vector<glm::vec4> tangents;     // as glTF: unit xyz, w the bitangent's sign; may be empty
  std::vector<std::uint32_t> indices;  // triangles, counter-clockwise seen from outside
};

// Decodes a Draco buffer. Errors name `subject`: not Draco, not a mesh, an attribute missing, counts that
// differ from the primitive's, indices out of range, values that are not finite.
Result<MeshData> decodeDraco(std::span<const std::byte> bytes, const Primitive& primitive,
                             const std::string& subject);

// One attribute of a Draco buffer that MeshData has no place for (joints, weights): four floats a vertex in
// the order of decodeDraco(), 1 where it has fewer components. Checks and errors as there.
Result<std::vector<glm::vec4>> decodeDracoAttribute(std::span<const std::byte> bytes,
                                                    const Primitive& primitive, std::int32_t id,
                                                    const std::string& name, const std::string& subject);

// Normals times their weights, as vertices hand them to pixels; the weights are empty then.
void weighNormals(MeshData& mesh);

// XXH3-64 over positions and indices: transfer belongs to exactly this mesh.
std::uint64_t meshDigest(const MeshData& mesh);

}  // namespace lambent::bundle
