// Makes the record of one draw for the shaders of the raster pass, and tells which textures it uses. Reads
// the residency's tables and the placement of the world's nodes. A texture whose coordinates the mesh lacks
// counts as absent. Render thread.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>

#include <glm/vec3.hpp>

#include "runtime/bundle/gltf_types.hpp"
#include "runtime/draws/surface_shared.h"
#include "runtime/world/world.hpp"

namespace lambent::frame {

// Holds indices into the bundle's tables; -1 means none.
struct SurfaceTextures {
  std::int32_t bundle = -1, base_color = -1, emissive = -1, normal = -1;
  // These are used by glossy and layered draws only.
  std::int32_t metallic_roughness = -1, specular = -1, specular_color = -1, anisotropy = -1;
  auto operator<=>(const SurfaceTextures&) const = default;
};

// Returns how a mesh looks up a texture. The slot is absent if the mesh lacks the coordinates.
TextureSlot slotOf(const gltf::TextureRef& texture, const streaming::ResidentMesh& mesh);

// Returns the current material; valid as long as the draw's bundle is.
const gltf::Material& materialOf(const World& world, std::size_t draw);

// Returns the radiance that the surface emits, before its texture.
glm::vec3 emissionOf(const World& world, std::size_t draw);

// Returns whether the draw has light in bands 0..2 at its vertices, for shading with the pixel's own normal.
bool normalMapped(const World& world, std::size_t draw);

// Returns whether the draw takes E/pi from the texels of a texture.
bool hasTexels(const World& world, std::size_t draw);

SurfaceDraw describe(const World& world, std::size_t draw);
SurfaceTextures texturesOf(const World& world, std::size_t draw, const SurfaceDraw& record);

}  // namespace lambent::frame
