#include <cmath>
#include <vector>

#include "baker/import/check_fields.hpp"

namespace lambent::baker {
namespace {

void checkIndices(const Object& object, const char* key, std::size_t size) {
  for (const nlohmann::json& entry : object.list(key))
    if (object.toNumber(entry, key) >= size)
      throw BrokenField{
          fmt::format("{}: node {} does not exist (there are {})", object.name, entry.dump(), size)};
}

// Requires a forest: every node has at most one parent, and there are no cycles.
void checkForest(const Root& root) {
  const std::size_t size = root.size("nodes");
  std::vector<std::size_t> parent(size, size);
  std::size_t n = 0;
  root.forEach("nodes", "node", [&](const Object& node) {
    for (const nlohmann::json& entry : node.list("children")) {
      const auto child = entry.get<std::size_t>();
      if (parent[child] != size)
        throw BrokenField{
            fmt::format("node {} is a child of node {} and of node {}", child, parent[child], n),
            "give each node one parent"};
      parent[child] = n;
    }
    ++n;
  });
  // 0 means not seen, 1 on the way up from the current start, 2 known to end at a root.
  std::vector<std::uint8_t> state(size, 0);
  for (std::size_t start = 0; start < size; ++start) {
    std::size_t i = start;
    while (i != size && state[i] == 0) {
      state[i] = 1;
      i = parent[i];
    }
    if (i != size && state[i] == 1)
      throw BrokenField{fmt::format("node {} is its own ancestor", i), "break the circle of nodes"};
    for (i = start; i != size && state[i] == 1; i = parent[i]) state[i] = 2;
  }
}

void checkAnimation(const Object& animation, const Root& root) {
  const auto named = [&](const char* what, std::size_t i) {
    return fmt::format("{}, {} {}", animation.name, what, i);
  };
  animation.text("name");
  std::size_t i = 0;
  for (const nlohmann::json& entry : animation.list("samplers")) {
    const Object sampler{entry, named("sampler", i++)};
    for (const char* key : {"input", "output"})
      if (!sampler.index(key, root.size("accessors"), "accessors"))
        throw BrokenField{fmt::format("{} has no {}", sampler.name, key)};
    const std::string word = sampler.text("interpolation");
    if (!word.empty() && word != "LINEAR" && word != "STEP" && word != "CUBICSPLINE")
      throw BrokenField{fmt::format("{} has the unknown interpolation \"{}\"", sampler.name, word)};
  }
  std::size_t c = 0;
  for (const nlohmann::json& entry : animation.list("channels")) {
    const Object channel{entry, named("channel", c++)};
    if (!channel.index("sampler", i, "samplers"))
      throw BrokenField{fmt::format("{} has no sampler", channel.name)};
    const auto target = channel.object("target");
    if (!target) throw BrokenField{fmt::format("{} has no target", channel.name)};
    target->index("node", root.size("nodes"), "nodes");
    target->text("path");
  }
}

void checkSkin(const Object& skin, const Root& root) {
  if (skin.list("joints").empty()) throw BrokenField{fmt::format("{} has no joints", skin.name)};
  checkIndices(skin, "joints", root.size("nodes"));
  skin.index("inverseBindMatrices", root.size("accessors"), "accessors");
}

}  // namespace

void checkNumbers(const Object& object, const char* key, std::size_t count) {
  const nlohmann::json* values = object.find(key);
  if (values == nullptr) return;
  bool good = values->is_array() && (count == 0 || values->size() == count);
  for (std::size_t i = 0; good && i < values->size(); ++i)
    good = (*values)[i].is_number() && std::isfinite((*values)[i].get<float>());
  if (good) return;
  if (count == 0) throw BrokenField{fmt::format("{}: {} is not a list of finite numbers", object.name, key)};
  throw BrokenField{fmt::format("{}: {} is not {} finite numbers", object.name, key, count)};
}

void checkNodes(const Root& root) {
  const std::size_t nodes = root.size("nodes");
  root.forEach("nodes", "node", [&](const Object& node) {
    node.index("mesh", root.size("meshes"), "meshes");
    node.index("camera", root.size("cameras"), "cameras");
    node.index("skin", root.size("skins"), "skins");
    node.text("name");
    checkIndices(node, "children", nodes);
    checkNumbers(node, "matrix", 16);
    checkNumbers(node, "translation", 3);
    checkNumbers(node, "rotation", 4);
    checkNumbers(node, "scale", 3);
    checkNumbers(node, "weights");
    checkNodeExtensions(node, root);
    checkNodeGrids(node);
  });
  checkForest(root);
  root.forEach("scenes", "scene", [&](const Object& scene) { checkIndices(scene, "nodes", nodes); });
  root.object.index("scene", root.size("scenes"), "scenes");
  root.forEach("animations", "animation", [&](const Object& animation) { checkAnimation(animation, root); });
  root.forEach("skins", "skin", [&](const Object& skin) { checkSkin(skin, root); });
}

}  // namespace lambent::baker
