#include "tests/support/frame/bundle_builder.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "baker/compress/draco_encode.hpp"
#include "runtime/base/normal_matrix.hpp"
#include "runtime/bundle/description.hpp"
#include "runtime/sh/zonal.hpp"
#include "runtime/spec/image.hpp"
#include "runtime/transfer/codebook.hpp"
#include "tests/support/frame/bundle_store.hpp"

namespace lambent::testing {

TransferOf openTransfer(int order) {
  return [order](const glm::vec3& normal) {
    std::vector<float> transfer(static_cast<std::size_t>(order * order));
    sh::unoccludedTransfer(order, normal, transfer);
    return transfer;
  };
}

BundleBuilder& BundleBuilder::add(BuiltMesh mesh) {
  meshes_.push_back(std::move(mesh));
  return *this;
}

BundleBuilder& BundleBuilder::transfer(TransferOf transfer) {
  transfer_ = std::move(transfer);
  return *this;
}

BundleBuilder& BundleBuilder::bounces() {
  bounces_ = true;
  return *this;
}

BundleBuilder& BundleBuilder::normalMapped() {
  normal_mapped_ = true;
  return *this;
}

BundleBuilder& BundleBuilder::glossy(std::uint32_t bands, bundle::BrdfFamily family,
                                     bundle::BrdfTable table) {
  glossy_bands_ = bands;
  family_ = family;
  table_ = std::move(table);
  transfer_ = [n = static_cast<std::size_t>(order_) + bands - 1](const glm::vec3&) {
    std::vector<float> open(n * n, 0.0f);
    open[0] = 3.54490770f;  // sqrt(4 pi): visible in all directions
    return open;
  };
  return *this;
}

BundleBuilder& BundleBuilder::lamp(const bundle::GroupLight& light, float transfer) {
  lamps_.push_back({light, transfer});
  return *this;
}

BundleBuilder& BundleBuilder::layered(bundle::BrdfTable table) {
  layered_ = true;
  table_ = std::move(table);
  return *this;
}

BundleBuilder& BundleBuilder::volume(BuiltVolume volume) {
  volumes_.push_back(std::move(volume));
  return *this;
}

BundleBuilder& BundleBuilder::importance(std::function<float(const glm::vec3&)> relative) {
  importance_ = std::move(relative);
  return *this;
}

BundleBuilder& BundleBuilder::groupRotation(const glm::quat& rest_rotation) {
  rest_rotation_ = rest_rotation;
  return *this;
}

std::int32_t BundleBuilder::addTexture(std::uint32_t width, std::uint32_t height,
                                       const std::vector<std::uint8_t>& rgba, const gltf::Sampler& sampler) {
  const std::vector<std::uint8_t> png = spec::encodePng({.width = width, .height = height, .texels = rgba});
  const auto bytes = std::as_bytes(std::span(png));
  images_.emplace_back(bytes.begin(), bytes.end());
  textures_.push_back({.image = static_cast<std::int32_t>(images_.size() - 1), .sampler = sampler});
  return static_cast<std::int32_t>(textures_.size() - 1);
}

void BundleBuilder::write(const std::filesystem::path& path) const {
  bundle::Description description;
  description.generator = {.program = "test", .version = "1", .isa = "any", .settings = {}};
  std::vector<bundle::Blob> blobs;
  Store store{description, blobs};
  bundle::Group group;
  group.name = "group";
  group.rest_rotation = rest_rotation_;
  group.bounds_min = glm::vec3(-10.0f);
  group.bounds_max = glm::vec3(10.0f);
  std::vector<std::vector<float>> vectors;
  bundle::Blob importance;
  for (std::uint32_t i = 0; i < meshes_.size(); ++i) {
    const BuiltMesh& mesh = meshes_[i];
    const Result<baker::EncodedMesh> encoded = baker::encodeDraco(mesh.data, 1.0f / 16384.0f, "test mesh");
    ASSERT_TRUE(encoded) << encoded.error().line();
    const bundle::MeshData& decoded = encoded->decoded;
    bundle::Primitive primitive{.view = store.blob(encoded->bytes),
                                .attributes = encoded->attributes,
                                .material = static_cast<std::int32_t>(i),
                                .vertex_count = static_cast<std::uint32_t>(decoded.positions.size()),
                                .index_count = static_cast<std::uint32_t>(decoded.indices.size()),
                                .bounds_min = decoded.positions[0],
                                .bounds_max = decoded.positions[0],
                                .digest = bundle::meshDigest(decoded)};
    for (const glm::vec3& position : decoded.positions) {
      primitive.bounds_min = glm::min(primitive.bounds_min, position);
      primitive.bounds_max = glm::max(primitive.bounds_max, position);
    }
    description.meshes.push_back({.name = "mesh", .primitives = {primitive}});
    description.materials.push_back(mesh.material);
    gltf::Node node;
    node.name = "node";
    node.parent_from_node = mesh.world_from_mesh;
    node.mesh = static_cast<std::int32_t>(i);
    description.nodes.push_back(node);
    description.roots.push_back(static_cast<std::int32_t>(i));
    const glm::mat3 group_from_mesh =
        glm::mat3_cast(glm::conjugate(rest_rotation_)) * normalMatrix(glm::mat3(mesh.world_from_mesh));
    for (const bool back : {false, true}) {
      if (back && !mesh.material.double_sided) continue;
      transfer::VertexWeights rows;
      rows.offsets.push_back(0);
      for (const glm::vec3& normal : decoded.normals) {
        rows.samples.push_back(static_cast<std::uint32_t>(vectors.size()));
        rows.weights.push_back(1.0f);
        rows.offsets.push_back(static_cast<std::uint32_t>(rows.samples.size()));
        const glm::vec3 sample_normal = (back ? -1.0f : 1.0f) * glm::normalize(group_from_mesh * normal);
        vectors.push_back(transfer_(sample_normal));
        if (importance_) importance.push_back(std::byte{bundle::importanceCode(importance_(sample_normal))});
      }
      description.draws.push_back(
          {.node = i,
           .mesh = i,
           .primitive = 0,
           .group = 0,
           .back = back,
           .rows = store.payload(bundle::PayloadType::VertexWeights, transfer::encodeRows(rows)),
           .outputs = outputs()});
    }
  }
  for (std::uint32_t i = 0; i < images_.size(); ++i)
    description.images.push_back({.name = "image", .mime_type = "image/png", .view = store.blob(images_[i])});
  description.textures = textures_;
  group.sample_count = static_cast<std::uint32_t>(vectors.size());
  bundle::Cell cell;
  cell.sample_count = group.sample_count;
  cell.bounds_min = group.bounds_min;
  cell.bounds_max = group.bounds_max;
  const auto writeAll = [&] {
    for (const BuiltVolume& volume : volumes_) addVolume(description, blobs, volume);
    const Result<void> written = bundle::write(path, description, blobs);
    ASSERT_TRUE(written) << written.error().line();
  };
  if (meshes_.empty()) return writeAll();
  const transfer::TransferShape shape{
      .order = static_cast<std::uint32_t>(order_),
      .full_channels = bounces_ ? 1u : 0u,
      .outputs = outputs(),
      .visibility_bands = glossy_bands_ > 0 ? static_cast<std::uint32_t>(order_) + glossy_bands_ - 1 : 0};
  if (glossy_bands_ > 0 || layered_)
    description.brdf_tables.push_back(
        {.family = family_,
         .name = family_ == bundle::BrdfFamily::Measured ? "measured.brdf" : "",
         .payload = store.payload(bundle::PayloadType::BrdfTable, bundle::encodeBrdfTable(table_))});
  for (std::vector<float>& vector : vectors)
    for (std::size_t i = 0; vector.size() < shape.size(); ++i) vector.push_back(vector[i]);
  cell.transfers.push_back(storeTransfer(store, shape, vectors));
  if (importance_)
    cell.importance = static_cast<std::int32_t>(store.payload(bundle::PayloadType::Importance, importance));
  cell.transfers.back().error_bound = 0.02f;
  cell.transfers.back().error = 0.0125f;  // what views say of it
  if (!lamps_.empty()) {
    const transfer::TransferShape lamp_shape{.order = 0,
                                             .light_columns = static_cast<std::uint32_t>(lamps_.size())};
    std::vector<float> column;
    for (const BuiltLamp& lamp : lamps_) {
      group.lights.push_back(lamp.light);
      if (lamp.light.kind == bundle::GroupLight::Kind::Node) {
        // As in the baker's output, colour times intensity is the lamp's colour.
        description.nodes[lamp.light.index].light = static_cast<std::int32_t>(description.lights.size());
        description.lights.push_back({.name = "", .color = lamp.light.color, .intensity = 1.0f});
      }
      column.push_back(lamp.transfer);
    }
    cell.transfers.push_back(
        storeTransfer(store, lamp_shape, std::vector<std::vector<float>>(group.sample_count, column)));
  }
  group.cells.push_back(std::move(cell));
  description.groups.push_back(std::move(group));
  writeAll();
}

bundle::MeshData sphereMesh(int rings, int segments) {
  bundle::MeshData mesh;
  constexpr float kPi = std::numbers::pi_v<float>;
  for (int r = 0; r <= rings; ++r)
    for (int s = 0; s <= segments; ++s) {
      const float theta = kPi * static_cast<float>(r) / static_cast<float>(rings);
      const float phi = 2.0f * kPi * static_cast<float>(s % segments) / static_cast<float>(segments);
      const glm::vec3 normal(std::sin(theta) * std::sin(phi), std::cos(theta),
                             std::sin(theta) * std::cos(phi));
      mesh.positions.push_back(normal);
      mesh.normals.push_back(glm::normalize(normal));
    }
  const auto at = [&](int r, int s) { return static_cast<std::uint32_t>(r * (segments + 1) + s); };
  for (int r = 0; r < rings; ++r)
    for (int s = 0; s < segments; ++s) {
      if (r > 0) mesh.indices.insert(mesh.indices.end(), {at(r, s), at(r + 1, s), at(r, s + 1)});
      if (r + 1 < rings)
        mesh.indices.insert(mesh.indices.end(), {at(r, s + 1), at(r + 1, s), at(r + 1, s + 1)});
    }
  return mesh;
}

bundle::MeshData quadMesh() {
  return {.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}},
          .normals = std::vector<glm::vec3>(4, glm::vec3(0, 0, 1)),
          .texcoords0 = {{0, 1}, {1, 1}, {1, 0}, {0, 0}},
          .texcoords1 = {},
          .colors = {},
          .tangents = {},
          .indices = {0, 1, 2, 0, 2, 3}};
}

}  // namespace lambent::testing
