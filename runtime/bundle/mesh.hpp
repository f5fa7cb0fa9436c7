// Decodes meshes. Both the runtime and the baker use the mesh that Draco decodes, never the one that was
// encoded, so that the bake matches what ships.
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

// Holds a decoded mesh with one array per attribute. An array is empty if the mesh lacks the attribute.
struct MeshData {
  std::vector<glm::vec3> positions;  // mesh space
  std::vector<glm::vec3> normals;    // unit length
  // Weights of normals when they are interpolated, above 0 and at most 1; all are 1 if empty. A vertex that
  // splits an edge has the mean of two normals, which is shorter than they are. Its weight keeps that length,
  // so that normals along the edge interpolate as before the split.
  std::vector<float> normal_weights = {};
  std::vector<glm::vec2> texcoords0;
  std::vector<glm::vec2> texcoords1;
  std::vector<glm::vec4> colors;       // linear, 0..1
  std::vector<glm::vec4> tangents;     // unit xyz; w is the sign of the bitangent, as in glTF
  std::vector<std::uint32_t> indices;  // triangles, counter-clockwise seen from outside
};

// Decodes a Draco buffer. Fails, naming `subject`, if it is not Draco or not a mesh, if an attribute is
// missing, counts differ from the primitive's, indices are out of range, or values are not finite.
Result<MeshData> decodeDraco(std::span<const std::byte> bytes, const Primitive& primitive,
                             const std::string& subject);

// Decodes an attribute that MeshData does not have, such as joints or weights. Returns four floats per vertex
// in the order of decodeDraco(); missing components are 1. Fails like decodeDraco().
Result<std::vector<glm::vec4>> decodeDracoAttribute(std::span<const std::byte> bytes,
                                                    const Primitive& primitive, std::int32_t id,
                                                    const std::string& name, const std::string& subject);

// Multiplies normals by their weights, as the vertex shader interpolates them, and empties the weights.
void weighNormals(MeshData& mesh);

// Returns the XXH3-64 of positions and indices, which ties transfer to exactly this mesh.
std::uint64_t meshDigest(const MeshData& mesh);

}  // namespace lambent::bundle
