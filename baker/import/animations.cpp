// Converts animations: channels of translation, rotation and scale. They are checked here, so that players
// need not; one that makes no sense is left out with a warning, and its node stays at rest.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/import/convert.hpp"
#include "baker/import/document.hpp"

namespace lambent::baker {
namespace {

using gltf::AnimationChannel;
using nlohmann::json;

// Channels may share accessors, so without a limit a small file could claim any amount.
constexpr std::size_t kMaxNumbers = 1u << 26;

using Path = AnimationChannel::Path;

void checkTimes(const std::vector<float>& times, const std::string& name) {
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!std::isfinite(times[i]) || times[i] < 0.0f)
      refuse("{}: the time of key {} is not a number from 0 up", name, i);
    if (i > 0 && !(times[i - 1] < times[i])) refuse("{}: times do not rise at key {}", name, i);
  }
}

// Makes quaternions unit, because quantized ones are not exactly. Tangents of cubic keys keep their
// proportion.
void normalizeRotations(AnimationChannel& channel, const std::string& name) {
  const std::size_t each = channel.interpolation == AnimationChannel::Interpolation::Cubic ? 12 : 4;
  for (std::size_t key = 0; key < channel.times_s.size(); ++key) {
    float* values = &channel.values[key * each];
    const float* q = each == 12 ? values + 4 : values;
    const float length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(length > 1e-6f)) refuse("{}: the rotation of key {} is zero", name, key);
    for (std::size_t i = 0; i < each; ++i) values[i] /= length;
  }
}

AnimationChannel readChannel(const Document& document, const json& sampler, AnimationChannel channel,
                             const std::string& name) {
  const std::size_t components = channel.path == Path::Rotation ? 4 : 3;
  Floats times = readFloats(document, sampler["input"].get<std::size_t>(), name + ": input", {"SCALAR"});
  Floats values = readFloats(document, sampler["output"].get<std::size_t>(), name + ": output",
                             {components == 4 ? "VEC4" : "VEC3"});
  const std::string word = sampler.value("interpolation", "LINEAR");
  if (word == "STEP") channel.interpolation = AnimationChannel::Interpolation::Step;
  if (word == "CUBICSPLINE") channel.interpolation = AnimationChannel::Interpolation::Cubic;
  const std::size_t each = channel.interpolation == AnimationChannel::Interpolation::Cubic ? 3 : 1;
  if (values.count() != each * times.count())
    refuse("{}: {} values for {} keys", name, values.count(), times.count());
  if (times.count() == 0) refuse("{}: it has no keys", name);
  channel.times_s = std::move(times.values);
  channel.values = std::move(values.values);
  checkTimes(channel.times_s, name);
  for (std::size_t i = 0; i < channel.values.size(); ++i)
    if (!std::isfinite(channel.values[i])) refuse("{}: value {} is not finite", name, i / components);
  if (channel.path == Path::Rotation) normalizeRotations(channel, name);
  return channel;
}

// Channels replace parts of a transform, so an animated node needs such parts. glTF forbids it a matrix, but
// one without shear does no harm.
gltf::Trs trsOf(const Document& document, std::size_t n) {
  const json& node = document.at("nodes", n);
  if (!node.contains("matrix")) {
    const NodeParts parts = partsOf(node);
    return {glm::vec3(parts.translation), glm::quat(parts.rotation), glm::vec3(parts.scale)};
  }
  gltf::Trs trs;
  const glm::mat4 matrix(localMatrix(node));
  glm::mat3 linear(matrix);
  trs.translation = glm::vec3(matrix[3]);
  trs.scale = {glm::length(linear[0]), glm::length(linear[1]), glm::length(linear[2])};
  if (glm::determinant(linear) < 0.0f) trs.scale.x = -trs.scale.x;
  float wrong = 0.0f, size = 0.0f;
  if (trs.scale.x != 0.0f && trs.scale.y != 0.0f && trs.scale.z != 0.0f) {
    for (int c = 0; c < 3; ++c) linear[c] /= trs.scale[c];
    trs.rotation = glm::normalize(glm::quat_cast(linear));
  }
  const glm::mat4 again = trs.matrix();
  for (int c = 0; c < 3; ++c) {
    wrong = std::max(wrong, glm::length(again[c] - matrix[c]));
    size = std::max(size, glm::length(matrix[c]));
  }
  if (wrong > 1e-4f * size) refuse("node {} is animated but has a matrix with shear", n);
  return trs;
}

void markAnimated(const Document& document, std::size_t file_node, gltf::Node& node) {
  if (!node.trs) {
    node.trs = trsOf(document, file_node);
    node.parent_from_node = node.trs->matrix();
  }
  node.animated = true;
}

void convertAnimation(const Document& document, const json& source, const NodeMap& map,
                      const std::string& name, std::size_t& total, Scene& scene) {
  static const std::map<std::string, Path> kPaths = {
      {"translation", Path::Translation}, {"rotation", Path::Rotation}, {"scale", Path::Scale}};
  gltf::Animation animation{source.value("name", ""), {}};
  if (!source.contains("channels")) return;
  std::set<std::pair<std::size_t, Path>> targets;
  for (std::size_t c = 0; c < source["channels"].size(); ++c) {
    const json& channel = source["channels"][c];
    const json& target = channel["target"];
    const std::string word = target.value("path", "");
    const auto path = kPaths.find(word);
    if (path == kPaths.end()) {
      scene.warnings.push_back(fmt::format("{}: its channels of {} are left out", name,
                                           word == "weights" ? "morph weights" : "\"" + word + "\""));
      continue;
    }
    if (!target.contains("node")) continue;  // glTF says to ignore the channel
    const auto node = target["node"].get<std::size_t>();
    if (map.scene_node[node] < 0) continue;  // the node belongs to another scene
    try {
      if (!targets.emplace(node, path->second).second)
        refuse("{}: it moves the {} of node {} twice", name, word, node);
      AnimationChannel wanted;
      wanted.node = static_cast<std::uint32_t>(map.scene_node[node]);
      wanted.path = path->second;
      AnimationChannel read = readChannel(document, source["samplers"][channel["sampler"].get<std::size_t>()],
                                          wanted, fmt::format("{}, channel {}", name, c));
      total += read.times_s.size() + read.values.size();
      if (total <= kMaxNumbers) {
        markAnimated(document, node, scene.nodes[wanted.node]);
        animation.channels.push_back(std::move(read));
      }
    } catch (const Error& error) {
      scene.warnings.push_back(error.problem + ", so the channel is left out");
    }
    if (total > kMaxNumbers)
      throw Error{{},
                  fmt::format("{} brings the keyframes to more than {}", name, kMaxNumbers),
                  "sample its motion at fewer times"};
  }
  if (!animation.channels.empty()) scene.animations.push_back(std::move(animation));
}

}  // namespace

void convertAnimations(const Document& document, const NodeMap& map, Scene& scene) {
  const json& animations = document.list("animations");
  std::size_t total = 0;
  for (std::size_t i = 0; i < animations.size(); ++i)
    convertAnimation(document, animations[i], map, fmt::format("animation {}", i), total, scene);
}

}  // namespace lambent::baker
