// Makes a bundle with an entry in every list of its description, for tests of what is written and read back.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tests/runtime/bundle/bundle_file.hpp"

namespace lambent::bundle {

inline Blob blobOf(std::size_t size, unsigned first) {
  Blob blob(size);
  for (std::size_t i = 0; i < size; ++i) blob[i] = static_cast<std::byte>((first + 7 * i) & 255u);
  return blob;
}

inline const std::vector<transfer::LightWeights> kWeights = {
    transfer::kOneLight, {{1, 2, 0, 0}, {200, 55, 0, 0}}, {{2, 1, 0, 0}, {128, 127, 0, 0}}};

// Makes a description that uses every list except meshes (mesh_test.cpp has those), with values that are
// easily lost.
inline Sample sampleOfEveryList() {
  Sample s;
  Description& d = s.description;
  d.generator = {"lambent", "0.1.0", "x86-64-v3", {{"order", "2"}, {"rays", "64"}}};
  gltf::Node parent, child;
  parent.name = "root \"quoted\" \xc3\xa4";
  parent.children = {1};
  parent.movable = true;
  child.name = "child";
  child.parent = 0;
  child.camera = 0;
  child.parent_from_node[3] = glm::vec4(0.1f, -2.5e-7f, 3.0e8f, 1.0f);
  d.nodes = {parent, child};
  d.roots = {0};
  gltf::Material material;
  material.name = "leaf";
  material.base_color = {0.1f, 0.2f, 0.3f, 0.4f};
  material.base_color_texture = {0, 1};
  material.alpha_mode = gltf::AlphaMode::Mask;
  material.alpha_cutoff = 0.25f;
  material.double_sided = true;
  d.materials = {material};
  d.textures = {{0, {33071, 33648, 9728, 9985}}};
  d.images = {{"bark", "image/png", 0}};
  gltf::Camera camera;
  camera.name = "main";
  camera.yfov_rad = 0.7f;
  d.cameras = {camera};
  gltf::Light lamp;
  lamp.name = "lamp";
  d.lights = {lamp};
  d.nodes[1].light = 0;

  // Cell 0 is plain, with two clusters of two axes and none; cell 1 is normal-mapped, with one cluster. Both
  // have lamps.
  const auto add = [&](PayloadType type, const Blob& bytes) { return s.add(type, bytes); };
  const auto codebook = [&](const transfer::TransferShape& shape,
                            const std::vector<std::uint32_t>& axis_counts) {
    transfer::Codebook book{axis_counts, {}, {}};
    for (const std::uint32_t count : axis_counts) {
      book.axes.insert(book.axes.end(), count, {-0.5f, 0.001f});
      book.vectors.insert(book.vectors.end(), (1 + count) * shape.size(), 0.25f);
    }
    return transfer::encodeCodebook(book);
  };
  s.blobs = {blobOf(13, 1)};
  CellTransfer plain;
  plain.shape = {.order = 2, .shadowed_channels = 1, .full_channels = 3};
  plain.clusters = 2;
  plain.axes = 2;
  plain.codebook = add(PayloadType::Codebook, codebook(plain.shape, {2, 0}));
  plain.cluster_ids = static_cast<std::int32_t>(
      add(PayloadType::ClusterIds, transfer::encodeClusterIds(std::vector{0u, 1u, 0u}, 2)));
  const auto plane = [&](std::uint32_t bits, const std::vector<std::uint32_t>& codes, float variance) {
    return WeightPlane{add(PayloadType::WeightPlane, transfer::encodeWeightPlane(codes, bits)), bits,
                       static_cast<std::uint32_t>(codes.size()), variance};
  };
  plain.planes = {plane(16, {65535, 7}, 0.9f), plane(8, {3, 255}, 0.05f)};
  plain.error_bound = 0.005f;
  plain.error = 0.004f;
  CellTransfer lamps;
  lamps.shape = {.order = 0, .light_columns = 2, .shadowed_channels = 3};
  lamps.codebook = add(PayloadType::Codebook, codebook(lamps.shape, {0}));
  CellTransfer mapped;
  mapped.shape = {.order = 1, .outputs = 9};
  mapped.axes = 1;
  mapped.codebook = add(PayloadType::Codebook, codebook(mapped.shape, {1}));
  mapped.planes = {plane(8, {1, 2}, 0.5f)};
  Group group;
  group.name = "root";
  group.node = 0;
  group.rest_translation = {1.0f, 2.0f, 3.0f};
  group.rest_rotation = glm::quat(0.5f, 0.5f, -0.5f, 0.5f);
  group.sample_count = 5;
  group.lights = {{GroupLight::Kind::Material,
                   0,
                   {3.0f, 2.0f, 1.0f},
                   {{{1.0f, -2.0f, 0.1f}, 0.25f, 0.3f}, {{0.0f, 4.0f, 0.0f}, 1e-3f, 1e-3f}}},
                  {GroupLight::Kind::Node, 1, {0.0f, 40.0f, 0.5f}}};
  group.cells = {{0, 3, glm::vec3(-1.0f), glm::vec3(1.0f), {plain, lamps}},
                 {3, 2, glm::vec3(-1.0f), glm::vec3(1.0f), {mapped}}};
  // Cell 0 is lit from all three light probes, cell 1 from the last.
  group.light_probes = {glm::vec3(0.0f), {0.1f, -2.0f, 3e8f}, glm::vec3(1.0f)};
  group.cells[0].light_probes = {0, 1, 2};
  group.cells[0].light_weights =
      static_cast<std::int32_t>(add(PayloadType::LightWeights, transfer::encodeLightWeights(kWeights)));
  group.cells[1].light_probes = {2};
  CaptureProxy proxy;
  proxy.positions = {glm::vec3(0.0f), {1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}};
  proxy.triangles = {{{0, 1, 2}, true, {1.0f, 2.0f, 3.0f}, 1, 0, 1}};
  proxy.entries = {{4, {1.0f, 0.5f, 0.0f}}};
  proxy.levels = {{0, 1, 0.25f}};
  group.proxy = static_cast<std::int32_t>(add(PayloadType::CaptureProxy, encodeCaptureProxy(proxy)));
  d.groups = {group};
  return s;
}

}  // namespace lambent::bundle
