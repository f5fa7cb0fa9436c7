#include "runtime/draws/texture_units.hpp"

namespace lambent::frame {

namespace {

gpu::Texture oneTexel(const char* label, const glm::vec4& value) {
  // Eight bits cannot represent 0.5, so a flat normal needs more.
  gpu::Texture texture(label, {.format = GL_RGBA16F});
  glTextureSubImage2D(texture.id(), 0, 0, 0, 1, 1, GL_RGBA, GL_FLOAT, &value.x);
  return texture;
}

}  // namespace

TextureUnits::TextureUnits()
    : white_(oneTexel("white", glm::vec4(1.0f))),
      flat_(oneTexel("flat normal", glm::vec4(0.5f, 0.5f, 1.0f, 1.0f))),
      along_tangent_(oneTexel("along the tangent", glm::vec4(1.0f, 0.5f, 1.0f, 1.0f))) {}

void TextureUnits::bindOne(GLuint unit, const streaming::ResidentBundle* bundle, std::int32_t texture) {
  const bool numbers = unit != kUnitBaseColor && unit != kUnitEmissive && unit != kUnitSpecularColor;
  const gpu::Texture* image = unit == kUnitNormal       ? &flat_
                              : unit == kUnitAnisotropy ? &along_tangent_
                                                        : &white_;
  gltf::Sampler wanted;
  if (bundle != nullptr && texture >= 0) {
    const gltf::Texture& described = bundle->textures[static_cast<std::size_t>(texture)];
    wanted = described.sampler;
    if (described.image >= 0) {
      const auto& images = numbers ? bundle->linear_images : bundle->images;
      const gpu::Texture& arrived = images[static_cast<std::size_t>(described.image)];
      if (arrived) image = &arrived;
    }
  }
  auto& sampler = samplers_[{wanted.wrap_s, wanted.wrap_t, wanted.mag_filter, wanted.min_filter}];
  if (!sampler) sampler = gpu::Sampler(wanted.wrap_s, wanted.wrap_t, wanted.mag_filter, wanted.min_filter);
  image->bind(unit);
  glBindSampler(unit, sampler.id());
}

void TextureUnits::bind(const World& world, const SurfaceTextures& textures) {
  const streaming::ResidentBundle* bundle =
      textures.bundle >= 0 ? &world.residency().bundles()[static_cast<std::size_t>(textures.bundle)]
                           : nullptr;
  bindOne(kUnitBaseColor, bundle, textures.base_color);
  bindOne(kUnitEmissive, bundle, textures.emissive);
  bindOne(kUnitNormal, bundle, textures.normal);
}

void TextureUnits::bindGlossy(const World& world, const SurfaceTextures& textures, std::uint32_t bundle,
                              std::int32_t table) {
  const streaming::ResidentBundle* owner = &world.residency().bundles()[bundle];
  bindOne(kUnitMetallicRoughness, owner, textures.metallic_roughness);
  bindOne(kUnitSpecular, owner, textures.specular);
  bindOne(kUnitSpecularColor, owner, textures.specular_color);
  bindOne(kUnitAnisotropy, owner, textures.anisotropy);
  owner->brdf_tables[static_cast<std::size_t>(table)].texture.bind(kUnitBrdf);
  glBindSampler(kUnitBrdf, 0);  // the texture's own sampling is used
}

void TextureUnits::unbindSamplers() const {
  for (GLuint unit = kUnitBaseColor; unit <= kUnitAnisotropy; ++unit) glBindSampler(unit, 0);
}

}  // namespace lambent::frame
