#include "tests/support/frame/neighborhood_scene.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "baker/compress/draco_encode.hpp"
#include "runtime/base/normal_matrix.hpp"
#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/bundle/description.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/sh/zonal.hpp"
#include "runtime/transfer/codebook.hpp"
#include "tests/support/frame/bundle_builder.hpp"
#include "tests/support/frame/bundle_store.hpp"

namespace lambent::testing {

namespace {

glm::mat4 placed(const glm::vec3& place, const glm::quat& turn) {
  glm::mat4 matrix = glm::mat4_cast(turn);
  matrix[3] = glm::vec4(place, 1.0f);
  return matrix;
}

bundle::Group groupAt(bundle::Description& description, const std::string& name, const glm::vec3& place,
                      const glm::quat& turn) {
  gltf::Node node;
  node.name = name;
  node.parent_from_node = placed(place, turn);
  bundle::Group group;
  group.name = name;
  group.node = static_cast<std::int32_t>(description.nodes.size());
  group.rest_translation = place;
  group.rest_rotation = turn;
  description.roots.push_back(group.node);
  description.nodes.push_back(node);
  return group;
}

bundle::CaptureProxy sphereProxy(float radius) {
  const bundle::MeshData mesh = sphereMesh(8, 12);
  bundle::CaptureProxy proxy;
  for (const glm::vec3& position : mesh.positions) proxy.positions.push_back(radius * position);
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
    proxy.triangles.push_back({.vertices = {mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]}});
  proxy.levels.push_back(
      {.first_triangle = 0, .triangle_count = static_cast<std::uint32_t>(proxy.triangles.size())});
  return proxy;
}

std::vector<float> openVector(const BuiltReceiver& receiver, std::uint32_t order, const glm::vec3& normal) {
  if (receiver.outputs == 1) {
    std::vector<float> open = openTransfer(static_cast<int>(order))(normal), all = open;
    for (int channel = 0; channel < 3 && receiver.full != glm::vec3(0.0f); ++channel)
      for (const float value : open) all.push_back(receiver.full[channel] * value);
    return all;
  }
  const std::uint32_t columns = order * order;
  std::vector<float> vector;
  if (receiver.outputs == 9) {
    vector.assign(std::size_t{9} * columns, 0.0f);
    for (std::uint32_t j = 0; j < 9; ++j) vector[j * columns + j] = 1.0f;
  } else {
    const std::uint32_t bands = order + transfer::bandsOf(receiver.outputs) - 1;
    vector.assign(std::size_t{bands} * bands, 0.0f);
    vector[0] = 3.54490770f;  // sqrt(4 pi)
  }
  return vector;
}

void addReceiver(bundle::Description& description, Store& store, const BuiltReceiver& receiver,
                 std::uint32_t order) {
  bundle::Group group = groupAt(description, receiver.name, receiver.place, receiver.turn);
  const Result<baker::EncodedMesh> encoded = baker::encodeDraco(receiver.mesh, 1.0f / 16384.0f, "test mesh");
  ASSERT_TRUE(encoded) << encoded.error().line();
  const bundle::MeshData& decoded = encoded->decoded;
  bundle::Primitive primitive{.view = store.blob(encoded->bytes),
                              .attributes = encoded->attributes,
                              .material = static_cast<std::int32_t>(description.materials.size()),
                              .vertex_count = static_cast<std::uint32_t>(decoded.positions.size()),
                              .index_count = static_cast<std::uint32_t>(decoded.indices.size()),
                              .bounds_min = decoded.positions[0],
                              .bounds_max = decoded.positions[0],
                              .digest = bundle::meshDigest(decoded)};
  scene::Box bounds;
  for (const glm::vec3& position : decoded.positions) {
    primitive.bounds_min = glm::min(primitive.bounds_min, position);
    primitive.bounds_max = glm::max(primitive.bounds_max, position);
    bounds.add(glm::vec3(receiver.group_from_mesh * glm::vec4(position, 1.0f)));
  }
  group.bounds_min = bounds.min;
  group.bounds_max = bounds.max;
  description.materials.push_back(receiver.material);
  gltf::Node node;
  node.name = receiver.name + " mesh";
  node.parent = group.node;
  node.parent_from_node = receiver.group_from_mesh;
  node.mesh = static_cast<std::int32_t>(description.meshes.size());
  description.meshes.push_back({.name = receiver.name, .primitives = {primitive}});
  const auto mesh_node = static_cast<std::uint32_t>(description.nodes.size());
  description.nodes[static_cast<std::size_t>(group.node)].children.push_back(
      static_cast<std::int32_t>(mesh_node));
  description.nodes.push_back(node);
  const glm::mat3 normals = normalMatrix(glm::mat3(receiver.group_from_mesh));
  transfer::VertexWeights rows;
  rows.offsets.push_back(0);
  std::vector<std::vector<float>> vectors;
  for (const glm::vec3& normal : decoded.normals) {
    rows.samples.push_back(static_cast<std::uint32_t>(vectors.size()));
    rows.weights.push_back(1.0f);
    rows.offsets.push_back(static_cast<std::uint32_t>(rows.samples.size()));
    vectors.push_back(openVector(receiver, order, glm::normalize(normals * normal)));
  }
  description.draws.push_back(
      {.node = mesh_node,
       .mesh = static_cast<std::uint32_t>(node.mesh),
       .primitive = 0,
       .group = static_cast<std::uint32_t>(description.groups.size()),
       .rows = store.payload(bundle::PayloadType::VertexWeights, transfer::encodeRows(rows)),
       .outputs = receiver.outputs});
  group.sample_count = static_cast<std::uint32_t>(vectors.size());
  bundle::Cell cell;
  cell.sample_count = group.sample_count;
  cell.bounds_min = group.bounds_min;
  cell.bounds_max = group.bounds_max;
  cell.transfers.push_back(storeTransfer(
      store,
      {.order = order,
       .full_channels = receiver.full != glm::vec3(0.0f) ? 3u : 0u,
       .outputs = receiver.outputs,
       .visibility_bands = receiver.outputs > 9 ? order + transfer::bandsOf(receiver.outputs) - 1 : 0},
      vectors));
  group.cells.push_back(std::move(cell));
  description.groups.push_back(std::move(group));
}

void addBody(bundle::Description& description, Store& store, const BuiltBody& body, std::uint32_t order) {
  bundle::Group group = groupAt(description, body.name, body.place, body.turn);
  group.bounds_min = -0.25f * body.half;
  group.bounds_max = 0.25f * body.half;
  group.neighborhood =
      bundle::NeighborhoodGrid{.size = body.size, .bounds_min = -body.half, .bounds_max = body.half};
  const transfer::TransferShape shape{.order = order,
                                      .outputs = body.outputs,
                                      .visibility_bands = order + transfer::bandsOf(body.outputs) - 1};
  std::vector<std::vector<float>> vectors;
  for (std::uint32_t z = 0; z < body.size.z; ++z)
    for (std::uint32_t y = 0; y < body.size.y; ++y)
      for (std::uint32_t x = 0; x < body.size.x; ++x)
        vectors.push_back(
            body.change(static_cast<int>(shape.visibility_bands),
                        body.half * (2.0f * glm::vec3(x, y, z) / glm::vec3(body.size - 1u) - 1.0f)));
  if (body.volume) {
    group.within = body.within;
    bundle::VolumeGrid volume;
    volume.size = glm::uvec3(1);
    volume.density = store.payload(bundle::PayloadType::Density, bundle::Blob(1));
    volume.transfer_size = glm::uvec3(1);
    volume.voxels = store.payload(bundle::PayloadType::Voxels, bundle::encodeVoxels({}));
    group.volume = volume;
  }
  group.sample_count = static_cast<std::uint32_t>(vectors.size());
  constexpr std::size_t kMostOfCell = 65536;
  for (std::size_t first = 0; first < vectors.size(); first += kMostOfCell) {
    const std::size_t end = std::min(first + kMostOfCell, vectors.size());
    bundle::Cell cell;
    cell.domain = transfer::Domain::GridPoint;
    cell.first_sample = static_cast<std::uint32_t>(first);
    cell.sample_count = static_cast<std::uint32_t>(end - first);
    cell.bounds_min = -body.half;
    cell.bounds_max = body.half;
    const auto from = vectors.begin() + static_cast<std::ptrdiff_t>(first);
    cell.transfers.push_back(
        storeTransfer(store, shape, {from, vectors.begin() + static_cast<std::ptrdiff_t>(end)}));
    group.cells.push_back(std::move(cell));
  }
  if (body.sphere_radius > 0.0f)
    group.proxy = static_cast<std::int32_t>(store.payload(
        bundle::PayloadType::CaptureProxy, bundle::encodeCaptureProxy(sphereProxy(body.sphere_radius))));
  description.groups.push_back(std::move(group));
}

}  // namespace

