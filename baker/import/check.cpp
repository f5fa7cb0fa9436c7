#include "baker/import/check.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "runtime/bundle/material_fields.hpp"

namespace lambent::baker {

namespace {

using nlohmann::json;

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

std::size_t componentBytes(std::uint64_t component_type) {
  switch (component_type) {
    case 5120:
    case 5121:
      return 1;  // byte, unsigned byte
    case 5122:
    case 5123:
      return 2;  // short, unsigned short
    case 5125:
    case 5126:
      return 4;  // unsigned int, float
    default:
      return 0;
  }
}

std::size_t componentsOf(std::string_view type) {
  constexpr std::array<std::pair<std::string_view, std::size_t>, 7> kTypes{
      {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}}};
  for (const auto& [known, components] : kTypes)
    if (known == type) return components;
  return 0;
}

const nlohmann::json& Entry::list(const char* key) const {
  static const nlohmann::json kEmpty = nlohmann::json::array();
  const nlohmann::json* value = find(key);
  if (value == nullptr || value->is_null()) return kEmpty;
  if (!value->is_array()) refuse("{}: {} is not an array", name, key);
  return *value;
}

std::uint64_t Entry::toNumber(const nlohmann::json& value, const std::string& key) const {
  constexpr std::uint64_t kLargest = std::uint64_t{1} << 53;
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > kLargest)
    refuse("{}: {} is not a whole number from 0 up", name, key);
  return value.get<std::uint64_t>();
}

std::optional<std::uint64_t> Entry::number(const char* key) const {
  const nlohmann::json* value = find(key);
  if (value == nullptr) return std::nullopt;
  return toNumber(*value, key);
}

std::uint64_t Entry::required(const char* key) const {
  const auto value = number(key);
  if (!value) refuse("{} has no {}", name, key);
  return *value;
}

std::optional<std::uint64_t> Entry::below(const char* key, std::size_t size, const char* list) const {
  const auto value = number(key);
  if (value && *value >= size)
    refuse("{}: {} {} does not exist (there are {} {})", name, key, *value, size, list);
  return value;
}

std::optional<std::uint64_t> Entry::index(const char* key, const char* list) const {
  const auto value = below(key, memberOf(document.json, {list}).size(), list);
  if (value) document.used[list].insert(*value);
  return value;
}

void Entry::indexAll(const char* list) const {
  for (const auto& item : json.items()) index(item.key().c_str(), list);
}

std::string Entry::text(const char* key) const {
  const nlohmann::json* value = find(key);
  if (value == nullptr) return {};
  if (!value->is_string()) refuse("{}: {} is not a string", name, key);
  return value->get<std::string>();
}

void Entry::numbers(const char* key, std::size_t count) const {
  const nlohmann::json* values = find(key);
  if (values == nullptr || (values->is_array() && (count == 0 || values->size() == count) &&
                            std::ranges::all_of(*values, isFiniteNumber)))
    return;
  if (count == 0) refuse("{}: {} is not a list of finite numbers", name, key);
  refuse("{}: {} is not {} finite numbers", name, key, count);
}

