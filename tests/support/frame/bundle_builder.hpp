// Writes small bundles with known answers to a file as the baker would: each mesh with unoccluded transfer at
// its vertices, or with transfer that the test sets, in one group and one cell.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <glm/mat4x4.hpp>

#include "runtime/bundle/brdf_table.hpp"
#include "runtime/bundle/container.hpp"
#include "runtime/bundle/description.hpp"
#include "runtime/bundle/mesh.hpp"
#include "runtime/spec/light.hpp"
#include "tests/support/built_volume.hpp"

namespace lambent::testing {

inline const spec::Light kWhite = spec::ConstantLight{.radiance = glm::vec3(1.0f)};

inline gltf::Material colored(const glm::vec4& color) {
  gltf::Material material;
  material.base_color = color;
  return material;
}

// Returns the transfer vector of a sample with this normal, in the group's frame: order² entries, with
// bounces twice as many (the shadowed block, then the full one), for normal maps nine times as many, by
// output.
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
  BundleBuilder& bounces();
  BundleBuilder& normalMapped();
  // Makes all surfaces glossy, with this many bands of transferred light and this table. Transfer is then
  // visibility in order + bands - 1 bands, unoccluded unless a later transfer() sets it.
  BundleBuilder& glossy(std::uint32_t bands, bundle::BrdfFamily family, bundle::BrdfTable table);
  // Gives the bundle this GGX table beside diffuse or normal-mapped transfer, so that materials that are not
  // diffuse have a specular layer.
  BundleBuilder& layered(bundle::BrdfTable table);
  // Adds a light of the group that gives `transfer` times its radiance to every sample. Bundles with normal
  // maps are not supported.
  BundleBuilder& lamp(const bundle::GroupLight& light, float transfer);
  // Says how much samples matter to pictures, from their normals in the group frame (description.hpp).
  BundleBuilder& importance(std::function<float(const glm::vec3&)> relative);
  BundleBuilder& groupRotation(const glm::quat& rest_rotation);
  // Adds a volume in a group of its own, after the meshes' group if there are meshes.
  BundleBuilder& volume(BuiltVolume volume);
  // Returns the texture's index.
  std::int32_t addTexture(std::uint32_t width, std::uint32_t height, const std::vector<std::uint8_t>& rgba,
                          const gltf::Sampler& sampler);
  // Writes the bundle; a failure fails the test.
  void write(const std::filesystem::path& path) const;

 private:
  struct BuiltLamp {
    bundle::GroupLight light;
    float transfer = 0.0f;
  };
  int order_;
  bool bounces_ = false, normal_mapped_ = false, layered_ = false;
  std::uint32_t outputs() const {
    return glossy_bands_ > 0 ? glossy_bands_ * glossy_bands_ : normal_mapped_ ? 9u : 1u;
  }
  std::uint32_t glossy_bands_ = 0;  // 0: not glossy
  bundle::BrdfFamily family_ = bundle::BrdfFamily::Ggx;
  bundle::BrdfTable table_;
  std::vector<BuiltLamp> lamps_;
  TransferOf transfer_;
  std::function<float(const glm::vec3&)> importance_;
  glm::quat rest_rotation_{1.0f, 0.0f, 0.0f, 0.0f};
  std::vector<BuiltMesh> meshes_;
  std::vector<BuiltVolume> volumes_;
  std::vector<bundle::Blob> images_;
  std::vector<gltf::Texture> textures_;
};

// Makes a sphere of radius 1 about the origin.
bundle::MeshData sphereMesh(int rings, int segments);
// Makes a square from (-1, -1, 0) to (1, 1, 0), facing +Z, with texture coordinates as in glTF: (0, 0) at the
// top left.
bundle::MeshData quadMesh();

}  // namespace lambent::testing
