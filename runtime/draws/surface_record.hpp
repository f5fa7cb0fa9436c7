// Makes the record of one draw for the shaders of the raster pass, and tells which textures it uses. Reads
// the residency's tables and the placement of the world's nodes. A texture whose coordinates the mesh lacks
// counts as absent. Render thread.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <tuple>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/bundle/gltf_types.hpp"
#include "runtime/draws/surface_shared.h"
#include "runtime/gpu/objects.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/sh/zonal.hpp"
#include "runtime/streaming/textures.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

// The uniform block of the camera, as surface.vert and the shaders that draw over its picture read it.
struct ViewBlock {
  glm::mat4 view_from_world, clip_from_view;
  glm::vec4 eye;  // see view_block.glsl
};

// Returns whether all of the box lies on the far side of one plane of the frustum. A box that surrounds a
// corner of the frustum may be outside and still count as in view.
inline bool outOfView(const glm::mat4& clip_from_box, const scene::Box& box) {
  constexpr float kMargin = 1.0001f;  // for rounding
  int beyond[6] = {};                 // corners beyond each plane
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec4 clip =
        clip_from_box * glm::vec4(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                                  corner & 4 ? box.max.z : box.min.z, 1.0f);
    for (int axis = 0; axis < 3; ++axis) {
      beyond[2 * axis] += clip[axis] > kMargin * clip.w;
      beyond[2 * axis + 1] += -clip[axis] > kMargin * clip.w;
    }
  }
  for (const int corners : beyond)
    if (corners == 8) return true;
  return false;
}

// Holds indices into the bundle's tables; -1 means none.
struct SurfaceTextures {
  std::int32_t bundle = -1, base_color = -1, emissive = -1, normal = -1;
  // These are used by glossy and layered draws only.
  std::int32_t metallic_roughness = -1, specular = -1, specular_color = -1, anisotropy = -1;
  auto operator<=>(const SurfaceTextures&) const = default;
};

// Returns how a mesh looks up a texture. The slot is absent if the mesh lacks the coordinates.
TextureSlot slotOf(const gltf::TextureRef& texture, const streaming::ResidentMesh& mesh);

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

// Makes the part of the record of a glossy or layered draw that other draws lack: its reflection parameters,
// where its rows and samples lie, and its table of b(v). Reads the residency's tables and the placement of
// the world's groups. Render thread.

// Names the table of b(v) that a glossy draw uses: that for its current material if the bundle has such a
// table, else for the baked material. A GGX table with anisotropy also serves materials without; if there is
// only one without, anisotropy does not show.
struct BrdfChoice {
  std::int32_t table = -1;  // index in its bundle; -1: there is none
  bundle::BrdfFamily family = bundle::BrdfFamily::Ggx;
};
BrdfChoice brdfChoiceOf(std::span<const bundle::BrdfFamily> tables, const gltf::Material& now,
                        const gltf::Material& baked);

// Returns the index of a draw's table in its bundle, or -1 if no table fits.
std::int32_t brdfTableOf(const World& world, std::size_t draw);

// Returns whether the draw's mesh, rows and table are resident. Its samples always have light.
bool glossyReady(const World& world, std::size_t draw);

// Returns whether a draw with a specular layer has its table and its place for what its vertices see.
bool layerReady(const World& world, std::size_t draw);

// Requires a draw that is ready.
GlossyPart describeGlossy(const World& world, std::size_t draw);

// Names the variant of the surface program that a glossy or layered draw needs.
struct GlossyKind {
  std::uint32_t bands = 0;       // of the table; 0: a draw that reflects diffusely only
  std::uint32_t used_bands = 0;  // how many of these bands count; 0: all
  bundle::BrdfFamily family = bundle::BrdfFamily::Ggx;
  auto operator<=>(const GlossyKind&) const = default;
};
GlossyKind glossyKindOf(const World& world, std::size_t draw, std::uint32_t max_bands);
// Requires a draw whose layer is ready.
GlossyKind layerKindOf(const World& world, std::size_t draw);
// Returns the axes of the factors as an array in GLSL.
std::string axesText(const sh::ZonalFactors& factors);
std::vector<gpu::Define> definesOf(const GlossyKind& kind);

}  // namespace lambent::frame
