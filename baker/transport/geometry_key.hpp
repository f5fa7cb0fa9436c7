// What of a group and of its scene results depend on, for the keys under which they are kept (baker/cache):
// by content, so that names, the order of materials and textures in the file, and where a group stands in the
// world play no part.
#pragma once

#include "baker/cache/bytes.hpp"
#include "baker/cache/key.hpp"
#include "baker/import/scene.hpp"
#include "baker/transport/group_geometry.hpp"
#include "baker/transport/samples.hpp"

namespace lambent::baker {

template <>
inline constexpr bool kPlainBytes<SampleOrigin> = sizeof(SampleOrigin) == 8 * sizeof(float);
template <>
inline constexpr bool kPlainBytes<BrdfMeasurement> = sizeof(BrdfMeasurement) == 7 * sizeof(float);

// Triangles, normals and kinds of samples: all that samples follow from.
void addShape(const GroupGeometry& geometry, KeyMaker& key);

// What lets rays through, beside the shape: sides, blending, cut-outs with their pictures.
void addOpacity(const Scene& scene, const GroupGeometry& geometry, KeyMaker& key);

// A texture as it is looked up: bytes of its picture and its sampler.
void addTexture(const Scene& scene, std::int32_t texture, KeyMaker& key);
void addTextureRef(const Scene& scene, const gltf::TextureRef& ref, KeyMaker& key);

void addMesh(const bundle::MeshData& mesh, KeyMaker& key);

// A mesh as bytes to keep, and back.
void writeMesh(const bundle::MeshData& mesh, ByteWriter& out);
bool readMesh(ByteReader& in, bundle::MeshData& mesh);

}  // namespace lambent::baker
