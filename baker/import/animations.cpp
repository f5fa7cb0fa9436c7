// Converts animations: channels of translation, rotation and scale. They are checked here, so that players
// need not; one that makes no sense is left out with a warning, and its node stays at rest.
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/import/convert.hpp"
#include "baker/import/document.hpp"
#include "baker/import/scene_files.hpp"

namespace lambent::baker {
namespace {

using gltf::AnimationChannel;
using nlohmann::json;

// Channels may share accessors, so without a limit a small file could claim any amount.
constexpr std::size_t kMaxNumbers = 1u << 26;

std::optional<AnimationChannel::Path> pathOf(const std::string& word) {
  if (word == "translation") return AnimationChannel::Path::Translation;
  if (word == "rotation") return AnimationChannel::Path::Rotation;
  if (word == "scale") return AnimationChannel::Path::Scale;
  return std::nullopt;
}

AnimationChannel::Interpolation interpolationOf(const std::string& word) {
  if (word == "STEP") return AnimationChannel::Interpolation::Step;
  if (word == "CUBICSPLINE") return AnimationChannel::Interpolation::Cubic;
  return AnimationChannel::Interpolation::Linear;
}

Result<void> checkTimes(const std::vector<float>& times, const std::string& file, const std::string& name) {
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!std::isfinite(times[i]) || times[i] < 0.0f)
      return fail(file, fmt::format("{}: the time of key {} is not a number from 0 up", name, i),
                  kExportAgain);
    if (i > 0 && !(times[i - 1] < times[i]))
      return fail(file, fmt::format("{}: times do not rise at key {}", name, i), kExportAgain);
  }
  return {};
}

// Makes quaternions unit, because quantized ones are not exactly. Tangents of cubic keys keep their
// proportion.
Result<void> normalizeRotations(AnimationChannel& channel, const std::string& file, const std::string& name) {
  const std::size_t each = channel.interpolation == AnimationChannel::Interpolation::Cubic ? 12 : 4;
  for (std::size_t key = 0; key < channel.times_s.size(); ++key) {
    float* values = &channel.values[key * each];
    const float* q = each == 12 ? values + 4 : values;
    const float length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(length > 1e-6f))
      return fail(file, fmt::format("{}: the rotation of key {} is zero", name, key), kExportAgain);
    for (std::size_t i = 0; i < each; ++i) values[i] /= length;
  }
  return {};
}

Result<AnimationChannel> readChannel(const Document& document, const json& sampler, AnimationChannel channel,
                                     const std::string& name) {
  const std::string& file = document.file();
  const std::size_t components = channel.path == AnimationChannel::Path::Rotation ? 4 : 3;
  auto times = readFloats(document, sampler["input"].get<std::size_t>(), name + ": input", {"SCALAR"});
  if (!times) return failAgain(std::move(times.error()));
  auto values = readFloats(document, sampler["output"].get<std::size_t>(), name + ": output",
                           {components == 4 ? "VEC4" : "VEC3"});
  if (!values) return failAgain(std::move(values.error()));
  channel.interpolation = interpolationOf(sampler.value("interpolation", "LINEAR"));
  const std::size_t each = channel.interpolation == AnimationChannel::Interpolation::Cubic ? 3 : 1;
  if (values->count() != each * times->count())
    return fail(file, fmt::format("{}: {} values for {} keys", name, values->count(), times->count()),
                kExportAgain);
  if (times->count() == 0) return fail(file, name + ": it has no keys", kExportAgain);
  channel.times_s = std::move(times->values);
  channel.values = std::move(values->values);
  if (auto checked = checkTimes(channel.times_s, file, name); !checked) return failAgain(checked.error());
  for (std::size_t i = 0; i < channel.values.size(); ++i)
    if (!std::isfinite(channel.values[i]))
      return fail(file, fmt::format("{}: value {} is not finite", name, i / components), kExportAgain);
  if (channel.path == AnimationChannel::Path::Rotation)
    if (auto done = normalizeRotations(channel, file, name); !done) return failAgain(done.error());
  return channel;
}

