#include "baker/import/reflection.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "baker/import/measured_brdf.hpp"
#include "baker/import/uri.hpp"

namespace lambent::baker {
namespace {

const tinygltf::Value* extensionOf(const tinygltf::Material& source, const char* name) {
  const auto found = source.extensions.find(name);
  return found != source.extensions.end() && found->second.IsObject() ? &found->second : nullptr;
}

// `target` = what `refer` finds, if the texture could change anything.
Result<void> assign(gltf::TextureRef& target, bool wanted, auto refer) {
  if (!wanted) return {};
  Result<gltf::TextureRef> ref = refer();
  if (!ref) return failAgain(std::move(ref.error()));
  target = *ref;
  return {};
}

Result<void> convertSpecular(const tinygltf::Value& extension, std::size_t number, MaterialTextures& textures,
                             gltf::Material& material) {
  material.specular = std::min(numberOr(extension, "specularFactor", 1.0f), 1.0f);
  if (extension.Has("specularColorFactor"))
    for (int c = 0; c < 3; ++c)
      material.specular_color[c] =
          static_cast<float>(extension.Get("specularColorFactor").Get(c).GetNumberAsDouble());
  const bool reflects = material.specular > 0.0f;
  if (auto done =
          assign(material.specular_texture, reflects,
                 [&] { return textures.refer(extension, "specularTexture", number, "specular texture"); });
      !done)
    return done;
  return assign(material.specular_color_texture, reflects && material.specular_color != glm::vec3(0.0f), [&] {
    return textures.refer(extension, "specularColorTexture", number, "specular colour texture");
  });
}

Result<void> convertAnisotropy(const tinygltf::Value& extension, std::size_t number,
                               MaterialTextures& textures, gltf::Material& material) {
  material.anisotropy = std::min(numberOr(extension, "anisotropyStrength", 0.0f), 1.0f);
  material.anisotropy_rotation_rad = numberOr(extension, "anisotropyRotation", 0.0f);
  return assign(material.anisotropy_texture, material.anisotropy > 0.0f,
                [&] { return textures.refer(extension, "anisotropyTexture", number, "anisotropy texture"); });
}

}  // namespace

Result<void> MeasuredBrdfs::bind(const tinygltf::Material& source, std::size_t number,
                                 gltf::Material& material) {
  if (!source.extras.IsObject() || !source.extras.Has("lambent")) return {};
  const tinygltf::Value& lambent = source.extras.Get("lambent");
  if (!lambent.IsObject() || !lambent.Has("brdf") || !lambent.Get("brdf").IsString()) return {};
  const std::string object = fmt::format("the BRDF of material {}", number);
  auto file = resolveUri(document_.path().parent_path(), lambent.Get("brdf").Get<std::string>(),
                         document_.options(), document_.file(), object);
  if (!file) return failAgain(std::move(file.error()));
  const auto [known, added] = number_of_.try_emplace(*file, static_cast<std::int32_t>(scene_.brdfs.size()));
  material.brdf = known->second;
  if (!added) return {};
  auto measured = readMeasuredBrdf(*file);
  if (!measured) {
    measured.error().subject =
        fmt::format("{}: {} ({})", document_.file(), object, file->filename().string());
    return failAgain(std::move(measured.error()));
  }
  scene_.brdfs.push_back(std::move(*measured));
  return {};
}

Result<void> convertReflection(const tinygltf::Material& source, std::size_t number,
                               MaterialTextures& textures, gltf::Material& material) {
  const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
  material.metallic = std::clamp(static_cast<float>(pbr.metallicFactor), 0.0f, 1.0f);
  material.roughness = std::clamp(static_cast<float>(pbr.roughnessFactor), 0.0f, 1.0f);
  if (const auto* ior = extensionOf(source, "KHR_materials_ior")) material.ior = numberOr(*ior, "ior", 1.5f);
  if (material.unlit || material.brdf >= 0) return {};
  if (const auto* specular = extensionOf(source, "KHR_materials_specular"))
    if (auto done = convertSpecular(*specular, number, textures, material); !done) return done;
  if (const auto* anisotropy = extensionOf(source, "KHR_materials_anisotropy"))
    if (auto done = convertAnisotropy(*anisotropy, number, textures, material); !done) return done;
  const auto& texture = pbr.metallicRoughnessTexture;
  const bool reflects = material.metallic > 0.0f || (material.specular > 0.0f && material.roughness > 0.0f);
  return assign(material.metallic_roughness_texture, reflects, [&] {
    return textures.refer(texture.index, texture.extensions, texture.texCoord, number,
                          "metallic-roughness texture");
  });
}

}  // namespace lambent::baker
