// This file is shared by C++ and GLSL. It holds the bindings and records of the raster pass. Words are 32
// bits, counted from the start of an arena page.
#ifdef __cplusplus
#pragma once

#include <cstddef>
#include <cstdint>

#include <glm/mat3x2.hpp>
#include <glm/mat3x4.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

namespace lambent::frame {
using uint = std::uint32_t;
using glm::mat3x2;
using glm::mat3x4;
using glm::mat4;
using glm::vec4;
#define LAMBENT_CONSTANT inline constexpr uint
#else
#define LAMBENT_CONSTANT const uint
#endif

LAMBENT_CONSTANT kBindView = 0u;            // uniform block ViewBlock
LAMBENT_CONSTANT kBindDraws = 0u;           // array of SurfaceDraw
LAMBENT_CONSTANT kBindGeometry = 1u;        // arena page
LAMBENT_CONSTANT kBindRadiance = 2u;        // arena page
LAMBENT_CONSTANT kBindRows = 3u;            // arena page: rows of the vertices of glossy draws
LAMBENT_CONSTANT kBindSamples = 4u;         // arena page: samples of glossy draws
LAMBENT_CONSTANT kBindRadianceChange = 3u;  // diffuse draws: the change by bodies nearby, 3 floats per vertex
// These hold light of patches (patch_bounces.hpp): 3 floats per vertex, or 27 for draws with normal maps and
// glossy draws.
LAMBENT_CONSTANT kBindBounced = 4u;        // in diffuse draws
LAMBENT_CONSTANT kBindGlossyBounced = 2u;  // in glossy draws, which use binding 4 for samples
LAMBENT_CONSTANT kAbsent = 0xffffffffu;

LAMBENT_CONSTANT kUnitBaseColor = 0u;  // texture units
LAMBENT_CONSTANT kUnitEmissive = 1u;
LAMBENT_CONSTANT kUnitNormal = 2u;
LAMBENT_CONSTANT kUnitIrradiance = 2u;         // in draws with texels, which have no normal map
LAMBENT_CONSTANT kUnitMetallicRoughness = 3u;  // from here on only in glossy and layered draws
LAMBENT_CONSTANT kUnitSpecular = 4u;
LAMBENT_CONSTANT kUnitSpecularColor = 5u;
LAMBENT_CONSTANT kUnitAnisotropy = 6u;
LAMBENT_CONSTANT kUnitSeenKernel = 6u;  // in layered draws, which have no direction
LAMBENT_CONSTANT kUnitBrdf = 7u;        // table of b(v)

LAMBENT_CONSTANT kAlphaOpaque = 0u;  // alpha is 1
LAMBENT_CONSTANT kAlphaMask = 1u;    // below the cutoff the surface is absent
LAMBENT_CONSTANT kAlphaBlend = 2u;

// Draws with a normal map have light in bands 0..2 at each vertex instead of radiance: 9 colours.
LAMBENT_CONSTANT kLightCoefficients = 9u;

// Describes how a surface looks up one of its textures.
struct TextureSlot {
  mat3x2 texture_from_coordinates;  // KHR_texture_transform, applied to (u, v, 1)
  uint set;                         // 0: TEXCOORD_0, 1: TEXCOORD_1; kAbsent: no texture
  uint pad;
};

// Holds the additional fields of draws that reflect: glossy ones and layered ones, which
// have no samples.
struct GlossyPart {
  mat3x4 group_from_world;  // rotation
  vec4 dielectric;          // ((ior - 1) / (ior + 1))² times the specular colour; w: specular
  TextureSlot metallic_roughness_texture;
  TextureSlot specular_texture;
  TextureSlot specular_color_texture;
  TextureSlot anisotropy_texture;
  float metallic;
  float roughness;
  float anisotropy;
  float direction_cos, direction_sin;  // direction of the longer lobe relative to the tangent
  uint roughnesses, strengths;         // numbers of nodes in the table
  uint indices_word;
  uint rows_word;  // vertex_count + 1 offsets, then samples, then weights, two per word
  uint row_entries;
  uint vertex_count;
  uint first_sample;  // of the draw; output o of sample s is vec4 first_output + outputs (s - first_sample) +
                      // o
  uint draw;          // index in the residency
  uint first_output;
  uint seen_word;  // layered draws: first word of what the vertices see of the sky, in the page of radiance
  uint glossy_pad;
};

struct SurfaceDraw {
  mat4 world_from_mesh;
  mat3x4 group_from_mesh;         // maps tangents; columns padded as in std430
  mat3x4 group_from_mesh_normal;  // maps the front's normal, also in draws of the back
  vec4 world_from_group;          // quaternion, xyz then w
  vec4 base_color;
  vec4 emission;  // radiance; w unused
  TextureSlot base_color_texture;
  TextureSlot emissive_texture;
  TextureSlot normal_texture;
  float normal_scale;
  float facing;  // -1: draws the back of a double-sided surface
  uint positions_word;
  uint normals_word;
  uint tangents_word;
  uint texcoords0_word;
  uint texcoords1_word;
  uint colors_word;
  uint radiance_word;
  uint alpha_mode;
  float alpha_cutoff;
  uint unlit;
  uint bounced_word;    // first word of its light of patches; kAbsent: none
  uint irradiance_set;  // texture coordinates that look up its texels; kAbsent: has none
  // Panes: the share of the light under the layer that passes through, and F0 of the layer; else 0.
  float transmission, pane_reflectance;
#ifdef LAMBENT_GLOSSY
  GlossyPart glossy;
#endif
};

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
struct GlossyDraw {
  SurfaceDraw surface;
  GlossyPart glossy;
};
static_assert(sizeof(GlossyPart) == 256 && offsetof(GlossyPart, metallic) == 192 &&
              sizeof(GlossyDraw) == 624 && offsetof(GlossyDraw, glossy) == 368);
static_assert(sizeof(TextureSlot) == 32 && offsetof(TextureSlot, set) == 24);
static_assert(sizeof(SurfaceDraw) == 368 && offsetof(SurfaceDraw, base_color) == 176 &&
              offsetof(SurfaceDraw, base_color_texture) == 208 && offsetof(SurfaceDraw, normal_scale) == 304);
}  // namespace lambent::frame
#endif
