// Writes and reads animations as ordinary glTF, with one sampler per channel and one view per animation.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "runtime/bundle/description_json.hpp"

namespace lambent::bundle {

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
