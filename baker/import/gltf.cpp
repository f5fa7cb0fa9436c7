#include "baker/import/gltf.hpp"

#include <algorithm>
#include <exception>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "baker/import/check.hpp"
#include "baker/import/convert.hpp"
#include "baker/import/document.hpp"
#include "baker/import/tinygltf.hpp"

namespace lambent::baker {
namespace {

void warnAboutExtensions(const Document& document, Scene& scene) {
  const auto& used = document.model().extensionsUsed;
  for (const std::string& name : std::set<std::string>(used.begin(), used.end()))
    if (std::find(kExtensions.begin(), kExtensions.end(), name) == kExtensions.end())
      scene.warnings.push_back(fmt::format("the extension {} is not read", name));
}

// Warnings alike but for the primitive become one.
void foldWarnings(std::vector<std::string>& warnings) {
  std::vector<std::string> kept;
  std::map<std::string, std::pair<std::size_t, std::size_t>>
      seen;  // what -> its place in `kept`, how many more
  for (std::string& warning : warnings) {
    const auto [entry, added] = seen.try_emplace(warning.substr(warning.find(": ") + 1), kept.size(), 0);
    if (added) {
      kept.push_back(std::move(warning));
    } else {
      ++entry->second.second;
    }
  }
  for (const auto& [what, place] : seen)
    if (place.second > 0) kept[place.first] += fmt::format(" (and {} more like it)", place.second);
  warnings = std::move(kept);
}

// Meshes that no node of the scene draws are left out, and those of which nothing is left.
void dropUnusedMeshes(Scene& scene) {
  std::vector<std::int32_t> number(scene.meshes.size(), -1);
  std::vector<SceneMesh> kept;
  for (gltf::Node& node : scene.nodes) {
    if (node.mesh < 0) continue;
    const auto mesh = static_cast<std::size_t>(node.mesh);
    if (number[mesh] < 0 && !scene.meshes[mesh].primitives.empty()) {
      number[mesh] = static_cast<std::int32_t>(kept.size());
      kept.push_back(std::move(scene.meshes[mesh]));
      scene.meshes[mesh].primitives.clear();
    }
    node.mesh = number[mesh];
  }
  scene.meshes = std::move(kept);
}

Result<Scene> convert(const Document& document) {
  Scene scene;
  scene.source = document.path();
  warnAboutExtensions(document, scene);
  // materials, with the textures and images that they use
  auto transforms = convertMaterials(document, scene);
  if (!transforms) return failAgain(std::move(transforms.error()));
  // geometry, brought to clean triangles
  if (auto meshes = convertMeshes(document, *transforms, scene); !meshes)
    return failAgain(std::move(meshes.error()));
  // the tree of the default scene
  if (auto nodes = convertNodes(document, scene); !nodes) return failAgain(std::move(nodes.error()));
  dropUnusedMeshes(scene);
  foldWarnings(scene.warnings);
  if (scene.meshes.empty()) return fail(document.file(), "has no triangles in its scene", "give it a mesh");
  return scene;
}

}  // namespace

Result<Scene> importScene(const std::filesystem::path& path) {
  auto document = Document::open(path);
  if (!document) return failAgain(std::move(document.error()));
  try {
    return convert(*document);
  } catch (const std::exception& exception) {
    return fail(path.string(), fmt::format("cannot be imported ({})", exception.what()),
                "export the scene again");
  }
}

}  // namespace lambent::baker
