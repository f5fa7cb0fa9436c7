#include "tests/support/glsl/glossy_kernels.hpp"

namespace lambent::glossy::glsl {
namespace {

template <typename Kernel>
Reflection reflectBy(Kernel kernel, uvec2 nodes, const View& view, std::span<const vec4> from) {
  const auto local = kernel.localView(view.normal, view.tangent, view.to_eye);
  vec4 weights[Kernel::kTexels], light[Kernel::kCoefficients];
  std::copy_n(from.begin(), std::size(light), light);
  kernel.lookUpWeights(local, view.roughness, view.strength, nodes, weights);
  const auto sum = kernel.reflectLight(local, weights, light);
  Reflection result{.tangent = local.tangent,
                    .bitangent = local.bitangent,
                    .normal = local.normal,
                    .cos_theta = local.cos_theta,
                    .azimuth = local.azimuth,
                    .diffuse = sum.diffuse};
  if constexpr (requires { sum.light; }) {
    result.light = sum.light;
    result.albedo = sum.albedo;
  } else {
    result.f0_light = sum.f0_light;
    result.f90_light = sum.f90_light;
    result.albedo = vec3(sum.albedo, 0.0f);
  }
  return result;
}

}  // namespace

Table::Table(const bundle::BrdfTable& table) {
  const auto take = [&]<int Bands, Lobes Kind>() {
    reflect_ = [kernel = Kernel<Bands, Kind>{{streaming::packBrdf(table)}},
                nodes = uvec2(table.roughnesses, table.strengths)](const View& view,
                                                                   std::span<const vec4> light) {
      return reflectBy(kernel, nodes, view, light);
    };
  };
  const auto takeBands = [&]<int Bands>() {
    if (!table.isotropic())
      take.template operator()<Bands, Lobes::Anisotropic>();
    else if (table.lobes == 3)
      take.template operator()<Bands, Lobes::Measured>();
    else
      take.template operator()<Bands, Lobes::Two>();
  };
  if (table.order == 4) takeBands.template operator()<4>();
  if (table.order == 5) takeBands.template operator()<5>();
  if (table.order == 6) takeBands.template operator()<6>();
}

}  // namespace lambent::glossy::glsl
