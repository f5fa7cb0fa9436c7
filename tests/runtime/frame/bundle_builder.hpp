// Small bundles with known answers, written to a file as the baker would: each mesh with open (unoccluded)
// transfer at its vertices, or with transfer that the test sets, one group, one cell.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <glm/mat4x4.hpp>

#include "runtime/bundle/description.hpp"
#include "runtime/bundle/mesh.hpp"
#include "runtime/bundle/writer.hpp"

namespace lambent::testing {

// Transfer vector (order² entries) of a sample with this normal, group frame.
using TransferOf = std::function<std::vector<float>(const glm::vec3& normal)>;
TransferOf openTransfer(int order);

struct BuiltMesh {
  bundle::MeshData data;
  gltf::Material material;
  glm::mat4 world_from_mesh{1.0f};
};

class BundleBuilder {
 public:
  explicit BundleBuilder(int order = 3) : order_(order), transfer_(openTransfer(order)) {}

  BundleBuilder& add(BuiltMesh mesh);
  BundleBuilder& transfer(TransferOf transfer);
  BundleBuilder& groupRotation(const glm::quat& rest_rotation);
  // Returns the texture's index.
  std::int32_t addTexture(std::uint32_t width, std::uint32_t height, const std::vector<std::uint8_t>& rgba,
                          const gltf::Sampler& sampler);
  // Writes the bundle; a failure fails the test.
  void write(const std::filesystem::path& path) const;

 private:
  int order_;
  TransferOf transfer_;
  glm::quat rest_rotation_{1.0f, 0.0f, 0.0f, 0.0f};
  std::vector<BuiltMesh> meshes_;
  std::vector<bundle::Blob> images_;
  std::vector<gltf::Texture> textures_;
};

// Radius 1 about the origin.
bundle::MeshData sphereMesh(int rings, int segments);
// From (-1, -1, 0) to (1, 1, 0), facing +Z, texture coordinates as glTF has them: (0, 0) at the top left.
bundle::MeshData quadMesh();

}  // namespace lambent::testing
