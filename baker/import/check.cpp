#include "baker/import/check.hpp"

#include <algorithm>
#include <array>

#include "baker/import/error_text.hpp"
#include "baker/import/mend.hpp"
#include "baker/import/texture_transfer.hpp"
#include "runtime/bundle/material_fields.hpp"

namespace lambent::baker {

namespace {

std::optional<Object> extension(const Object& object, const char* name) {
  const auto extensions = object.object("extensions");
  return extensions ? extensions->object(name) : std::nullopt;
}

// Returns the object that contains a field of a material, if there is one.
std::optional<Object> placeOf(const Object& material, const gltf::MaterialJson& field) {
  const auto [outer, inner] = field.objects;
  if (!outer) return material;
  const auto place = material.object(outer);
  return place && inner ? place->object(inner) : place;
}

void checkTexture(const Object& owner, const char* key, const Root& root) {
  if (const auto info = owner.object(key)) info->index("index", root.size("textures"), "textures");
}

}  // namespace

bool readsExtension(std::string_view name) {
  // Textures of the last four are read if their image can be decoded, and have warnings of their own.
  constexpr std::array<std::string_view, 12> kBesideMaterials{"KHR_draco_mesh_compression",
                                                              "KHR_mesh_quantization",
                                                              "KHR_texture_transform",
                                                              "EXT_meshopt_compression",
                                                              "EXT_mesh_gpu_instancing",
                                                              "KHR_lights_punctual",
                                                              "KHR_materials_emissive_strength",
                                                              "KHR_materials_pbrSpecularGlossiness",
                                                              "EXT_texture_webp",
                                                              "EXT_texture_avif",
                                                              "MSFT_texture_dds",
                                                              "KHR_texture_basisu"};
  bool found = std::ranges::find(kBesideMaterials, name) != kBesideMaterials.end();
  gltf::forEachMaterialField([&](const auto& row) {
    const auto [outer, inner] = row.json.objects;
    found |= inner != nullptr && outer == std::string_view("extensions") && inner == name;
  });
  return found;
}

void checkMaterial(const Object& material, const Root& root) {
  gltf::forEachMaterialTexture([&](const auto& row) {
    if (const auto place = placeOf(material, row.json)) checkTexture(*place, row.json.key, root);
  });
  if (const auto glossiness = extension(material, "KHR_materials_pbrSpecularGlossiness"))
    for (const char* key : {"diffuseTexture", "specularGlossinessTexture"})
      checkTexture(*glossiness, key, root);
  // `extras` may be anything; only what stands under our own name is ours.
  const nlohmann::json* extras = material.find("extras");
  if (extras == nullptr || !extras->is_object() || !extras->contains("lambent")) return;
  if (const nlohmann::json& ours = (*extras)["lambent"]; ours.is_object())
    Object{ours, material.name + ": extras: lambent"}.text("brdf");
}

void checkNodeExtensions(const Object& node, const Root& root) {
  if (const auto light = extension(node, "KHR_lights_punctual")) {
    const auto lights = extension(root.object, "KHR_lights_punctual");
    if (!light->index("light", lights ? lights->list("lights").size() : 0, "lights"))
      throw BrokenField{fmt::format("{} names no light", light->name)};
  }
  if (const auto instances = extension(node, "EXT_mesh_gpu_instancing")) {
    const auto attributes = instances->object("attributes");
    if (!attributes) throw BrokenField{fmt::format("{} has no attributes", instances->name)};
    for (const auto& item : attributes->json.items())
      attributes->index(item.key().c_str(), root.size("accessors"), "accessors");
  }
}

namespace {

void checkAsset(const Root& root) {
  const auto asset = root.object.object("asset");
  const std::string version = asset ? asset->text("version") : std::string();
  if (version.empty()) throw BrokenField{"is not glTF: no asset.version"};
  const std::string minimum = asset->text("minVersion");
  if (!version.starts_with("2.") || !(minimum.empty() || minimum == "2.0"))
    throw BrokenField{
        fmt::format("needs glTF {}, this program reads 2.0", minimum.empty() ? version : minimum),
        "export the scene as glTF 2.0"};
}

// Returns whether an object has an extension.
bool has(const nlohmann::json& object, const std::string& name) {
  return object.is_object() && object.contains("extensions") && object["extensions"].contains(name);
}

// Returns whether bytes of vertices or indices lie where only the extension finds or decodes them: it is used
// by a buffer, view or accessor, or by a primitive that has no such bytes.
bool holdsGeometry(const std::string& name, const Root& root) {
  const auto uses = [&](const nlohmann::json& object) { return has(object, name); };
  for (const char* key : {"buffers", "bufferViews", "accessors"})
    if (std::ranges::any_of(root.object.list(key), uses)) return true;
  const nlohmann::json& accessors = root.object.list("accessors");
  const auto lacksBytes = [&](const nlohmann::json& owner, const char* key) {
    if (!owner.is_object() || !owner.contains(key)) return false;
    const std::size_t i = owner[key].is_number_unsigned() ? owner[key].get<std::size_t>() : accessors.size();
    return i < accessors.size() && !accessors[i].contains("bufferView") && !accessors[i].contains("sparse");
  };
  bool found = false;
  root.forEach("meshes", "mesh", [&](const Object& mesh) {
    for (const nlohmann::json& primitive : mesh.list("primitives"))
      if (uses(primitive)) {
        const nlohmann::json attributes = primitive.value("attributes", nlohmann::json::object());
        found |= !attributes.contains("POSITION") || lacksBytes(attributes, "POSITION") ||
                 lacksBytes(primitive, "indices");
      }
  });
  return found;
}

void checkExtensions(const Root& root) {
  for (const nlohmann::json& entry : root.object.list("extensionsRequired")) {
    const std::string name = entry.is_string() ? entry.get<std::string>() : entry.dump();
    if (!readsExtension(name) && holdsGeometry(name, root))
      throw BrokenField{fmt::format("has geometry that only the extension {} can decode", name),
                        "export the scene without it"};
  }
}

void checkDraco(const Object& draco, const Root& root) {
  if (!draco.index("bufferView", root.size("bufferViews"), "bufferViews"))
    throw BrokenField{fmt::format("{} has no bufferView", draco.name)};
  const auto attributes = draco.object("attributes");
  if (!attributes) throw BrokenField{fmt::format("{} has no attributes", draco.name)};
  for (const auto& [key, value] : attributes->json.items())
    if (attributes->toNumber(value, key) > 0xffff)
      throw BrokenField{fmt::format("{}: {} has a wild attribute id", draco.name, key)};
}

void checkPrimitive(const Object& primitive, const Root& root) {
  const std::size_t accessors = root.size("accessors");
  const auto attributes = primitive.object("attributes");
  if (!attributes) throw BrokenField{fmt::format("{} has no attributes", primitive.name)};
  for (const auto& item : attributes->json.items())
    attributes->index(item.key().c_str(), accessors, "accessors");
  const auto indices = primitive.index("indices", accessors, "accessors");
  primitive.index("material", root.size("materials"), "materials");
  checkTextureTransfer(primitive);
  if (primitive.number("mode").value_or(4) > 6)
    throw BrokenField{fmt::format("{} has an unknown mode", primitive.name)};
  const auto extensions = primitive.object("extensions");
  const auto draco = extensions ? extensions->object("KHR_draco_mesh_compression") : std::nullopt;
  if (draco) checkDraco(*draco, root);
  // Indices that are all zero would be triangles without area.
  if (indices && !draco && !root.object.list("accessors")[*indices].contains("bufferView") &&
      !root.object.list("accessors")[*indices].contains("sparse"))
    throw BrokenField{fmt::format("accessor {} holds indices but has no bufferView", *indices)};
  std::size_t t = 0;
  for (const nlohmann::json& entry : primitive.list("targets")) {
    const Object target{entry, fmt::format("{}, morph target {}", primitive.name, t++)};
    if (!entry.is_object()) throw BrokenField{fmt::format("{} is not an object", target.name)};
    for (const auto& item : entry.items()) target.index(item.key().c_str(), accessors, "accessors");
  }
}

void checkMaterials(const Root& root) {
  root.forEach("images", "image", [&](const Object& image) {
    image.index("bufferView", root.size("bufferViews"), "bufferViews");
  });
  root.forEach("textures", "texture", [&](const Object& texture) {
    texture.index("source", root.size("images"), "images");
    texture.index("sampler", root.size("samplers"), "samplers");
  });
  root.forEach("materials", "material", [&](const Object& material) { checkMaterial(material, root); });
}

void checkMeshes(const Root& root) {
  root.forEach("meshes", "mesh", [&](const Object& mesh) {
    std::size_t i = 0;
    checkNumbers(mesh, "weights");
    checkTextureTransfer(mesh);
    for (const nlohmann::json& primitive : mesh.list("primitives"))
      checkPrimitive({primitive, fmt::format("{}, primitive {}", mesh.name, i++)}, root);
  });
}

}  // namespace

Result<void> checkDocument(nlohmann::json& document, const std::string& file,
                           std::vector<std::string>& warnings) {
  try {
    const Entry entry{document, "the document", warnings};
    for (const auto mend :
         {mendCameras, mendMembers, mendMaterials, mendLights, mendPrimitives, mendAnimations, mendUnused})
      mend(entry);
    const Root root{{document, "the document"}};
    checkAsset(root);
    checkExtensions(root);
    checkBuffers(root);
    checkMaterials(root);
    checkMeshes(root);
    checkNodes(root);
    return {};
  } catch (const BrokenField& broken) {
    return fail(file, broken.problem, broken.hint);
  } catch (const nlohmann::json::exception& exception) {
    return fail(file, fmt::format("is not glTF 2.0 ({})", reasonOf(exception)), BrokenField{}.hint);
  }
}

}  // namespace lambent::baker
