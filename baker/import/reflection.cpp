#include "baker/import/reflection.hpp"

#include <algorithm>
#include <type_traits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/import/measured_brdf.hpp"
#include "baker/import/uri.hpp"
#include "runtime/bundle/material_fields.hpp"

namespace lambent::baker {
namespace {

const tinygltf::Value* extensionOf(const tinygltf::Material& source, const char* name) {
  const auto found = source.extensions.find(name);
  return found != source.extensions.end() && found->second.IsObject() ? &found->second : nullptr;
}

// Sets `target` to what `refer` returns, if `wanted` says that the texture could change anything.
Result<void> assignTexture(gltf::TextureRef& target, bool wanted, auto refer) {
  if (!wanted) return {};
  Result<gltf::TextureRef> ref = refer();
  if (!ref) return failAgain(std::move(ref.error()));
  target = *ref;
  return {};
}

// Numbers may exceed 1 by rounding.
void readField(const nlohmann::json& value, const gltf::MaterialJson& range, float& factor) {
  factor = value.get<float>();
  if (range.allowed == gltf::MaterialJson::Allowed::ZeroToOne) factor = std::min(factor, 1.0f);
}
void readField(const nlohmann::json& value, const gltf::MaterialJson&, glm::vec3& color) {
  for (int c = 0; c < 3; ++c) color[c] = value[static_cast<std::size_t>(c)].get<float>();
}

// Reads the numbers and colours of reflection, by the table of a material's fields. Of those in extensions,
// unlit and measured materials keep only the index of refraction.
void readFactors(const nlohmann::json& source, gltf::Material& material) {
  const bool has_lobes = !material.unlit && material.brdf < 0;
  gltf::forEachMaterialField([&]<class Row>(const Row& row) {
    using Value = typename Row::Value;
    if constexpr (std::is_same_v<Value, float> || std::is_same_v<Value, glm::vec3>) {
      const auto& objects = row.json.objects;
      const bool wanted = has_lobes || objects[1] == nullptr || objects == gltf::material_rows::kIor;
      if (row.part != gltf::MaterialPart::Reflection || !wanted) return;
      const nlohmann::json* place = &source;
      for (const char* object : objects) {
        if (!object) continue;
        const auto found = place->find(object);
        if (found == place->end()) return;
        place = &*found;
      }
      if (const auto value = place->find(row.json.key); value != place->end())
        readField(*value, row.json, material.*row.member);
    }
  });
}

// Adds the textures of KHR_materials_specular.
Result<void> referSpecular(const tinygltf::Value& extension, std::size_t number, MaterialTextures& textures,
                           gltf::Material& material) {
  const bool reflects = material.specular > 0.0f;
  if (auto done = assignTexture(
          material.specular_texture, reflects,
          [&] { return textures.refer(extension, "specularTexture", number, "specular texture"); });
      !done)
    return done;
  return assignTexture(
      material.specular_color_texture, reflects && material.specular_color != glm::vec3(0.0f),
      [&] { return textures.refer(extension, "specularColorTexture", number, "specular color texture"); });
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

Result<void> convertReflection(const Document& document, std::size_t number, MaterialTextures& textures,
                               gltf::Material& material) {
  readFactors(document.json()["materials"][number], material);
  if (material.unlit || material.brdf >= 0) return {};
  const tinygltf::Material& source = document.model().materials[number];
  if (const auto* specular = extensionOf(source, "KHR_materials_specular"))
    if (auto done = referSpecular(*specular, number, textures, material); !done) return done;
  if (const auto* anisotropy = extensionOf(source, "KHR_materials_anisotropy")) {
    auto done = assignTexture(material.anisotropy_texture, material.anisotropy > 0.0f, [&] {
      return textures.refer(*anisotropy, "anisotropyTexture", number, "anisotropy texture");
    });
    if (!done) return done;
  }
  const auto& texture = source.pbrMetallicRoughness.metallicRoughnessTexture;
  const bool reflects = material.metallic > 0.0f || (material.specular > 0.0f && material.roughness > 0.0f);
  return assignTexture(material.metallic_roughness_texture, reflects, [&] {
    return textures.refer(texture.index, texture.extensions, texture.texCoord, number,
                          "metallic-roughness texture");
  });
}

}  // namespace lambent::baker