namespace {

void checkAsset(const Entry& root) {
  const auto asset = root.object("asset");
  const std::string version = asset ? asset->text("version") : std::string();
  if (version.empty()) refuse("is not glTF: no asset.version");
  const std::string minimum = asset->text("minVersion");
  if (!version.starts_with("2.") || !(minimum.empty() || minimum == "2.0"))
    throw Error{{},
                fmt::format("needs glTF {}, this program reads 2.0", minimum.empty() ? version : minimum),
                "export the scene as glTF 2.0"};
}

// Returns whether bytes of vertices or indices lie where only the extension finds or decodes them: it is used
// by a buffer, view or accessor, or by a primitive that has no such bytes.
bool holdsGeometry(const std::string& name, const Entry& root) {
  const auto uses = [&](const json& object) {
    return !memberOf(object, {"extensions", name.c_str()}).is_null();
  };
  for (const char* key : {"buffers", "bufferViews", "accessors"})
    if (std::ranges::any_of(root.list(key), uses)) return true;
  const json& accessors = root.list("accessors");
  const auto lacksBytes = [&](const json& index) {
    const std::size_t i = index.is_number_unsigned() ? index.get<std::size_t>() : accessors.size();
    return i < accessors.size() && !accessors[i].contains("bufferView") && !accessors[i].contains("sparse");
  };
  bool found = false;
  root.forEach("meshes", "mesh", [&](const Entry& mesh) {
    for (const json& primitive : mesh.list("primitives")) {
      const json& positions = memberOf(primitive, {"attributes", "POSITION"});
      found |= uses(primitive) &&
               (positions.is_null() || lacksBytes(positions) || lacksBytes(memberOf(primitive, {"indices"})));
    }
  });
  return found;
}

void checkExtensions(const Entry& root) {
  for (const json& entry : root.list("extensionsRequired")) {
    const std::string name = entry.is_string() ? entry.get<std::string>() : entry.dump();
    if (!readsExtension(name) && holdsGeometry(name, root))
      throw Error{{},
                  fmt::format("has geometry that only the extension {} can decode", name),
                  "export the scene without it"};
  }
}

void checkDraco(const Entry& draco) {
  if (!draco.index("bufferView", "bufferViews")) refuse("{} has no bufferView", draco.name);
  const auto attributes = draco.object("attributes");
  if (!attributes) refuse("{} has no attributes", draco.name);
  for (const auto& [key, value] : attributes->json.items())
    if (attributes->toNumber(value, key) > 0xffff) refuse("{}: {} has a wild attribute id", draco.name, key);
}

void checkPrimitive(const Entry& primitive) {
  primitive.object("attributes")->indexAll("accessors");  // which mends have made an object
  const auto indices = primitive.index("indices", "accessors");
  primitive.index("material", "materials");
  if (primitive.number("mode").value_or(4) > 6) refuse("{} has an unknown mode", primitive.name);
  const auto draco = primitive.extension("KHR_draco_mesh_compression");
  if (draco) checkDraco(*draco);
  // Indices that are all zero would be triangles without area.
  if (indices && !draco) {
    const json& accessor = primitive.document.json["accessors"][*indices];
    if (!accessor.contains("bufferView") && !accessor.contains("sparse"))
      refuse("accessor {} holds indices but has no bufferView", *indices);
  }
  primitive.forEach("targets", primitive.name + ", morph target",
                    [](const Entry& target) { target.indexAll("accessors"); });
}

void checkMesh(const Entry& mesh) {
  mesh.numbers("weights");
  mesh.forEach("primitives", mesh.name + ", primitive", checkPrimitive);
}

void checkNodeNumbers(const Entry& owner, const char* key) {
  const std::size_t size = memberOf(owner.document.json, {"nodes"}).size();
  for (const json& entry : owner.list(key))
    if (owner.toNumber(entry, key) >= size)
      refuse("{}: node {} does not exist (there are {})", owner.name, entry.dump(), size);
}

void checkNode(const Entry& node) {
  node.index("mesh", "meshes");
  node.index("camera", "cameras");
  node.index("skin", "skins");
  node.text("name");
  checkNodeNumbers(node, "children");
  node.numbers("matrix", 16);
  node.numbers("translation", 3);
  node.numbers("rotation", 4);
  node.numbers("scale", 3);
  node.numbers("weights");
  if (const auto light = node.extension("KHR_lights_punctual")) {
    const json& lights = memberOf(node.document.json, {"extensions", "KHR_lights_punctual", "lights"});
    if (!light->below("light", lights.size(), "lights")) refuse("{} names no light", light->name);
  }
  if (const auto instances = node.extension("EXT_mesh_gpu_instancing")) {
    const auto attributes = instances->object("attributes");
    if (!attributes) refuse("{} has no attributes", instances->name);
    attributes->indexAll("accessors");
  }
}

void checkAnimation(const Entry& animation) {
  animation.text("name");
  animation.forEach("samplers", animation.name + ", sampler", [](const Entry& sampler) {
    for (const char* key : {"input", "output"})
      if (!sampler.index(key, "accessors")) refuse("{} has no {}", sampler.name, key);
  });
  const std::size_t samplers = animation.list("samplers").size();
  animation.forEach("channels", animation.name + ", channel", [&](const Entry& channel) {
    channel.below("sampler", samplers, "samplers");
    const Entry target = *channel.object("target");  // mends have left out channels without one
    target.index("node", "nodes");
    target.text("path");
  });
}

void checkSkin(const Entry& skin) {
  if (skin.list("joints").empty()) refuse("{} has no joints", skin.name);
  checkNodeNumbers(skin, "joints");
  skin.index("inverseBindMatrices", "accessors");
}

// This limits accessors without a bufferView (all zeros), since such a claim costs a file nothing.
constexpr std::uint64_t kMaxImplicitCount = 1u << 24;

// Returns the bytes of one element; columns of matrices start at multiples of four.
std::uint64_t elementBytes(const std::string& type, std::uint64_t component) {
  const std::uint64_t components = componentsOf(type);
  if (components == 0 || !type.starts_with("MAT")) return components * component;
  const auto columns = static_cast<std::uint64_t>(type.back() - '0');
  return columns * ((columns * component + 3) / 4 * 4);
}

// Returns the object of a list that the owner must name.
Entry named(const Entry& owner, const char* key, const char* list) {
  const auto i = owner.below(key, memberOf(owner.document.json, {list}).size(), list);
  if (!i) refuse("{} has no {}", owner.name, key);
  return {owner.document.json[list][*i], fmt::format("{} {}", key, *i), owner.document};
}

// Checks that `count` elements of `element` bytes fit at byteOffset of the object's bufferView.
void checkExtent(const Entry& object, std::uint64_t count, std::uint64_t element, bool strided) {
  const Entry view = named(object, "bufferView", "bufferViews");
  const std::uint64_t offset = object.number("byteOffset").value_or(0);
  const std::uint64_t available = view.required("byteLength");
  const std::uint64_t stride = strided ? view.number("byteStride").value_or(element) : element;
  if (stride < element)
    refuse("{}: byteStride {} is less than an element of {} bytes", object.name, stride, element);
  // This divides because count * stride may exceed 2^64.
  const bool fits = offset <= available && element <= available - offset &&
                    (count - 1) <= (available - offset - element) / stride;
  if (!fits)
    refuse("{}: {} elements do not fit the {} bytes of {}", object.name, count, available, view.name);
  object.index("bufferView", "bufferViews");  // as used
}

void checkSparse(const Entry& sparse, std::uint64_t count, std::uint64_t element) {
  const std::uint64_t replaced = sparse.required("count");
  if (replaced == 0 || replaced > count)
    refuse("{}: replaces {} of {} elements", sparse.name, replaced, count);
  const auto indices = sparse.object("indices"), values = sparse.object("values");
  if (!indices || !values) refuse("{} has no indices or no values", sparse.name);
  const std::uint64_t type = indices->required("componentType");
  if (type != 5121 && type != 5123 && type != 5125)
    refuse("{}: componentType {} is no index type", indices->name, type);
  checkExtent(*indices, replaced, componentBytes(type), /*strided=*/false);
  checkExtent(*values, replaced, element, /*strided=*/false);
}

// The list, in CheckedDocument::used, of views that only accessors without elements name.
constexpr const char* kEmpty = "empty views";

void checkAccessor(const Entry& accessor) {
  const std::uint64_t component = componentBytes(accessor.required("componentType"));
  if (component == 0) refuse("{} has an unknown componentType", accessor.name);
  const std::uint64_t element = elementBytes(accessor.text("type"), component);
  if (element == 0) refuse("{} has an unknown type", accessor.name);
  const std::uint64_t count = accessor.required("count");
  if (count == 0) {
    if (const json* view = accessor.find("bufferView"); view != nullptr && view->is_number_unsigned())
      accessor.document.used[kEmpty].insert(view->get<std::uint64_t>());
    return;
  }
  if (accessor.find("bufferView") != nullptr)
    checkExtent(accessor, count, element, /*strided=*/true);
  else if (count > kMaxImplicitCount)
    refuse("{} claims {} elements without a bufferView", accessor.name, count);
  if (const auto sparse = accessor.object("sparse")) checkSparse(*sparse, count, element);
}

// Checks the bytes of a view, or of what the extension decodes into it. Returns how many they are.
std::uint64_t checkBytes(const Entry& object) {
  const Entry buffer = named(object, "buffer", "buffers");
  const std::uint64_t available = buffer.required("byteLength");
  const std::uint64_t offset = object.number("byteOffset").value_or(0);
  const std::uint64_t length = object.required("byteLength");
  if (offset > available || length > available - offset)
    refuse("{} reaches from byte {} to {} of the {} bytes of {}", object.name, offset, offset + length,
           available, buffer.name);
  return length;
}

// Checks modes, strides and filters as the extension specifies them; the decoders rely on this.
void checkMeshopt(const Entry& coded, std::uint64_t bytes) {
  if (checkBytes(coded) == 0) refuse("{} has no bytes", coded.name);
  const std::uint64_t stride = coded.required("byteStride"), count = coded.required("count");
  if (stride == 0 || stride > 256 || count == 0 || count > bytes / stride || count * stride != bytes)
    refuse("{}: {} elements of {} bytes are not its bytes", coded.name, count, stride);
  const std::string mode = coded.text("mode"), filter = coded.text("filter");
  const bool indices = mode == "TRIANGLES" || mode == "INDICES";
  if (!(mode == "ATTRIBUTES" && stride % 4 == 0) && !(indices && (stride == 2 || stride == 4)))
    refuse("{}: mode \"{}\" does not go with a stride of {}", coded.name, mode, stride);
  if (mode == "TRIANGLES" && count % 3 != 0) refuse("{} is not whole triangles", coded.name);
  const bool filter_fits =
      filter.empty() || filter == "NONE" ||
      (mode == "ATTRIBUTES" && ((filter == "OCTAHEDRAL" && (stride == 4 || stride == 8)) ||
                                (filter == "QUATERNION" && stride == 8) || filter == "EXPONENTIAL"));
  if (!filter_fits) refuse("{}: filter \"{}\" does not go with it", coded.name, filter);
}

void checkView(const Entry& view) {
  const std::uint64_t length = checkBytes(view);
  view.number("byteStride");
  if (const auto coded = view.extension(kMeshopt)) checkMeshopt(*coded, length);
}

// Checks the objects of a list, after all objects that may refer to them. Where they are wrong and nothing
// reads them, `empty` is put in their place.
template <typename Check>
void checkList(const Entry& root, const char* key, const char* what, const json& empty, Check check) {
  std::size_t i = 0;
  root.forEach(key, what, [&](const Entry& entry) {
    if (root.document.used[key].contains(i++)) return check(entry);
    try {
      check(entry);
      if (memberOf(entry.json, {"byteLength"}) == 0 && !root.document.used[kEmpty].contains(i - 1))
        refuse("{} has no bytes", entry.name);
    } catch (const Error& error) {
      root.document.warnings.push_back(error.problem + ", but nothing reads it");
      entry.json = empty;
      check(entry);
    }
  });
}

void checkBuffers(const Entry& root) {
  root.forEach("buffers", "buffer", [](const Entry& buffer) {
    buffer.required("byteLength");
    buffer.text("uri");
  });
  checkList(root, "accessors", "accessor", {{"componentType", 5126u}, {"count", 0u}, {"type", "SCALAR"}},
            checkAccessor);
  checkList(root, "bufferViews", "bufferView", {{"buffer", 0u}, {"byteLength", 0u}}, checkView);
}

}  // namespace

void checkDocument(nlohmann::json& document, std::vector<std::string>& warnings) {
  CheckedDocument checked{document, warnings};
  const Entry root{document, "the document", checked};
  try {
    checkAsset(root);
    for (const auto mend :
         {mendCameras, mendMembers, mendMaterials, mendLights, mendPrimitives, mendAnimations})
      mend(root);
    checkExtensions(root);
    root.forEach("images", "image", [](const Entry& image) { image.index("bufferView", "bufferViews"); });
    root.forEach("textures", "texture", [](const Entry& texture) {
      texture.index("source", "images");
      texture.index("sampler", "samplers");
    });
    root.forEach("meshes", "mesh", checkMesh);
    root.forEach("nodes", "node", checkNode);
    root.forEach("scenes", "scene", [](const Entry& scene) { checkNodeNumbers(scene, "nodes"); });
    root.index("scene", "scenes");
    root.forEach("animations", "animation", checkAnimation);
    root.forEach("skins", "skin", checkSkin);
    checkBuffers(root);
  } catch (const json::exception& exception) {
    refuse("is not glTF 2.0 ({})", reasonOf(exception));
  }
}

}  // namespace lambent::baker
