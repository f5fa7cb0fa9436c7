// Bundles with grids around bodies, written as the baker would, with answers that are known: what a body
// changes is said by the test, receivers are meshes with open transfer, each body and each receiver a rigid
// group of its own.
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

// A visibility change V - 1 at a point of the body's frame, as coefficients in so many bands.
using ChangeAt = std::function<std::vector<float>(int bands, const glm::vec3& point)>;
// Of a black sphere about the origin; points nearer than 1.05 radii count as that far.
ChangeAt blackSphere(float radius);

struct BuiltBody {
  std::string name = "body";
  ChangeAt change;
  glm::uvec3 size{17};
  glm::vec3 half{4.0f};  // of the grid's box, about the origin
  std::uint32_t outputs = 9;
  float sphere_radius = 0.0f;  // over 0: captures see this black sphere
  glm::vec3 place{0.0f};
  glm::quat turn{1.0f, 0.0f, 0.0f, 0.0f};
  bool volume = false;  // with a volume, empty, within group `within`
  std::int32_t within = -1;
};

struct BuiltReceiver {
  std::string name = "receiver";
  bundle::MeshData mesh;
  glm::mat4 group_from_mesh{1.0f};
  std::uint32_t outputs = 1;  // 1, 9 or, with a table, 25
  // Over 0, of plain ones: transfer has a full block of three channels, so many times the open shadowed one.
  glm::vec3 full{0.0f};
  gltf::Material material{};
  glm::vec3 place{0.0f};
  glm::quat turn{1.0f, 0.0f, 0.0f, 0.0f};
};

struct NeighborhoodScene {
  std::uint32_t order = 5;
  std::vector<BuiltReceiver> receivers;  // the first groups
  std::vector<BuiltBody> bodies;
  std::optional<bundle::BrdfTable> table;  // GGX, of glossy receivers

  // A failure fails the test.
  void write(const std::filesystem::path& path) const;
};

// (-half, 0, -half) to (half, 0, half), facing +Y, in cells x cells quads.
bundle::MeshData floorMesh(float half, int cells);

}  // namespace lambent::testing
