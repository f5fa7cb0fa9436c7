// Adds what results depend on, of a group and its scene, to the keys under which they are cached
// (baker/cache). Keys follow content, so names, the order of materials and textures in the file, and the
// place of a group in the world do not change them.
#pragma once

#include "baker/cache/bytes.hpp"
#include "baker/cache/key.hpp"
#include "baker/import/scene.hpp"
#include "baker/transport/group_geometry.hpp"
#include "baker/transport/samples.hpp"

namespace lambent::baker {

template <>
inline constexpr bool kPlainBytes<SampleOrigin> = sizeof(SampleOrigin) == 11 * sizeof(float);
template <>
inline constexpr bool kPlainBytes<BrdfMeasurement> = sizeof(BrdfMeasurement) == 7 * sizeof(float);

// Adds triangles, normals and kinds of samples, which determine all samples.
void addShape(const GroupGeometry& geometry, KeyMaker& key);

// Adds what lets rays through beside the shape: sides, blending, and cut-outs and panes with their images.
void addOpacity(const Scene& scene, const GroupGeometry& geometry, KeyMaker& key);

// Adds a texture as it is looked up: the bytes of its image and its sampler.
void addTexture(const Scene& scene, std::int32_t texture, KeyMaker& key);
void addTextureRef(const Scene& scene, const gltf::TextureRef& ref, KeyMaker& key);

void addMesh(const bundle::MeshData& mesh, KeyMaker& key);

// Writes a mesh as bytes for the cache, and reads it back; readMesh returns false if the bytes end early.
void writeMesh(const bundle::MeshData& mesh, ByteWriter& out);
bool readMesh(ByteReader& in, bundle::MeshData& mesh);

}  // namespace lambent::baker
