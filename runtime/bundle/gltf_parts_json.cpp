// Writes and reads materials and their extensions by the table of fields (material_fields.hpp), and
// animations. Texture transforms and emission above 1 have special rules.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>

#include "runtime/bundle/description_json.hpp"
#include "runtime/bundle/material_fields.hpp"

namespace lambent::bundle {

namespace {

constexpr const char* kTextureTransform = "KHR_texture_transform";
constexpr const char* kEmissiveStrength = "KHR_materials_emissive_strength";
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

// ---- values as JSON

template <class T>
Json fieldJson(const T& value, std::set<std::string>& used) {
  if constexpr (std::is_same_v<T, gltf::TextureRef>)
    return textureJson(value, used);
  else if constexpr (std::is_same_v<T, gltf::AlphaMode>)
    return kAlphaModes[static_cast<std::size_t>(value)];
  else if constexpr (std::is_same_v<T, std::int32_t>)
    return static_cast<std::uint32_t>(value);
  else
    return valueJson(value);
}

template <class T>
void readField(const Field& field, std::size_t texture_count, T& value) {
  constexpr std::uint64_t kMostBrdfs = 1u << 16;  // transfer_json.cpp checks that the table exists
  if constexpr (std::is_same_v<T, gltf::TextureRef>)
    value = readTexture(field, texture_count);
  else if constexpr (std::is_same_v<T, gltf::AlphaMode>)
    value = field.word<gltf::AlphaMode>(kAlphaModes);
  else if constexpr (std::is_same_v<T, std::int32_t>)
    value = static_cast<std::int32_t>(field.count(kMostBrdfs));
  else
    readValue(field, value);
}

using Allowed = gltf::MaterialJson::Allowed;

void checkValue(const Field& field, Allowed allowed, float value) {
  if (allowed == Allowed::ZeroToOne && !(value >= 0.0f && value <= 1.0f)) field.fault("is not from 0 to 1");
  if (allowed == Allowed::NotNegative && !(value >= 0.0f)) field.fault("is negative");
  if (allowed == Allowed::ZeroOrFromOne && value != 0.0f && !(value >= 1.0f))
    field.fault("is neither 0 nor 1 and more");
}
void checkValue(const Field& field, Allowed allowed, const glm::vec3& value) {
  if (allowed == Allowed::NotNegative && (value.x < 0.0f || value.y < 0.0f || value.z < 0.0f))
    field.fault("is negative");
}
template <class T>
void checkValue(const Field&, Allowed, const T&) {}

// ---- rows of the table

bool isSaid(const gltf::MaterialJson& json, const gltf::Material& material, bool is_default) {
  return json.said ? json.said(material) : !is_default;
}

bool isDefault(const gltf::TextureRef& value, const gltf::TextureRef&) {
  return value.texture < 0;
}
template <class T>
bool isDefault(const T& value, const T& otherwise) {
  return value == otherwise;
}

// Writes a field unless it has its default. Extensions with only default values are therefore not written.
template <class Row>
void writeRow(const Row& row, const gltf::Material& material, Json& json, std::set<std::string>& used) {
  const auto& value = material.*row.member;
  if (!isSaid(row.json, material, isDefault(value, gltf::Material().*row.member))) return;
  Json* place = &json;
  for (const char* object : row.json.objects)
    if (object) place = &(*place)[object];
  const auto [outer, inner] = row.json.objects;
  if (inner && std::string_view(outer) == "extensions") used.insert(inner);
  if (row.json.key)
    (*place)[row.json.key] = fieldJson(value, used);
  else
    *place = Json::object();
}

template <class Row>
void readRow(const Row& row, const Field& field, std::size_t texture_count, gltf::Material& material) {
  Field place = field;
  for (const char* object : row.json.objects) {
    if (!object) continue;
    if (!place.has(object)) return;
    place = place[object];
  }
  auto& value = material.*row.member;
  if constexpr (std::is_same_v<typename Row::Value, bool>)
    if (!row.json.key) {
      value = true;
      return;
    }
  if (!row.json.required && !place.has(row.json.key)) return;
  readField(place[row.json.key], texture_count, value);
  checkValue(place[row.json.key], row.json.allowed, value);
}

// ---- emission: glTF's factor is at most 1, so brighter materials also have a strength

void splitEmission(const gltf::Material& material, Json& json, std::set<std::string>& used) {
  const float strength = std::max({material.emissive.x, material.emissive.y, material.emissive.z});
  if (!(strength > 1.0f)) return;
  json["emissiveFactor"] = vectorJson(material.emissive / strength);
  json["extensions"][kEmissiveStrength] = {{"emissiveStrength", strength}};
  used.insert(kEmissiveStrength);
}

void joinEmission(const Field& field, gltf::Material& material) {
  if (field.has("extensions") && field["extensions"].has(kEmissiveStrength))
    material.emissive *= field["extensions"][kEmissiveStrength]["emissiveStrength"].number();
  for (int c = 0; c < 3; ++c)
    if (!(material.emissive[c] >= 0.0f && std::isfinite(material.emissive[c])))
      field.fault("has an emission that is negative or not finite");
}

}  // namespace

Json materialJson(const gltf::Material& material, std::set<std::string>& used) {
  Json json = Json::object();
  gltf::forEachMaterialField([&](const auto& row) { writeRow(row, material, json, used); });
  splitEmission(material, json, used);
  return json;
}

gltf::Material readMaterial(const Field& field, std::size_t texture_count) {
  gltf::Material material;
  static_cast<void>(field["pbrMetallicRoughness"]);  // throws if it is missing
  gltf::forEachMaterialField([&](const auto& row) { readRow(row, field, texture_count, material); });
  joinEmission(field, material);
  return material;
}

// Animations are ordinary glTF, with one sampler per channel and one view per animation.

namespace {

using gltf::AnimationChannel;

constexpr std::array kPaths = {"translation", "rotation", "scale"};
constexpr std::array kInterpolations = {"STEP", "LINEAR", "CUBICSPLINE"};
constexpr int kFloat = 5126;

std::size_t componentsOf(AnimationChannel::Path path) {
  return path == AnimationChannel::Path::Rotation ? 4 : 3;
}

const char* vectorType(AnimationChannel::Path path) {
  return path == AnimationChannel::Path::Rotation ? "VEC4" : "VEC3";
}

void append(Blob& blob, const std::vector<float>& values) {
  const auto bytes = std::as_bytes(std::span(values));
  blob.insert(blob.end(), bytes.begin(), bytes.end());
}

// Returns the count of an accessor. Throws JsonFault unless it holds `type` in float32 at `offset` of the
// view.
std::uint64_t countAt(const Field& accessor, const std::string& type, std::size_t view, std::uint64_t offset,
                      std::uint64_t view_bytes, std::uint64_t components) {
  if (accessor["componentType"].count(0xffff) != kFloat || accessor["type"].text() != type)
    accessor.fault("is not float32 " + type);
  if (accessor["bufferView"].count(0xffffffffu) != view || accessor["byteOffset"].count(view_bytes) != offset)
    accessor.fault("does not lie where the keyframes of its animation lie");
  const std::uint64_t count = accessor["count"].count(0xffffffffu);
  if (count == 0 || count > (view_bytes - offset) / (4 * components))
    accessor.fault("does not fit its bufferView");
  return count;
}

}  // namespace

Blob animationBytes(const gltf::Animation& animation) {
  Blob blob;
  for (const AnimationChannel& channel : animation.channels) {
    append(blob, channel.times_s);
    append(blob, channel.values);
  }
  return blob;
}

Json animationJson(const gltf::Animation& animation, std::size_t view, Json& accessors) {
  Json json = Json::object();
  if (!animation.name.empty()) json["name"] = animation.name;
  std::uint64_t offset = 0;
  const auto accessor = [&](const char* type, std::size_t floats, std::size_t components) {
    Json out = {{"bufferView", view},
                {"byteOffset", offset},
                {"componentType", kFloat},
                {"count", floats / components},
                {"type", type}};
    offset += floats * sizeof(float);
    return out;
  };
  for (const AnimationChannel& channel : animation.channels) {
    Json times = accessor("SCALAR", channel.times_s.size(), 1);
    times["min"] = {channel.times_s.front()};
    times["max"] = {channel.times_s.back()};
    json["channels"].push_back(
        {{"sampler", json.contains("samplers") ? json["samplers"].size() : 0},
         {"target", {{"node", channel.node}, {"path", kPaths[static_cast<std::size_t>(channel.path)]}}}});
    json["samplers"].push_back(
        {{"input", accessors.size()},
         {"output", accessors.size() + 1},
         {"interpolation", kInterpolations[static_cast<std::size_t>(channel.interpolation)]}});
    accessors.push_back(std::move(times));
    accessors.push_back(
        accessor(vectorType(channel.path), channel.values.size(), componentsOf(channel.path)));
  }
  return json;
}

gltf::Animation readAnimation(const Field& field, const std::vector<Field>& accessors, std::size_t view,
                              std::uint64_t view_bytes, const std::vector<gltf::Node>& nodes) {
  gltf::Animation animation;
  if (field.has("name")) animation.name = field["name"].text();
  const auto samplers = field["samplers"].items();
  std::uint64_t offset = 0;
  for (const Field& entry : field["channels"].items()) {
    AnimationChannel channel;
    const Field target = entry["target"];
    channel.node = target["node"].index(nodes.size());
    if (const gltf::Node& node = nodes[channel.node]; !node.trs && node.parent_from_node != glm::mat4(1.0f))
      target["node"].fault("has a matrix, which cannot be animated");
    channel.path = target["path"].word<AnimationChannel::Path>(kPaths);
    const Field& sampler = samplers[entry["sampler"].index(samplers.size())];
    channel.interpolation = sampler["interpolation"].word<AnimationChannel::Interpolation>(kInterpolations);
    const Field& input = accessors[sampler["input"].index(accessors.size())];
    const Field& output = accessors[sampler["output"].index(accessors.size())];
    const std::uint64_t keys = countAt(input, "SCALAR", view, offset, view_bytes, 1);
    offset += 4 * keys;
    const std::uint64_t components = componentsOf(channel.path);
    const std::uint64_t values =
        countAt(output, vectorType(channel.path), view, offset, view_bytes, components);
    offset += 4 * components * values;
    const std::uint64_t each = channel.interpolation == AnimationChannel::Interpolation::Cubic ? 3 : 1;
    if (values != each * keys) output.fault(fmt::format("has {} values for {} keys", values, keys));
    channel.times_s.resize(keys);
    channel.values.resize(values * components);
    animation.channels.push_back(std::move(channel));
  }
  if (offset != view_bytes) field.fault("does not fill its bufferView");
  return animation;
}

bool loadAnimation(gltf::Animation& animation, std::span<const std::byte> bytes) {
  const auto load = [&](std::vector<float>& values) {
    std::memcpy(values.data(), bytes.data(), values.size() * sizeof(float));
    bytes = bytes.subspan(values.size() * sizeof(float));
    return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
  };
  bool good = true;
  for (AnimationChannel& channel : animation.channels) {
    good = load(channel.times_s) && good;
    good = load(channel.values) && good;
    // Times must rise strictly, so no two keys may have the same time.
    good = good && std::adjacent_find(channel.times_s.begin(), channel.times_s.end(),
                                      [](float a, float b) { return !(a < b); }) == channel.times_s.end();
  }
  return good;
}

}  // namespace lambent::bundle

namespace lambent::gltf {

// Checks that every member of a material has a row in the table; otherwise this file does not compile.
namespace {

// Stands for a value of any type where a type only counts how many values it takes.
struct AnyValue {
  template <class T>
  operator T() const;
};

// Returns how many members an aggregate has: it takes so many values, and not one more.
template <class T, class... Values>
consteval std::size_t memberCount() {
  if constexpr (requires { T{Values()..., AnyValue()}; })
    return memberCount<T, Values..., AnyValue>();
  else
    return sizeof...(Values);
}

constexpr std::size_t liveValues() {
  std::size_t count = 0;
  forEachLiveValue([&](const auto&, const auto&) { ++count; });
  return count;
}

static_assert(memberCount<Material>() == std::tuple_size_v<decltype(kMaterialFields)>,
              "every member of Material has a row in kMaterialFields");
static_assert(memberCount<MaterialFactors>() == liveValues(),
              "every member of MaterialFactors is a live value of a row in kMaterialFields");

}  // namespace

}  // namespace lambent::gltf