ChangeAt blackSphere(float radius) {
  return [radius](int bands, const glm::vec3& point) {
    const float distance = std::max(glm::length(point), 1.05f * radius);
    const glm::vec3 towards = glm::length(point) > 0.0f ? -glm::normalize(point) : glm::vec3(0, 1, 0);
    const sh::LightVector cap =
        sh::discLight(bands, towards, std::asin(double{radius} / double{distance}), glm::vec3(1.0f));
    std::vector<float> change;
    for (const glm::vec3& value : cap.coefficients()) change.push_back(-value.x);
    return change;
  };
}

void NeighborhoodScene::write(const std::filesystem::path& path) const {
  bundle::Description description;
  description.generator = {.program = "test", .version = "1", .isa = "any", .settings = {}};
  std::vector<bundle::Blob> blobs;
  Store store{description, blobs};
  if (table)
    description.brdf_tables.push_back(
        {.family = bundle::BrdfFamily::Ggx,
         .name = "",
         .payload = store.payload(bundle::PayloadType::BrdfTable, bundle::encodeBrdfTable(*table))});
  for (const BuiltReceiver& receiver : receivers) addReceiver(description, store, receiver, order);
  for (const BuiltBody& body : bodies) addBody(description, store, body, order);
  const Result<void> written = bundle::write(path, description, blobs);
  ASSERT_TRUE(written) << written.error().line();
}

bundle::MeshData floorMesh(float half, int cells) {
  bundle::MeshData mesh;
  for (int z = 0; z <= cells; ++z)
    for (int x = 0; x <= cells; ++x) {
      const auto at = [&](int i) {
        return half * (2.0f * static_cast<float>(i) / static_cast<float>(cells) - 1.0f);
      };
      mesh.positions.emplace_back(at(x), 0.0f, at(z));
      mesh.normals.emplace_back(0.0f, 1.0f, 0.0f);
      mesh.texcoords0.emplace_back(static_cast<float>(x) / static_cast<float>(cells),
                                   static_cast<float>(z) / static_cast<float>(cells));
    }
  const auto vertex = [&](int x, int z) { return static_cast<std::uint32_t>(z * (cells + 1) + x); };
  for (int z = 0; z < cells; ++z)
    for (int x = 0; x < cells; ++x)
      mesh.indices.insert(mesh.indices.end(), {vertex(x, z), vertex(x, z + 1), vertex(x + 1, z),
                                               vertex(x + 1, z), vertex(x, z + 1), vertex(x + 1, z + 1)});
  return mesh;
}

}  // namespace lambent::testing
