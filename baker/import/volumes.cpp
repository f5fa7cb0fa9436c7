#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>
#include <nlohmann/json.hpp>

#include "baker/import/check.hpp"
#include "baker/import/convert.hpp"
#include "baker/import/density_file.hpp"
#include "baker/import/scene_files.hpp"

namespace lambent::baker {
namespace {

using nlohmann::json;

// Makes a grid from words such as "procedural:cloud,7".
DensityGrid procedural(const std::string& words, const std::string& subject) {
  constexpr std::string_view kCloud = "procedural:cloud,";
  std::uint32_t seed = 0;
  const char* const end = words.data() + words.size();
  if (!words.starts_with(kCloud) || std::from_chars(words.data() + kCloud.size(), end, seed).ptr != end ||
      words.size() == kCloud.size())
    throw Error{subject, fmt::format("\"{}\" is not known", words.substr(0, 80)),
                "use procedural:cloud,SEED with a whole number from 0 up"};
  return proceduralCloud(seed);
}

DensityGrid readGrid(const Document& document, const std::string& uri, const std::string& grid,
                     const std::string& object, std::vector<std::string>& warnings) {
  const std::string subject = fmt::format("{}: {}", document.file(), object);
  if (uri.starts_with("procedural:")) return procedural(uri, subject);
  const auto file = resolveUri(document.path, uri, document.options, object, warnings);
  const std::string kind = file.extension().string(), name = file.filename().string();
  if (kind != ".vdb" && kind != ".nrrd")
    throw Error{subject, fmt::format("\"{}\" is neither .vdb nor .nrrd", name),
                "save the densities as one of them"};
  auto densities = kind == ".vdb" ? readVdb(file, grid) : readNrrd(file);
  if (!densities) densities.error().subject = fmt::format("{} ({})", subject, densities.error().subject);
  return orThrow(std::move(densities));
}

// Makes densities finite and not negative, in m^-1. Returns how many were not.
std::size_t scaleDensities(std::vector<float>& values, float scale) {
  constexpr float kLargest = 1e12f;  // m^-1: no light passes, and no product overflows
  std::size_t bad = 0;
  for (float& value : values) {
    if (std::isfinite(value) && value >= 0.0f) {
      value = std::min(value * scale, kLargest);
    } else {
      value = 0.0f;
      ++bad;
    }
  }
  return bad;
}

void addVolume(const Document& document, const json& source, std::uint32_t node, const std::string& object,
               Scene& scene) {
  const auto uri = source["file"].get<std::string>();
  DensityGrid densities = readGrid(document, uri, source.value("grid", ""), object, scene.warnings);

  SceneVolume volume;
  const std::string file = uri.substr(0, 80);
  volume.name = densities.name.empty() ? file : fmt::format("{}: {}", file, densities.name);
  volume.node = node;
  volume.size = densities.size;
  volume.density = std::move(densities.values);
  if (const std::size_t bad = scaleDensities(volume.density, source.value("density_scale", 1.0f)); bad > 0)
    scene.warnings.push_back(
        fmt::format("{}: {} of {} densities are negative or not finite and are taken as 0", object, bad,
                    volume.density.size()));
  glm::dmat4 node_from_grid = densities.file_from_grid;
  if (glm::dvec3 size(0.0); source.contains("size")) {
    readMember(source, "size", size);
    node_from_grid = glm::scale(glm::translate(glm::dmat4(1.0), -0.5 * size), size / glm::dvec3(volume.size));
  }
  volume.node_from_grid = glm::mat4(node_from_grid);
  readMember(source, "albedo", volume.albedo);
  readMember(source, "g", volume.g);
  scene.volumes.push_back(std::move(volume));
}

}  // namespace

void convertGrids(const Document& document, const NodeMap& map, Scene& scene) {
  const auto world = gltf::worldTransforms(scene.nodes);
  for (std::size_t node = 0; node < map.file_node.size(); ++node) {
    if (map.file_node[node] < 0) continue;
    const json& ours =
        memberOf(document.at("nodes", static_cast<std::size_t>(map.file_node[node])), {"extras", "lambent"});
    if (!ours.is_object()) continue;
    const auto number = static_cast<std::uint32_t>(node);
    if (const auto request = ours.find("neighborhood"); request != ours.end()) {
      NeighborhoodRequest& added = scene.neighborhoods.emplace_back();
      added.node = number;
      readMember(*request, "size", added.size);
      readMember(*request, "extent", added.extent);
    }
    const auto volume = ours.find("volume");
    if (volume == ours.end()) continue;
    const std::string object = fmt::format("node {}: its volume", map.file_node[node]);
    addVolume(document, *volume, number, object, scene);
    // A flat box holds no medium.
    const glm::dmat3 axes(glm::dmat4(world[node]) * glm::dmat4(scene.volumes.back().node_from_grid));
    const double inside = std::abs(glm::determinant(axes));
    if (inside > 0.0 && std::isfinite(inside)) continue;
    scene.warnings.push_back(object + " is flat as it stands in the scene and is left out");
    scene.volumes.pop_back();
  }
}

}  // namespace lambent::baker