// Channels replace parts of a transform, so an animated node needs such parts. glTF forbids it a matrix, but
// one without shear does no harm.
Result<gltf::Trs> partsOf(const Document& document, std::size_t n) {
  const json& node = document.at("nodes", n);
  gltf::Trs trs;
  if (!node.contains("matrix")) {
    const auto vector = [&](const char* key, glm::vec3 fallback) {
      if (!node.contains(key)) return fallback;
      return glm::vec3(node[key][0].get<float>(), node[key][1].get<float>(), node[key][2].get<float>());
    };
    trs.translation = vector("translation", glm::vec3(0.0f));
    trs.scale = vector("scale", glm::vec3(1.0f));
    if (node.contains("rotation")) {
      const json& r = node["rotation"];
      const glm::dquat rotation(r[3].get<double>(), r[0].get<double>(), r[1].get<double>(),
                                r[2].get<double>());
      if (glm::length(rotation) > 0.0) trs.rotation = glm::quat(glm::normalize(rotation));
    }
    return trs;
  }
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
  if (wrong > 1e-4f * size)
    return fail(document.file(), fmt::format("node {} is animated but has a matrix with shear", n),
                "give it translation, rotation and scale");
  return trs;
}

Result<void> markAnimated(const Document& document, std::size_t file_node, gltf::Node& node) {
  if (!node.trs) {
    auto trs = partsOf(document, file_node);
    if (!trs) return failAgain(trs.error());
    node.trs = *trs;
    node.parent_from_node = trs->matrix();
  }
  node.animated = true;
  return {};
}

Result<void> convertAnimation(const Document& document, const json& source, const NodeMap& map,
                              const std::string& name, std::size_t& total, Scene& scene) {
  gltf::Animation animation{source.value("name", ""), {}};
  if (!source.contains("channels")) return {};
  std::set<std::pair<std::size_t, AnimationChannel::Path>> targets;
  for (std::size_t c = 0; c < source["channels"].size(); ++c) {
    const json& channel = source["channels"][c];
    const json& target = channel["target"];
    const std::string word = target.value("path", "");
    const auto path = pathOf(word);
    if (!path) {
      scene.warnings.push_back(fmt::format("{}: its channels of {} are left out", name,
                                           word == "weights" ? "morph weights" : "\"" + word + "\""));
      continue;
    }
    if (!target.contains("node")) continue;  // glTF says to ignore the channel
    const auto node = target["node"].get<std::size_t>();
    if (map.scene_node[node] < 0) continue;  // the node belongs to another scene
    const auto leaveOut = [&](const Error& error) {
      scene.warnings.push_back(error.problem + ", so the channel is left out");
    };
    if (!targets.emplace(node, *path).second) {
      leaveOut({{}, fmt::format("{}: it moves the {} of node {} twice", name, word, node), {}});
      continue;
    }
    AnimationChannel wanted;
    wanted.node = static_cast<std::uint32_t>(map.scene_node[node]);
    wanted.path = *path;
    auto read = readChannel(document, source["samplers"][channel["sampler"].get<std::size_t>()], wanted,
                            fmt::format("{}, channel {}", name, c));
    if (!read) {
      leaveOut(read.error());
      continue;
    }
    total += read->times_s.size() + read->values.size();
    if (total > kMaxNumbers)
      return fail(document.file(), fmt::format("{} brings the keyframes to more than {}", name, kMaxNumbers),
                  "sample its motion at fewer times");
    if (const auto marked = markAnimated(document, node, scene.nodes[wanted.node]); !marked)
      leaveOut(marked.error());
    else
      animation.channels.push_back(std::move(*read));
  }
  if (!animation.channels.empty()) scene.animations.push_back(std::move(animation));
  return {};
}

}  // namespace

Result<void> convertAnimations(const Document& document, const NodeMap& map, Scene& scene) {
  const json& animations = document.list("animations");
  std::size_t total = 0;
  for (std::size_t i = 0; i < animations.size(); ++i) {
    const std::string name = fmt::format("animation {}", i);
    if (auto done = convertAnimation(document, animations[i], map, name, total, scene); !done) return done;
  }
  return {};
}

}  // namespace lambent::baker
