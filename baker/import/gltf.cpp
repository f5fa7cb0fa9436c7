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
  std::string looks;
  for (const std::string& name : std::set<std::string>(used.begin(), used.end())) {
    if (std::find(kExtensions.begin(), kExtensions.end(), name) != kExtensions.end()) continue;
    if (name.starts_with("KHR_materials_"))
      looks += (looks.empty() ? "" : ", ") + name;
    else
      scene.warnings.push_back(fmt::format("the extension {} is not read", name));
  }
  if (!looks.empty())
    scene.warnings.push_back(fmt::format("what materials look like by {} is left out", looks));
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

Result<Scene> convert(const Document& document) {
  Scene scene;
  scene.source = document.path();
  warnAboutExtensions(document, scene);
  // materials, with the textures and images that they use
  if (auto materials = convertMaterials(document, scene); !materials)
    return failAgain(std::move(materials.error()));
  convertLights(document, scene);
  // the tree of the default scene
  auto map = convertNodes(document, scene);
  if (!map) return failAgain(std::move(map.error()));
  // its geometry at rest, brought to clean triangles
  if (auto meshes = convertMeshes(document, *map, scene); !meshes)
    return failAgain(std::move(meshes.error()));
  // what moves in it
  if (auto animations = convertAnimations(document, *map, scene); !animations)
    return failAgain(std::move(animations.error()));
  // and what it holds many times
  if (auto instances = convertInstances(document, *map, scene); !instances)
    return failAgain(std::move(instances.error()));
  // clouds, and grids around bodies
  if (auto grids = convertGrids(document, *map, scene); !grids) return failAgain(std::move(grids.error()));
  foldWarnings(scene.warnings);
  if (scene.meshes.empty() && scene.volumes.empty())
    return fail(document.file(), "has no triangles in its scene", "give it a mesh");
  return scene;
}

}  // namespace

Result<Scene> importScene(const std::filesystem::path& path, const ImportOptions& options) {
  auto document = Document::open(path, options);
  if (!document) return failAgain(std::move(document.error()));
  try {
    return convert(*document);
  } catch (const std::exception& exception) {
    return fail(path.string(), fmt::format("cannot be imported ({})", exception.what()),
                "export the scene again");
  }
}

}  // namespace lambent::baker
