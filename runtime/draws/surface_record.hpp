// What the raster pass knows of one draw: its record for the shaders and the textures that it looks into.
// Reads the residency's tables and where the world's nodes stand. A texture whose coordinates the mesh lacks
// counts as absent.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>

#include <glm/vec3.hpp>

#include "runtime/bundle/gltf_types.hpp"
#include "runtime/draws/surface_shared.h"
#include "runtime/world/world.hpp"

namespace lambent::frame {

// Of the bundle's tables; -1: none.
struct SurfaceTextures {
  std::int32_t bundle = -1, base_color = -1, emissive = -1, normal = -1;
  // Of glossy draws.
  std::int32_t metallic_roughness = -1, specular = -1, specular_color = -1, anisotropy = -1;
  auto operator<=>(const SurfaceTextures&) const = default;
};

// How a mesh looks into a texture; absent where it lacks the coordinates.
TextureSlot slotOf(const gltf::TextureRef& texture, const streaming::ResidentMesh& mesh);

// As it is now; valid while the draw's bundle is.
const gltf::Material& materialOf(const World& world, std::size_t draw);

// Radiance that the surface gives off, before its texture.
glm::vec3 emissionOf(const World& world, std::size_t draw);

// Whether the draw has light in bands 0..2 at its vertices, to be received at the pixel's own normal.
bool normalMapped(const World& world, std::size_t draw);

SurfaceDraw describe(const World& world, std::size_t draw);
SurfaceTextures texturesOf(const World& world, std::size_t draw, const SurfaceDraw& record);

}  // namespace lambent::frame
