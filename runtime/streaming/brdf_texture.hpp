// A table of b(v) as shaders look it up: the zonal weights of every node (runtime/sh/zonal_factors.hpp),
// packed four to a texel, in a texture array of floats that the hardware interpolates. glossy_kernel.glsl
// reads it.
//   across: u of the view's angle (bundle::angleAxis), node to node
//   down:   roughness (isotropic), else azimuth
//   layers: texel t of a node, isotropic; else (strength * roughnesses + roughness) * texels + t: between
//   those two axes
//           the shader interpolates by itself
// Two lobes: weight p of lobe a is component (2p + a) of the node, three: component 4p + a.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <glm/vec4.hpp>

#include "runtime/base/result.hpp"
#include "runtime/bundle/brdf_table.hpp"
#include "runtime/gpu/objects.hpp"

namespace lambent::streaming {

struct BrdfTexels {
  std::uint32_t width = 0, height = 0, layers = 0;
  std::uint32_t per_node = 0;     // texels
  std::vector<glm::vec4> values;  // [layer][down][across]

  std::uint64_t bytes() const { return sizeof(glm::vec4) * values.size(); }
};
BrdfTexels packBrdf(const bundle::BrdfTable& table);

// On the GPU.
struct BrdfTexture {
  gpu::Texture texture;  // empty: not here yet
  std::uint32_t order = 0, lobes = 2;
  bool isotropic = true;
  std::uint32_t angles = 2, azimuths = 1, roughnesses = 1, strengths = 1;
};
// Errors name `subject`: more layers than the device has.
Result<BrdfTexture> makeBrdfTexture(const bundle::BrdfTable& table, const BrdfTexels& texels,
                                    const std::string& subject);

}  // namespace lambent::streaming
