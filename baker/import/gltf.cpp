#include "baker/import/gltf.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "baker/import/check.hpp"
#include "baker/import/convert.hpp"
#include "baker/import/details.hpp"
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

bool isOpaque(const Scene& scene, const SceneMesh& mesh) {
  return std::ranges::all_of(mesh.primitives, [&](const ScenePrimitive& primitive) {
    return primitive.material < 0 ||
           scene.materials[static_cast<std::size_t>(primitive.material)].alpha_mode ==
               gltf::AlphaMode::Opaque;
  });
}

bool namesSky(std::string name) {
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
  return name.find("sky") != std::string::npos || name.find("dome") != std::string::npos ||
         name.find("hdri") != std::string::npos;
}

// Returns whether a ray from the origin meets the triangle.
bool hits(const std::array<glm::dvec3, 3>& t, const glm::dvec3& dir) {
  const auto& [a, b, c] = t;
  const double u = glm::dot(dir, glm::cross(a, b)), v = glm::dot(dir, glm::cross(b, c)),
               w = glm::dot(dir, glm::cross(c, a));
  if (!((u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0))) return false;
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  return glm::dot(normal, a) * glm::dot(normal, dir) > 0.0;
}

// Returns whether the mesh hides the whole sky above a point.
bool hidesTheSky(const SceneMesh& mesh, const glm::dmat4& world_from_mesh, const glm::dvec3& from) {
  constexpr int kDirections = 200;
  constexpr double kLowest = 0.03;  // sine of the lowest elevation
  std::array<bool, kDirections> hidden{};
  std::array<glm::dvec3, kDirections> directions;
  for (int i = 0; i < kDirections; ++i) {  // on a spiral of equal areas
    const double y = kLowest + (1.0 - kLowest) * (i + 0.5) / kDirections, r = std::sqrt(1.0 - y * y),
                 turn = i * std::numbers::pi * (3.0 - std::sqrt(5.0));
    directions[static_cast<std::size_t>(i)] = {r * std::cos(turn), y, r * std::sin(turn)};
  }
  for (const ScenePrimitive& primitive : mesh.primitives)
    for (std::size_t i = 0; i + 2 < primitive.mesh.indices.size(); i += 3) {
      std::array<glm::dvec3, 3> triangle;
      for (std::size_t c = 0; c < 3; ++c)
        triangle[c] = glm::dvec3(world_from_mesh *
                                 glm::dvec4(primitive.mesh.positions[primitive.mesh.indices[i + c]], 1.0)) -
                      from;
      for (std::size_t d = 0; d < kDirections; ++d) hidden[d] = hidden[d] || hits(triangle, directions[d]);
    }
  return std::ranges::all_of(hidden, [](bool h) { return h; });
}

// Warns about a body around all others that keeps light from outside away. Exporters leave sky domes in a
// scene, since viewers without light from outside need them as a backdrop.
void warnAboutDomes(Scene& scene) {
  constexpr double kLeastShare = 0.25;  // of the scene's size; the ground may be larger than the dome
  const std::vector<glm::mat4> world = gltf::worldTransforms(scene.nodes);
  std::vector<PlacedBox> boxes(scene.nodes.size());
  const auto around = [&](std::size_t but) {
    PlacedBox all;
    for (std::size_t n = 0; n < boxes.size(); ++n)
      if (n != but && !boxes[n].empty()) all.add(boxes[n].low), all.add(boxes[n].high);
    return all;
  };
  for (std::size_t n = 0; n < scene.nodes.size(); ++n)
    if (const std::int32_t mesh = scene.nodes[n].mesh; mesh >= 0)
      boxes[n].add(boxOf(scene.meshes[static_cast<std::size_t>(mesh)]), glm::dmat4(world[n]));
  const double size = around(boxes.size()).diagonal();
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    const gltf::Node& node = scene.nodes[n];
    if (node.mesh < 0 || boxes[n].diagonal() < kLeastShare * size) continue;
    const SceneMesh& mesh = scene.meshes[static_cast<std::size_t>(node.mesh)];
    if (!isOpaque(scene, mesh) || !(namesSky(node.name) || namesSky(mesh.name))) continue;
    const PlacedBox rest = around(n);
    const glm::dvec3 middle = rest.center();
    if (!(rest.diagonal() > 0.0) || !boxes[n].contains(middle) ||
        !hidesTheSky(mesh, glm::dmat4(world[n]), middle))
      continue;
    scene.warnings.push_back(fmt::format(
        "node {} (\"{}\"): it lies around the scene and keeps all light from outside away; if it is a "
        "sky dome, delete it, and give its picture as --light",
        n, node.name));
    return;
  }
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
