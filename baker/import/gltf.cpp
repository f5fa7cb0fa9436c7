#include "baker/import/gltf.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "baker/import/check.hpp"
#include "baker/import/convert.hpp"
#include "baker/import/document.hpp"
#include "baker/import/openimageio/module.hpp"
#include "baker/import/scene_files.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::baker {
namespace {

std::set<std::string> extensionsOf(const Document& document) {
  std::set<std::string> names;
  for (const char* list : {"extensionsUsed", "extensionsRequired"})
    for (const nlohmann::json& name : document.list(list))
      if (name.is_string()) names.insert(name.get<std::string>());
  return names;
}

void warnAboutExtensions(const std::set<std::string>& names, Scene& scene) {
  std::string looks;
  for (const std::string& name : names) {
    if (readsExtension(name)) continue;
    if (name.starts_with("KHR_materials_"))
      looks += (looks.empty() ? "" : ", ") + name;
    else
      scene.warnings.push_back(fmt::format("the extension {} is not read", name));
  }
  if (!looks.empty())
    scene.warnings.push_back(fmt::format("what materials look like by {} is left out", looks));
}

// Merges warnings that differ only in the primitive.
void foldWarnings(std::vector<std::string>& warnings) {
  std::vector<std::string> kept;
  // Maps a message to its place in `kept` and to how many more there are.
  std::map<std::string, std::pair<std::size_t, std::size_t>> seen;
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

Scene convert(const Document& document) {
  Scene scene;
  scene.source = document.path;
  const std::set<std::string> extensions = extensionsOf(document);
  if (extensions.contains(std::string(bundle::kExtensionName)))
    throw Error{{}, "is a bundle, which was baked already", "name the scene that it was made of"};
  scene.warnings = document.warnings;
  warnAboutExtensions(extensions, scene);
  convertMaterials(document, scene);
  convertLights(document, scene);
  NodeMap map = convertNodes(document, scene);
  convertMeshes(document, map, scene);
  convertAnimations(document, map, scene);
  convertInstances(document, map, scene);
  convertGrids(document, map, scene);
  placeNearOrigin(std::move(map), scene);
  warnAboutDomes(scene);
  foldWarnings(scene.warnings);
  if (scene.meshes.empty() && scene.volumes.empty())
    throw Error{{}, "has no triangles in its scene that have an area", "give it a mesh"};
  // The module that decodes images takes half a second to load. It is loaded here because the import counts
  // in no estimate of a bake. If it cannot be loaded, the first image says so.
  if (!scene.images.empty()) static_cast<void>(openImageIo());
  return scene;
}

}  // namespace

Result<Scene> importScene(const std::filesystem::path& path, const ImportOptions& options) {
  return resultOf(path.string(), "imported", kExportAgain, [&] { return convert(Document(path, options)); });
}

}  // namespace lambent::baker
