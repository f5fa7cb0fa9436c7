#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>

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

template <typename Vector>
std::optional<Vector> vectorField(const json& object, const char* key) {
  if (!object.contains(key)) return std::nullopt;
  Vector vector;
  for (int i = 0; i < 3; ++i)
    vector[i] = object[key][static_cast<std::size_t>(i)].get<typename Vector::value_type>();
  return vector;
}

// Makes a grid from words such as "procedural:cloud,7".
Result<DensityGrid> procedural(const std::string& words, const std::string& subject) {
  constexpr std::string_view kCloud = "procedural:cloud,";
  std::uint32_t seed = 0;
  const char* const end = words.data() + words.size();
  if (!words.starts_with(kCloud) || std::from_chars(words.data() + kCloud.size(), end, seed).ptr != end ||
      words.size() == kCloud.size())
    return fail(subject, fmt::format("\"{}\" is not known", words.substr(0, 80)),
                "use procedural:cloud,SEED with a whole number from 0 up");
  return proceduralCloud(seed);
}

Result<DensityGrid> readGrid(const Document& document, const std::string& uri, const std::string& grid,
                             const std::string& object, std::vector<std::string>& warnings) {
  const std::string subject = fmt::format("{}: {}", document.file(), object);
  if (uri.starts_with("procedural:")) return procedural(uri, subject);
  const auto file = resolveUri(document.path, uri, document.options, object, warnings);
  if (!file) return failAgain(file.error());
  const std::string kind = file->extension().string();
  if (kind != ".vdb" && kind != ".nrrd")
    return fail(subject, fmt::format("\"{}\" is neither .vdb nor .nrrd", file->filename().string()),
                "save the densities as one of them");
  // Folders and missing files are caught before a library sees the name, so that they get a clear error.
  std::error_code error;
  if (!std::filesystem::is_regular_file(*file, error))
    return fail(subject, fmt::format("\"{}\" is not a file", file->filename().string()),
                "put it beside the scene");
  auto densities = kind == ".vdb" ? readVdb(*file, grid) : readNrrd(*file);
  if (!densities) densities.error().subject = fmt::format("{} ({})", subject, densities.error().subject);
  return densities;
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

Result<void> addVolume(const Document& document, const json& source, std::uint32_t node,
                       const std::string& object, Scene& scene) {
  const auto uri = source["file"].get<std::string>();
  auto densities = readGrid(document, uri, source.value("grid", ""), object, scene.warnings);
  if (!densities) return failAgain(std::move(densities.error()));

  SceneVolume volume;
  const std::string file = uri.substr(0, 80);
  volume.name = densities->name.empty() ? file : fmt::format("{}: {}", file, densities->name);
  volume.node = node;
  volume.size = densities->size;
  volume.density = std::move(densities->values);
  if (const std::size_t bad = scaleDensities(volume.density, source.value("density_scale", 1.0f)); bad > 0)
    scene.warnings.push_back(
        fmt::format("{}: {} of {} densities are negative or not finite and are taken as 0", object, bad,
                    volume.density.size()));
  glm::dmat4 node_from_grid = densities->file_from_grid;
  if (const auto size = vectorField<glm::dvec3>(source, "size"))
    node_from_grid =
        glm::scale(glm::translate(glm::dmat4(1.0), -0.5 * *size), *size / glm::dvec3(volume.size));
  volume.node_from_grid = glm::mat4(node_from_grid);
  volume.albedo = vectorField<glm::vec3>(source, "albedo").value_or(glm::vec3(1.0f));
  volume.g = source.value("g", 0.0f);
  scene.volumes.push_back(std::move(volume));
  return {};
}

}  // namespace

Result<void> convertGrids(const Document& document, const NodeMap& map, Scene& scene) {
  const auto world = gltf::worldTransforms(scene.nodes);
  for (std::size_t node = 0; node < map.file_node.size(); ++node) {
    if (map.file_node[node] < 0) continue;
    const json& ours =
        memberOf(document.at("nodes", static_cast<std::size_t>(map.file_node[node])), {"extras", "lambent"});
    if (!ours.is_object()) continue;
    const auto number = static_cast<std::uint32_t>(node);
    if (const auto request = ours.find("neighborhood"); request != ours.end())
      scene.neighborhoods.push_back(
          {.node = number,
           .size = vectorField<glm::uvec3>(*request, "size").value_or(glm::uvec3(0)),
           .extent = vectorField<glm::vec3>(*request, "extent").value_or(glm::vec3(0.0f))});
    const auto volume = ours.find("volume");
    if (volume == ours.end()) continue;
    const std::string object = fmt::format("node {}: its volume", map.file_node[node]);
    if (auto added = addVolume(document, *volume, number, object, scene); !added) return added;
    // A flat box holds no medium.
    const glm::dmat3 axes(glm::dmat4(world[node]) * glm::dmat4(scene.volumes.back().node_from_grid));
    const double inside = std::abs(glm::determinant(axes));
    if (inside > 0.0 && std::isfinite(inside)) continue;
    scene.warnings.push_back(object + " is flat as it stands in the scene and is left out");
    scene.volumes.pop_back();
  }
  return {};
}

}  // namespace lambent::baker
