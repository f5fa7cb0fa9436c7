// Adds what results depend on, of a group and its scene, to the keys under which they are cached
// (baker/cache). Keys follow content, so names, the order of materials and textures in the file, and the
// place of a group in the world do not change them.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include <glm/vec3.hpp>

#include "baker/cache/key.hpp"
#include "baker/import/scene_digest.hpp"
#include "baker/transport/group_geometry.hpp"
#include "baker/transport/samples.hpp"

namespace lambent::baker {

template <>
inline constexpr bool kPlainBytes<SampleOrigin> = sizeof(SampleOrigin) == 11 * sizeof(float);

// Adds triangles, normals and kinds of samples, which determine all samples.
void addShape(const GroupGeometry& geometry, KeyMaker& key);

// Adds what lets rays through beside the shape: sides, blending, and cut-outs and panes with their images.
void addOpacity(const Scene& scene, const GroupGeometry& geometry, KeyMaker& key);

// Adds a texture as it is looked up: the bytes of its image and its sampler.
void addTexture(const Scene& scene, std::int32_t texture, KeyMaker& key);
void addTextureRef(const Scene& scene, const gltf::TextureRef& ref, KeyMaker& key);

template <>
inline constexpr auto kKeptMembers<bundle::MeshData> =
    std::tuple(&bundle::MeshData::positions, &bundle::MeshData::normals, &bundle::MeshData::normal_weights,
               &bundle::MeshData::texcoords0, &bundle::MeshData::texcoords1, &bundle::MeshData::colors,
               &bundle::MeshData::tangents, &bundle::MeshData::indices);

// A VertexKey identifies a surface point by the bits of its position and normal and by what is stored there;
// points with the same key have the same transfer.

using VertexKey = std::array<std::uint32_t, 8>;  // the last is for callers

struct VertexKeyHash {
  std::size_t operator()(const VertexKey& key) const {
    std::uint64_t hash = 0x9E3779B97F4A7C15u;
    for (const std::uint32_t word : key) hash = (hash ^ word) * 0xD6E8FEB86659FD93u, hash ^= hash >> 32;
    return hash;
  }
};

inline VertexKey vertexKey(const glm::vec3& position, const glm::vec3& normal, SampleKind kind) {
  const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value); };
  return {bits(position.x),
          bits(position.y),
          bits(position.z),
          bits(normal.x),
          bits(normal.y),
          bits(normal.z),
          static_cast<std::uint32_t>(kind),
          0};
}

}  // namespace lambent::baker
