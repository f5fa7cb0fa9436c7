// Packs a table of b(v) into a texture for shaders. The texture array holds the zonal weights of every node
// (runtime/sh/zonal.hpp) as floats, four per texel. The hardware interpolates between texels of a
// layer; glossy_kernel.glsl reads them. The axes of the texture are:
//   x:     u of the view's angle (bundle::angleAxis)
//   y:     roughness if isotropic, else azimuth
//   layer: texel t of a node if isotropic, else (strength * roughnesses + roughness) * texels + t, where the
//          shader interpolates between strengths and between roughnesses
// Weight p of lobe a is component 2p + a of the node if there are two lobes, and 4p + a if there are three.
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
  std::uint32_t per_node = 0;     // texels per node
  std::vector<glm::vec4> values;  // [layer][y][x]

  std::uint64_t bytes() const { return sizeof(glm::vec4) * values.size(); }
};
BrdfTexels packBrdf(const bundle::BrdfTable& table);

// Holds a table on the GPU.
struct BrdfTexture {
  gpu::Texture texture;  // empty until it is loaded
  std::uint32_t order = 0, lobes = 2;
  bool isotropic = true;
  std::uint32_t angles = 2, azimuths = 1, roughnesses = 1, strengths = 1;
};
// Fails, naming `subject`, if the texture needs more layers than the device supports.
Result<BrdfTexture> makeBrdfTexture(const bundle::BrdfTable& table, const BrdfTexels& texels,
                                    const std::string& subject);

}  // namespace lambent::streaming
