// Encodes meshes with Draco, so that what ships is known before anything is baked on it. Positions lie on the
// lattice { k * step }, where step is a power of two. All meshes with the same step share one lattice, so
// vertices that coincide in two primitives still coincide to the bit after decoding, and no seam opens. A
// mesh comes in; the Draco buffer, the attribute ids for KHR_draco_mesh_compression and the mesh that the
// buffer decodes to go out. In the decoded mesh, vertices are reordered, identical ones merged, and triangles
// that collapse on the lattice dropped.
//
// Errors of the lossy attributes are: positions step/2 per axis; normals under 0.05 degrees (octahedral,
// kNormalBits); texture coordinates half of 1/65535 of their larger range; tangents under 0.03 degrees, their
// sign exact; colours 1/131070. Colours are 16-bit normalised RGBA, as in the glTF accessor of COLOR_0
// (componentType 5123, normalized); the other attributes are FLOAT.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/bundle/mesh.hpp"

namespace lambent::baker {

inline constexpr int kNormalBits = 13;  // 12 would err by up to 0.058 degrees
inline constexpr int kTexcoordBits = 16;
inline constexpr int kTangentBits = 12;      // steps of 2/4095 in each component: 0.02 degrees
inline constexpr int kMaxPositionBits = 23;  // Draco rounds by adding 0.5, which is exact in float up to 2^23

struct EncodedMesh {
  std::vector<std::byte> bytes;
  bundle::DracoAttributes attributes;
  bundle::MeshData decoded;
};

// Returns the smallest power of two with extent / step <= 2^bits, which gives `bits` bits per axis for a
// group of that size. `extent` is finite and > 0; 1 <= bits <= kMaxPositionBits.
float latticeStep(float extent, int bits);

// Errors name `subject`: the step is no power of two, the lattice is too fine for where the mesh lies, or no
// triangle is left.
Result<EncodedMesh> encodeDraco(const bundle::MeshData& mesh, float step, const std::string& subject);

}  // namespace lambent::baker
