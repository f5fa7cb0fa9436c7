#include <algorithm>
#include <charconv>
#include <cmath>
#include <type_traits>

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

constexpr double kLargestNumber = 1e12, kSmallestNumber = 1e-12;

// Reads a number, or three of them, if they are there. Errors name `object`: they are not within the limits.
template <typename T>
void readWithin(const json& source, const char* key, double least, double most, const std::string& object,
                T& field) {
  const json& value = memberOf(source, {key});
  if (value.is_null()) return;
  constexpr bool kList = requires {
    T::length();
  };
  const auto good = [&](const json& number) {
    const bool kind = std::is_same_v<T, glm::uvec3> ? number.is_number_unsigned() : number.is_number();
    return kind && number.get<double>() >= least && number.get<double>() <= most;
  };
  if (kList ? !value.is_array() || value.size() != 3 || !std::ranges::all_of(value, good) : !good(value))
    throw Error{{},
                fmt::format("{}: {} is {}, not {} between {} and {}", object, key, value.dump(),
                            kList ? "three numbers" : "a number", least, most),
                "correct it"};
  readMember(source, key, field);
}

std::string textOf(const json& source, const char* key, const std::string& object) {
  const json& value = memberOf(source, {key});
  if (!value.is_null() && !value.is_string()) refuse("{}: {} is not a string", object, key);
  return value.is_null() ? std::string() : value.get<std::string>();
}

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
  if (!source.is_object()) refuse("{} is not an object", object);
  const std::string uri = textOf(source, "file", object), name = textOf(source, "grid", object);
  if (uri.empty()) throw Error{{}, object + " names no file", "name a .vdb or .nrrd file beside the scene"};
  SceneVolume volume;
  volume.node = node;
  float scale = 1.0f;
  glm::dvec3 size(0.0);
  readWithin(source, "density_scale", 0.0, kLargestNumber, object, scale);
  readWithin(source, "albedo", 0.0, 1.0, object, volume.albedo);
  readWithin(source, "g", -0.99, 0.99, object, volume.g);
  readWithin(source, "size", kSmallestNumber, kLargestNumber, object, size);

  DensityGrid densities = readGrid(document, uri, name, object, scene.warnings);
  const std::string file = uri.substr(0, 80);
  volume.name = densities.name.empty() ? file : fmt::format("{}: {}", file, densities.name);
  volume.size = densities.size;
  volume.density = std::move(densities.values);
  if (const std::size_t bad = scaleDensities(volume.density, scale); bad > 0)
    scene.warnings.push_back(
        fmt::format("{}: {} of {} densities are negative or not finite and are taken as 0", object, bad,
                    volume.density.size()));
  volume.node_from_grid =
      glm::mat4(size == glm::dvec3(0.0) ? densities.file_from_grid
                                        : glm::scale(glm::translate(glm::dmat4(1.0), -0.5 * size),
                                                     size / glm::dvec3(volume.size)));
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
      const std::string object = fmt::format("node {}: its neighborhood", map.file_node[node]);
      if (!request->is_object()) refuse("{} is not an object", object);
      NeighborhoodRequest& added = scene.neighborhoods.emplace_back();
      added.node = number;
      readWithin(*request, "size", 2, 256, object, added.size);
      readWithin(*request, "extent", kSmallestNumber, kLargestNumber, object, added.extent);
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
