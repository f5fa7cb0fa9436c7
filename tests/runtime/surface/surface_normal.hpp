// Normal maps and the light at their normals, by the shaders' own text as C++, and a record of a surface.
#pragma once

#include "runtime/draws/surface_shared.h"
#include "tests/support/glsl/glsl.hpp"

namespace lambent::frame::glsl {

using namespace lambent::glsl;

struct SurfaceNormal {
#include "as_cpp/diffuse_light.glsl"
#include "as_cpp/surface_normal.glsl"
};

}  // namespace lambent::frame::glsl

namespace lambent::frame {

// Returns the record of a white surface without textures. Its words follow positions, normals, tangents and
// both sets of texture coordinates of four vertices.
inline SurfaceDraw plainRecord() {
  const TextureSlot none{.texture_from_coordinates = glm::mat3x2(1.0f), .set = kAbsent, .pad = 0};
  return {.world_from_mesh = glm::mat4(1.0f),
          .group_from_mesh = glm::mat3x4(1.0f),
          .group_from_mesh_normal = glm::mat3x4(1.0f),
          .world_from_group = glm::vec4(0, 0, 0, 1),
          .base_color = glm::vec4(1.0f),
          .emission = glm::vec4(0.0f),
          .base_color_texture = none,
          .emissive_texture = none,
          .normal_texture = none,
          .normal_scale = 1.0f,
          .facing = 1.0f,
          .positions_word = 0,
          .normals_word = 12,
          .tangents_word = 24,
          .texcoords0_word = 40,
          .texcoords1_word = 48,
          .colors_word = kAbsent,
          .radiance_word = 0,
          .alpha_mode = kAlphaOpaque,
          .alpha_cutoff = 0.5f,
          .unlit = 0,
          .bounced_word = kAbsent,
          .irradiance_set = kAbsent,
          .transmission = 0.0f,
          .pane_reflectance = 0.0f};
}

}  // namespace lambent::frame
