// Writes bundles with grids around bodies as the baker would, with known answers: the test says what a body
// changes, receivers are meshes with unoccluded transfer, and each body and receiver is a rigid group of its
// own.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

#include "runtime/bundle/brdf_table.hpp"
#include "runtime/bundle/description.hpp"
#include "runtime/bundle/mesh.hpp"

namespace lambent::testing {

// Returns the change of visibility V - 1 at a point in the body's frame, as SH coefficients in this many
// bands.
using ChangeAt = std::function<std::vector<float>(int bands, const glm::vec3& point)>;
// Returns the change by a black sphere about the origin. Points nearer than 1.05 radii are treated as if at
// 1.05 radii.
ChangeAt blackSphere(float radius);

struct BuiltBody {
  std::string name = "body";
  ChangeAt change;
  glm::uvec3 size{17};
  glm::vec3 half{4.0f};  // half size of the grid's box, about the origin
  std::uint32_t outputs = 9;
  float sphere_radius = 0.0f;  // if positive, captures see a black sphere of this radius
  glm::vec3 place{0.0f};
  glm::quat turn{1.0f, 0.0f, 0.0f, 0.0f};
  bool volume = false;  // adds an empty volume, within group `within`
  std::int32_t within = -1;
};

struct BuiltReceiver {
  std::string name = "receiver";
  bundle::MeshData mesh;
  glm::mat4 group_from_mesh{1.0f};
  std::uint32_t outputs = 1;  // 1, 9 or, with a table, 25
  // If positive, the transfer of plain receivers has a full block of three channels: this factor times the
  // unoccluded shadowed block.
  glm::vec3 full{0.0f};
  gltf::Material material{};
  glm::vec3 place{0.0f};
  glm::quat turn{1.0f, 0.0f, 0.0f, 0.0f};
};

struct NeighborhoodScene {
  std::uint32_t order = 5;
  std::vector<BuiltReceiver> receivers;  // these are the first groups
  std::vector<BuiltBody> bodies;
  std::optional<bundle::BrdfTable> table;  // a GGX table for glossy receivers

  // Writes the bundle; a failure fails the test.
  void write(const std::filesystem::path& path) const;
};

// Makes a floor from (-half, 0, -half) to (half, 0, half), facing +Y, of cells x cells quads.
bundle::MeshData floorMesh(float half, int cells);

}  // namespace lambent::testing
