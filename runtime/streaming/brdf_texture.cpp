#include "runtime/streaming/brdf_texture.hpp"

#include <fmt/format.h>

#include "runtime/sh/zonal.hpp"

namespace lambent::streaming {

BrdfTexels packBrdf(const bundle::BrdfTable& table) {
  const sh::ZonalFactors factors(static_cast<int>(table.order), table.isotropic());
  const auto count = static_cast<std::uint32_t>(factors.weightCount());
  const std::uint32_t stride = table.lobes == 2 ? 2 : 4;
  BrdfTexels texels;
  texels.per_node = (stride * count + 3) / 4;
  texels.width = table.angles;
  texels.height = table.isotropic() ? table.roughnesses : table.azimuths;
  texels.layers = texels.per_node * (table.isotropic() ? 1 : table.strengths * table.roughnesses);
  texels.values.assign(std::size_t{texels.width} * texels.height * texels.layers, glm::vec4(0.0f));
  std::vector<float> weights(count);
  const float* node = table.values.data();
  for (std::uint32_t strength = 0; strength < table.strengths; ++strength)
    for (std::uint32_t roughness = 0; roughness < table.roughnesses; ++roughness)
      for (std::uint32_t azimuth = 0; azimuth < table.azimuths; ++azimuth)
        for (std::uint32_t angle = 0; angle < table.angles; ++angle, node += table.nodeValues()) {
          const std::uint32_t down = table.isotropic() ? roughness : azimuth;
          const std::uint32_t layer =
              table.isotropic() ? 0 : (strength * table.roughnesses + roughness) * texels.per_node;
          for (std::uint32_t lobe = 0; lobe < table.lobes; ++lobe) {
            factors.factor({node + lobe * table.coefficients(), table.coefficients()}, weights);
            for (std::uint32_t p = 0; p < count; ++p) {
              const std::uint32_t component = stride * p + lobe;
              const std::size_t texel =
                  (std::size_t{layer + component / 4} * texels.height + down) * texels.width + angle;
              texels.values[texel][static_cast<int>(component % 4)] = weights[p];
            }
          }
        }
  return texels;
}

Result<BrdfTexture> makeBrdfTexture(const bundle::BrdfTable& table, const BrdfTexels& texels,
                                    const std::string& subject) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &most);
  if (texels.layers > static_cast<std::uint32_t>(most))
    return fail(subject, fmt::format("takes {} layers of a texture; this device has {}", texels.layers, most),
                "bake with fewer nodes of roughness or anisotropy");
  BrdfTexture made{
      .texture = gpu::Texture(
          "brdf",
          {.format = GL_RGBA32F, .width = texels.width, .height = texels.height, .layers = texels.layers}),
      .order = table.order,
      .lobes = table.lobes,
      .isotropic = table.isotropic(),
      .angles = table.angles,
      .azimuths = table.azimuths,
      .roughnesses = table.roughnesses,
      .strengths = table.strengths};
  glTextureSubImage3D(made.texture.id(), 0, 0, 0, 0, static_cast<GLsizei>(texels.width),
                      static_cast<GLsizei>(texels.height), static_cast<GLsizei>(texels.layers), GL_RGBA,
                      GL_FLOAT, texels.values.data());
  made.texture.interpolate();
  return made;
}

}  // namespace lambent::streaming
