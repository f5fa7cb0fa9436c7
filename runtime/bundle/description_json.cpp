#include "runtime/bundle/description_json.hpp"

#include <cmath>

#include <fmt/format.h>
#include <glm/matrix.hpp>

#include "runtime/base/payload_bytes.hpp"
#include "runtime/bundle/gltf_parts.hpp"
#include "runtime/bundle/json_fields.hpp"

namespace lambent::bundle {

std::string toJson(const Description& description, std::uint64_t binary_bytes) {
  Json document;
  writeGltf(description, binary_bytes, document);
  document["extensions"][std::string(kExtensionName)] = writeTransfer(description);
  return document.dump();
}

Result<Description> fromJson(const std::string& text, std::uint64_t binary_bytes, const std::string& file) {
  const std::string name(kExtensionName);
  try {
    const Json document = Json::parse(text);
    const Field root(document, "");
    if (!root.has("extensions") || !root["extensions"].has(name.c_str()))
      return fail(file, "is a glTF file without baked transfer", "bake it with `lambent bake`");
    const Field extension = root["extensions"][name.c_str()];
    const std::uint64_t version = extension["version"].count(0xffffffffu);
    if (version > kVersionCurrent)
      return fail(
          file, fmt::format("has format version {}, newer than this program's {}", version, kVersionCurrent),
          "use a newer lambent or bake it again");
    if (version >= kVersionFirstLight && version < kVersionVolumesAndNeighborhoods)
      return fail(file,
                  fmt::format("was written by an older program (format version {}, this one reads {})",
                              version, kVersionCurrent),
                  "bake it again");
    if (version < kVersionFirstLight)
      return fail(file, fmt::format("has the unknown format version {}", version), "bake it again");
    Description description;
    readGltf(root, binary_bytes, description);
    readTransfer(extension, description);
    return description;
  } catch (const JsonFault& fault) {
    return fail(file, fmt::format("is damaged: {}", fault.what()), "bake it again");
  } catch (const Json::exception&) {
    return fail(file, "is damaged: its JSON cannot be read", kCopyAgain);
  }
}

namespace {

constexpr std::uint32_t kMaxVolumeSide = 2048, kMaxTransferSide = 256;

glm::uvec3 readGridSize(const Field& field, std::uint32_t least, std::uint32_t most) {
  const auto entries = field.items();
  if (entries.size() != 3) field.fault("is not three numbers");
  glm::uvec3 size;
  for (int axis = 0; axis < 3; ++axis) {
    size[axis] = static_cast<std::uint32_t>(entries[static_cast<std::size_t>(axis)].count(most));
    if (size[axis] < least) field.fault(fmt::format("has fewer than {} along an axis", least));
  }
  return size;
}

std::uint64_t countOf(const glm::uvec3& size) {
  return std::uint64_t{size.x} * size.y * size.z;
}

VolumeGrid readVolume(const Field& field, const Description& d, std::uint32_t samples) {
  VolumeGrid volume;
  volume.size = readGridSize(field["size"], 1, kMaxVolumeSide);
  const auto matrix = field["matrix"].items();
  if (matrix.size() != 16) field["matrix"].fault("is not 16 numbers");
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      volume.group_from_grid[column][row] = matrix[static_cast<std::size_t>(4 * column + row)].number();
  if (!(std::abs(glm::determinant(glm::dmat3(glm::mat3(volume.group_from_grid)))) > 0.0))
    field["matrix"].fault("is flat");
  volume.bits = static_cast<std::uint32_t>(field["bits"].count(16));
  if (volume.bits != 8 && volume.bits != 16) field["bits"].fault("is neither 8 nor 16");
  volume.density =
      payloadIndex(field["density"], d, PayloadType::Density, countOf(volume.size) * volume.bits / 8);
  volume.density_max = field["densityMax"].number();
  volume.albedo = field["albedo"].vector<glm::vec3>();
  volume.g = field["g"].number();
  if (!(volume.density_max >= 0.0f)) field["densityMax"].fault("is negative");
  for (int c = 0; c < 3; ++c)
    if (!(volume.albedo[c] >= 0.0f && volume.albedo[c] <= 1.0f))
      field["albedo"].fault("is not between 0 and 1");
  if (!(std::abs(volume.g) < 1.0f)) field["g"].fault("is not between -1 and 1");
  volume.transfer_size = readGridSize(field["transferSize"], 1, kMaxTransferSide);
  volume.voxels = payloadIndex(field["voxels"], d, PayloadType::Voxels, std::uint64_t{4} * samples);
  return volume;
}

NeighborhoodGrid readNeighborhood(const Field& field) {
  NeighborhoodGrid grid;
  grid.size = readGridSize(field["size"], 2, kMaxTransferSide);
  grid.bounds_min = field["boundsMin"].vector<glm::vec3>();
  grid.bounds_max = field["boundsMax"].vector<glm::vec3>();
  for (int axis = 0; axis < 3; ++axis)
    if (!(grid.bounds_min[axis] < grid.bounds_max[axis])) field["boundsMax"].fault("is not beyond boundsMin");
  return grid;
}

}  // namespace

Json volumeJson(const VolumeGrid& volume) {
  Json matrix = Json::array();
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) matrix.push_back(volume.group_from_grid[column][row]);
  return {{"size", vectorJson(volume.size)},
          {"matrix", matrix},
          {"density", volume.density},
          {"bits", volume.bits},
          {"densityMax", volume.density_max},
          {"albedo", vectorJson(volume.albedo)},
          {"g", volume.g},
          {"transferSize", vectorJson(volume.transfer_size)},
          {"voxels", volume.voxels}};
}

Json neighborhoodJson(const NeighborhoodGrid& grid) {
  return {{"size", vectorJson(grid.size)},
          {"boundsMin", vectorJson(grid.bounds_min)},
          {"boundsMax", vectorJson(grid.bounds_max)}};
}

void readGrids(const Field& field, const Description& d, Group& group) {
  const std::uint32_t in_volume = group.samplesOf(transfer::Domain::Voxel);
  if (field.has("volume"))
    group.volume = readVolume(field["volume"], d, in_volume);
  else if (in_volume > 0)
    field["cells"].fault("are of a volume that is not there");
  if (field.has("within")) {
    if (!group.volume) field["within"].fault("is there without a volume");
    group.within = static_cast<std::int32_t>(field["within"].index(d.groups.size()));
  }
  const std::uint32_t around = group.samplesOf(transfer::Domain::GridPoint);
  if (field.has("neighborhood")) group.neighborhood = readNeighborhood(field["neighborhood"]);
  if (around != (group.neighborhood ? countOf(group.neighborhood->size) : 0))
    field["cells"].fault("do not hold the points of the neighborhood");
}

}  // namespace lambent::bundle
