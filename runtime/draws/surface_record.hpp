// Makes the record of one draw for the shaders of the raster pass, and tells which textures it uses. Reads
// the residency's tables and the placement of the world's nodes. A texture whose coordinates the mesh lacks
// counts as absent. Render thread.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <tuple>

#include <glm/vec3.hpp>

#include "runtime/bundle/gltf_types.hpp"
#include "runtime/draws/surface_shared.h"
#include "runtime/gpu/objects.hpp"
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

// Binds the textures of surfaces, each with its sampler, to the units that the shaders name. A texture that
// has not arrived shows as white, a normal map as flat, and an anisotropy texture as one that keeps the
// factors. One sampler is made per kind. Render thread only.
class TextureUnits {
 public:
  TextureUnits();

  void bind(const World& world, const SurfaceTextures& textures);
  // Binds the further textures of glossy surfaces, and the table of b(v) of their bundle.
  void bindGlossy(const World& world, const SurfaceTextures& textures, std::uint32_t bundle,
                  std::int32_t table);
  void unbindSamplers() const;

 private:
  void bindOne(GLuint unit, const streaming::ResidentBundle* bundle, std::int32_t texture);

  gpu::Texture white_, flat_, along_tangent_;
  std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t>, gpu::Sampler> samplers_;
};

// Makes multi-draws whose shaders know the index of their draw. The vertex array has one attribute, at
// location 0, that steps once per instance through 0, 1, 2, ..., so that a shader reads its command's base
// instance. gl_DrawID is not in OpenGL 4.5.

// Describes a command in the layout of glMultiDrawElementsIndirect.
struct DrawCommand {
  std::uint32_t count = 0, instance_count = 1, first_index = 0, base_vertex = 0, base_instance = 0;
};

class DrawIndices {
 public:
  explicit DrawIndices(std::string_view label) : vertices_(label) {}

  void reserve(std::size_t draw_count);
  // Binds the vertex array with `elements` as its index buffer.
  void bind(const gpu::Buffer& elements) const {
    glBindVertexArray(vertices_.id());
    glVertexArrayElementBuffer(vertices_.id(), elements.id());
  }
  // Draws the triangles of consecutive commands in the bound indirect buffer.
  static void draw(std::uint32_t first_command, std::uint32_t command_count, gpu::Counters& counters);

 private:
  gpu::VertexArray vertices_;
  gpu::Buffer indices_;
};

}  // namespace lambent::frame
