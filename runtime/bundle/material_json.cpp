// Materials and their extensions: what they reflect, texture transforms, emission above 1, surfaces that no
// light changes.
#include <algorithm>
#include <array>

#include "runtime/bundle/gltf_parts.hpp"

namespace lambent::bundle {
namespace {

constexpr std::array kAlphaModes = {"OPAQUE", "MASK", "BLEND"};

Json textureJson(const gltf::TextureRef& ref, std::set<std::string>& used) {
  Json json = {{"index", ref.texture}, {"texCoord", ref.texcoord}};
  Json transform = Json::object();
  if (ref.offset != glm::vec2(0.0f)) transform["offset"] = vectorJson(ref.offset);
  if (ref.scale != glm::vec2(1.0f)) transform["scale"] = vectorJson(ref.scale);
  if (ref.rotation_rad != 0.0f) transform["rotation"] = ref.rotation_rad;
  if (transform.empty()) return json;
  json["extensions"][kTextureTransform] = std::move(transform);
  used.insert(kTextureTransform);
  return json;
}

gltf::TextureRef readTexture(const Field& field, std::size_t texture_count) {
  gltf::TextureRef ref;
  ref.texture = static_cast<std::int32_t>(field["index"].index(texture_count));
  ref.texcoord = static_cast<std::uint32_t>(field["texCoord"].count(1));
  if (!field.has("extensions") || !field["extensions"].has(kTextureTransform)) return ref;
  const Field transform = field["extensions"][kTextureTransform];
  if (transform.has("offset")) ref.offset = transform["offset"].vector<glm::vec2>();
  if (transform.has("scale")) ref.scale = transform["scale"].vector<glm::vec2>();
  if (transform.has("rotation")) ref.rotation_rad = transform["rotation"].number();
  return ref;
}

// glTF's factor ends at 1; what shines brighter has a strength besides.
void writeEmission(const gltf::Material& material, Json& json, std::set<std::string>& used) {
  const float strength = std::max({material.emissive.x, material.emissive.y, material.emissive.z});
  if (!(strength > 0.0f)) return;
  json["emissiveFactor"] = vectorJson(strength > 1.0f ? material.emissive / strength : material.emissive);
  if (strength > 1.0f) {
    json["extensions"][kEmissiveStrength] = {{"emissiveStrength", strength}};
    used.insert(kEmissiveStrength);
  }
  if (material.emissive_texture.texture >= 0)
    json["emissiveTexture"] = textureJson(material.emissive_texture, used);
}

void readEmission(const Field& field, std::size_t texture_count, gltf::Material& material) {
  if (field.has("emissiveFactor")) material.emissive = field["emissiveFactor"].vector<glm::vec3>();
  if (field.has("extensions") && field["extensions"].has(kEmissiveStrength))
    material.emissive *= field["extensions"][kEmissiveStrength]["emissiveStrength"].number();
  for (int c = 0; c < 3; ++c)
    if (!(material.emissive[c] >= 0.0f && std::isfinite(material.emissive[c])))
      field.fault("has an emission that is negative or not finite");
  if (field.has("emissiveTexture"))
    material.emissive_texture = readTexture(field["emissiveTexture"], texture_count);
}

// What has its default is left out, and with it extensions that would say nothing.
void writeReflection(const gltf::Material& material, Json& json, std::set<std::string>& used) {
  const gltf::Material defaults;
  const auto extend = [&](const char* extension, const char* key, Json value) {
    json["extensions"][extension][key] = std::move(value);
    used.insert(extension);
  };
  const auto extendTexture = [&](const char* extension, const char* key, const gltf::TextureRef& ref) {
    if (ref.texture >= 0) extend(extension, key, textureJson(ref, used));
  };
  if (material.metallic_roughness_texture.texture >= 0)
    json["pbrMetallicRoughness"]["metallicRoughnessTexture"] =
        textureJson(material.metallic_roughness_texture, used);
  if (material.ior != defaults.ior) extend(kIor, "ior", material.ior);
  if (material.specular != defaults.specular) extend(kSpecular, "specularFactor", material.specular);
  if (material.specular_color != defaults.specular_color)
    extend(kSpecular, "specularColorFactor", vectorJson(material.specular_color));
  extendTexture(kSpecular, "specularTexture", material.specular_texture);
  extendTexture(kSpecular, "specularColorTexture", material.specular_color_texture);
  if (material.anisotropy != defaults.anisotropy)
    extend(kAnisotropy, "anisotropyStrength", material.anisotropy);
  if (material.anisotropy_rotation_rad != defaults.anisotropy_rotation_rad)
    extend(kAnisotropy, "anisotropyRotation", material.anisotropy_rotation_rad);
  extendTexture(kAnisotropy, "anisotropyTexture", material.anisotropy_texture);
  if (material.brdf >= 0) json["extras"]["lambent"]["brdf"] = static_cast<std::uint32_t>(material.brdf);
}

// A factor from 0 to 1.
float share(const Field& field) {
  const float value = field.number();
  if (!(value >= 0.0f && value <= 1.0f)) field.fault("is not from 0 to 1");
  return value;
}

void readSpecular(const Field& field, std::size_t texture_count, gltf::Material& material) {
  if (field.has("specularFactor")) material.specular = share(field["specularFactor"]);
  if (field.has("specularColorFactor")) {
    material.specular_color = field["specularColorFactor"].vector<glm::vec3>();
    for (int c = 0; c < 3; ++c)
      if (material.specular_color[c] < 0.0f) field["specularColorFactor"].fault("is negative");
  }
  if (field.has("specularTexture"))
    material.specular_texture = readTexture(field["specularTexture"], texture_count);
  if (field.has("specularColorTexture"))
    material.specular_color_texture = readTexture(field["specularColorTexture"], texture_count);
}

void readAnisotropy(const Field& field, std::size_t texture_count, gltf::Material& material) {
  if (field.has("anisotropyStrength")) material.anisotropy = share(field["anisotropyStrength"]);
  if (field.has("anisotropyRotation"))
    material.anisotropy_rotation_rad = field["anisotropyRotation"].number();
  if (field.has("anisotropyTexture"))
    material.anisotropy_texture = readTexture(field["anisotropyTexture"], texture_count);
}

void readReflection(const Field& field, std::size_t texture_count, gltf::Material& material) {
  const Field pbr = field["pbrMetallicRoughness"];
  material.metallic = share(pbr["metallicFactor"]);
  material.roughness = share(pbr["roughnessFactor"]);
  if (pbr.has("metallicRoughnessTexture"))
    material.metallic_roughness_texture = readTexture(pbr["metallicRoughnessTexture"], texture_count);
  if (field.has("extensions")) {
    const Field extensions = field["extensions"];
    if (extensions.has(kIor)) {
      material.ior = extensions[kIor]["ior"].number();
      if (material.ior != 0.0f && !(material.ior >= 1.0f))
        extensions[kIor]["ior"].fault("is neither 0 nor 1 and more");
    }
    if (extensions.has(kSpecular)) readSpecular(extensions[kSpecular], texture_count, material);
    if (extensions.has(kAnisotropy)) readAnisotropy(extensions[kAnisotropy], texture_count, material);
  }
  constexpr std::uint64_t kMostBrdfs = 1u << 16;  // whether the table is there, the transfer's reader says
  if (field.has("extras") && field["extras"].has("lambent") && field["extras"]["lambent"].has("brdf"))
    material.brdf = static_cast<std::int32_t>(field["extras"]["lambent"]["brdf"].count(kMostBrdfs));
}

}  // namespace

Json materialJson(const gltf::Material& material, std::set<std::string>& used) {
  Json json = Json::object();
  if (!material.name.empty()) json["name"] = material.name;
  Json& pbr = json["pbrMetallicRoughness"];
  pbr = {{"baseColorFactor", vectorJson(material.base_color)},
         {"metallicFactor", material.metallic},
         {"roughnessFactor", material.roughness}};
  if (material.base_color_texture.texture >= 0)
    pbr["baseColorTexture"] = textureJson(material.base_color_texture, used);
  writeReflection(material, json, used);
  writeEmission(material, json, used);
  if (material.normal_texture.texture >= 0) {
    json["normalTexture"] = textureJson(material.normal_texture, used);
    json["normalTexture"]["scale"] = material.normal_scale;
  }
  if (material.unlit) {
    json["extensions"][kUnlit] = Json::object();
    used.insert(kUnlit);
  }
  if (material.alpha_mode != gltf::AlphaMode::Opaque)
    json["alphaMode"] = kAlphaModes[static_cast<std::size_t>(material.alpha_mode)];
  if (material.alpha_mode == gltf::AlphaMode::Mask) json["alphaCutoff"] = material.alpha_cutoff;
  if (material.double_sided) json["doubleSided"] = true;
  return json;
}

gltf::Material readMaterial(const Field& field, std::size_t texture_count) {
  gltf::Material material;
  if (field.has("name")) material.name = field["name"].text();
  const Field pbr = field["pbrMetallicRoughness"];
  material.base_color = pbr["baseColorFactor"].vector<glm::vec4>();
  if (pbr.has("baseColorTexture"))
    material.base_color_texture = readTexture(pbr["baseColorTexture"], texture_count);
  readReflection(field, texture_count, material);
  readEmission(field, texture_count, material);
  if (field.has("normalTexture")) {
    material.normal_texture = readTexture(field["normalTexture"], texture_count);
    material.normal_scale = field["normalTexture"]["scale"].number();
  }
  material.unlit = field.has("extensions") && field["extensions"].has(kUnlit);
  if (field.has("alphaMode")) {
    const std::string mode = field["alphaMode"].text();
    const auto found = std::find(kAlphaModes.begin(), kAlphaModes.end(), mode);
    if (found == kAlphaModes.end()) field["alphaMode"].fault("is not OPAQUE, MASK or BLEND");
    material.alpha_mode = static_cast<gltf::AlphaMode>(found - kAlphaModes.begin());
  }
  if (field.has("alphaCutoff")) material.alpha_cutoff = field["alphaCutoff"].number();
  if (field.has("doubleSided")) material.double_sided = field["doubleSided"].flag();
  return material;
}

}  // namespace lambent::bundle
