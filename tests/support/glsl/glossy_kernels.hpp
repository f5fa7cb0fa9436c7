// The kernel of b(v) as C++: glossy_kernel.glsl for each count of bands and each kind of table,
// and what a view sees by that of any table.
#pragma once

#include <algorithm>
#include <functional>

#include "runtime/sh/zonal.hpp"
#include "runtime/streaming/textures.hpp"
#include "tests/support/glsl/transfer.hpp"

namespace lambent::glossy::glsl {

using namespace lambent::glsl;

enum class Lobes { Two, Anisotropic, Measured };

// Interpolates between the four texels around a place, as the GPU's sampler does.
struct Sampled {
  streaming::BrdfTexels table;
  uvec2 brdfNodes() const { return {table.width, table.height}; }
  vec4 brdfTexel(vec2 place, uint layer) const {
    const auto texel = [&](uint x, uint y) {
      return table.values[(std::size_t{layer} * table.height + std::min(y, table.height - 1)) * table.width +
                          std::min(x, table.width - 1)];
    };
    const uvec2 low(place);
    const vec2 part = place - vec2(low);
    return mix(mix(texel(low.x, low.y), texel(low.x + 1, low.y), part.x),
               mix(texel(low.x, low.y + 1), texel(low.x + 1, low.y + 1), part.x), part.y);
  }
};

inline vec3 zonalAxis(int bands, Lobes lobes, std::size_t i) {
  const sh::ZonalFactors factors(bands, lobes != Lobes::Anisotropic);
  return factors.axes()[std::min(i, factors.axes().size() - 1)];
}
// There are 11 axes at most; kernels read as many as they have.
#define LAMBENT_TEST_AXES(l)                                                                                \
  {                                                                                                         \
    zonalAxis(kBands, l, 0), zonalAxis(kBands, l, 1), zonalAxis(kBands, l, 2), zonalAxis(kBands, l, 3),     \
        zonalAxis(kBands, l, 4), zonalAxis(kBands, l, 5), zonalAxis(kBands, l, 6), zonalAxis(kBands, l, 7), \
        zonalAxis(kBands, l, 8), zonalAxis(kBands, l, 9), zonalAxis(kBands, l, 10)                          \
  }

template <int Bands, Lobes Kind>
struct Kernel;

#define LAMBENT_BANDS 4
#include "tests/support/glsl/glossy_kernels_of_bands.inc"
#undef LAMBENT_BANDS
#define LAMBENT_BANDS 5
#include "tests/support/glsl/glossy_kernels_of_bands.inc"
#undef LAMBENT_BANDS
#define LAMBENT_BANDS 6
#include "tests/support/glsl/glossy_kernels_of_bands.inc"
#undef LAMBENT_BANDS
#undef LAMBENT_TEST_AXES

using Isotropic = Kernel<5, Lobes::Two>;  // for functions that do not depend on the table

struct View {
  vec3 normal, tangent, to_eye;  // the tangent counts only for anisotropic tables
  float roughness = 0.0f, strength = 0.0f;
};

// The kernel's LocalView and Reflected. Tables of two lobes leave `light` 0, and measured ones f0_light and
// f90_light.
struct Reflection {
  vec3 tangent, bitangent, normal;
  float cos_theta;
  vec2 azimuth;
  vec4 light{0.0f}, f0_light{0.0f}, f90_light{0.0f}, diffuse;
  vec3 albedo{0.0f};  // of each lobe
};

class Table {
 public:
  explicit Table(const bundle::BrdfTable& table);
  Reflection reflect(const View& view, std::span<const vec4> light) const { return reflect_(view, light); }

 private:
  std::function<Reflection(const View&, std::span<const vec4>)> reflect_;
};

}  // namespace lambent::glossy::glsl
