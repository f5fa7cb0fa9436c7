// Makes random bundles for the diffuse effect: several groups, cells and draws of odd sizes with random
// meshes, rows, clusters and codes, as descriptions and as the chunks that the loader would deliver.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include <glm/geometric.hpp>

#include "runtime/bundle/description.hpp"
#include "runtime/streaming/loader.hpp"
#include "runtime/transfer/codebook.hpp"

namespace lambent::testing {

struct RandomBundle {
  bundle::Description description;
  std::vector<streaming::Ready> meshes, rows;
  std::vector<std::vector<streaming::CodebookChunk>> codebooks;  // per cell, by transfer
  std::vector<std::vector<streaming::PlaneChunk>> planes;   // per cell, for the environment, then the lamps
  std::vector<streaming::LightWeightsChunk> light_weights;  // per cell; none if there is one light probe
  std::vector<streaming::ProxyChunk> proxies;               // per group
};

struct RandomBundleOptions {
  std::uint32_t order = 5;
  std::uint32_t shadowed_channels = 1, full_channels = 0;
  std::uint32_t planes = 7;
  std::uint32_t clusters = 1;
  std::uint32_t lamps = 0;
  std::uint32_t groups = 2;
  std::uint32_t cells = 3;         // per group
  std::uint32_t mapped_cells = 0;  // more cells, with nine outputs
  std::uint32_t glossy_cells = 0;  // more cells, with glossy_bands² outputs of visibility
  std::uint32_t glossy_bands = 5;
  std::uint32_t neighborhood_cells = 0;  // more cells, with grid points of neighborhood_bands² outputs
  std::uint32_t neighborhood_bands = 3;
  bool bounced = false;         // glossy cells and grid points have bounces
  std::uint32_t samples = 101;  // per cell, deliberately odd
  std::uint32_t vertices = 131;
  std::uint32_t light_probes = 1;     // per group; every cell uses all but the first
  std::uint32_t proxy_triangles = 0;  // per group
  std::uint32_t texels = 0;           // side of the textures of draws with one output
};

class BundleMaker {
 public:
  explicit BundleMaker(std::uint32_t seed) : random_(seed) {}

  float uniform(float low, float high) { return std::uniform_real_distribution<float>(low, high)(random_); }
  std::uint32_t below(std::uint32_t count) { return static_cast<std::uint32_t>(random_() % count); }
  glm::vec3 direction() {
    std::normal_distribution<float> normal;
    return glm::normalize(glm::vec3(normal(random_), normal(random_), normal(random_)));
  }
  glm::quat rotation() {
    std::normal_distribution<float> normal;
    return glm::normalize(glm::quat(normal(random_), normal(random_), normal(random_), normal(random_)));
  }

  RandomBundle make(const RandomBundleOptions& options) {
    RandomBundle made;
    bundle::Description& description = made.description;
    description.materials.emplace_back();
    for (std::uint32_t g = 0; g < options.groups; ++g) addGroup(made, options, g);
    return made;
  }

 private:
  void addGroup(RandomBundle& made, const RandomBundleOptions& options, std::uint32_t g) {
    bundle::Description& description = made.description;
    const std::uint32_t surface_cells = options.cells + options.mapped_cells + options.glossy_cells;
    const std::uint32_t cells = surface_cells + options.neighborhood_cells;
    const std::uint32_t glossy_outputs = options.glossy_bands * options.glossy_bands;
    bundle::Group group;
    group.node = static_cast<std::int32_t>(g);
    group.rest_rotation = rotation();
    group.sample_count = cells * options.samples;
    for (std::uint32_t k = 0; k < options.lamps; ++k)
      group.lights.push_back(
          {.kind = bundle::GroupLight::Kind::Material, .index = 0, .color = glm::vec3(1.0f)});
    group.light_probes.assign(options.light_probes, glm::vec3(0.0f));
    for (std::uint32_t c = 0; c < cells; ++c)
      group.cells.push_back(
          makeCell(made, options, g, c,
                   c < options.cells                          ? 1
                   : c < options.cells + options.mapped_cells ? 9
                   : c < surface_cells                        ? glossy_outputs
                                       : options.neighborhood_bands * options.neighborhood_bands,
                   c < surface_cells ? transfer::Domain::Vertex : transfer::Domain::GridPoint));
    gltf::Node node;
    node.parent_from_node = glm::mat4_cast(group.rest_rotation);
    // The scale is non-uniform, so that normals need the inverse transpose.
    for (int axis = 0; axis < 3; ++axis) node.parent_from_node[axis] *= uniform(0.5f, 2.0f);
    node.mesh = static_cast<std::int32_t>(g);
    description.nodes.push_back(node);
    description.roots.push_back(static_cast<std::int32_t>(g));
    description.meshes.push_back({.name = "mesh", .primitives = {}});
    description.payloads.resize(1);
    const std::uint32_t plain = options.cells * options.samples;
    if (plain > 0) addDraw(made, options, g, 1, 0, plain);
    const std::uint32_t mapped = plain + options.mapped_cells * options.samples;
    if (options.mapped_cells > 0) addDraw(made, options, g, 9, plain, mapped);
    if (options.glossy_cells > 0)
      addDraw(made, options, g, glossy_outputs, mapped, surface_cells * options.samples);
    if (options.proxy_triangles > 0) {
      group.proxy = 0;
      made.proxies.push_back({{bundle::GroupIndex{g}}, makeProxy(options, group.sample_count)});
    }
    description.groups.push_back(std::move(group));
  }

  // Makes triangles with none to eight entries; every other one is emissive.
  bundle::CaptureProxy makeProxy(const RandomBundleOptions& options, std::uint32_t sample_count) {
    bundle::CaptureProxy proxy;
    for (std::uint32_t t = 0; t < options.proxy_triangles; ++t) {
      bundle::ProxyTriangle triangle;
      for (std::uint32_t v = 0; v < 3; ++v) {
        triangle.vertices[v] = static_cast<std::uint32_t>(proxy.positions.size());
        proxy.positions.push_back(direction());
      }
      triangle.first_entry = static_cast<std::uint32_t>(proxy.entries.size());
      triangle.entry_count = t % 9;
      for (std::uint32_t e = 0; e < triangle.entry_count; ++e)
        proxy.entries.push_back({.sample = below(sample_count), .reflectance = 0.1f * color()});
      if (options.lamps > 0 && t % 2 == 1) {
        triangle.light = static_cast<std::int32_t>(below(options.lamps));
        triangle.emission = color();
      }
      proxy.triangles.push_back(triangle);
    }
    proxy.levels.push_back({.first_triangle = 0, .triangle_count = options.proxy_triangles});
    return proxy;
  }
  glm::vec3 color() { return {uniform(0, 1), uniform(0, 1), uniform(0, 1)}; }

  // Chooses up to four different lights, with decreasing weights that sum to 255.
  transfer::LightWeights lightWeights(std::uint32_t lights) {
    transfer::LightWeights weights;
    const std::uint32_t count = 1 + below(std::min(lights, 4u)), first = below(lights);
    std::uint32_t left = 255;
    for (std::uint32_t k = 0; k < count; ++k) {
      weights.light[k] = static_cast<std::uint8_t>((first + k) % lights);
      weights.weight[k] = static_cast<std::uint8_t>(k + 1 == count ? left : (left + 1) / 2 + 10);
      left -= weights.weight[k];
    }
    return weights;
  }

  void addDraw(RandomBundle& made, const RandomBundleOptions& options, std::uint32_t g, std::uint32_t outputs,
               std::uint32_t first_sample, std::uint32_t end_sample) {
    const auto index = static_cast<std::uint32_t>(made.description.draws.size());
    const auto primitive = static_cast<std::uint32_t>(made.description.meshes[g].primitives.size());
    addMesh(made, options, g);
    made.description.draws.push_back(
        {.node = g, .mesh = g, .primitive = primitive, .group = g, .rows = 0, .outputs = outputs});
    transfer::VertexWeights rows = makeRows(options, first_sample, end_sample);
    if (outputs == 1) made.description.draws.back().texels = options.texels;
    for (std::uint32_t texel = 0; outputs == 1 && texel < options.texels * options.texels; ++texel) {
      rows.samples.push_back(first_sample + below(end_sample - first_sample));
      rows.weights.push_back(1.0f);
      rows.offsets.push_back(static_cast<std::uint32_t>(rows.samples.size()));
    }
    made.rows.push_back(streaming::WeightsChunk{{index}, std::move(rows)});
  }

  bundle::Cell makeCell(RandomBundle& made, const RandomBundleOptions& options, std::uint32_t g,
                        std::uint32_t c, std::uint32_t outputs, transfer::Domain domain) {
    bundle::Cell cell;
    cell.domain = domain;
    cell.first_sample = c * options.samples;
    cell.sample_count = options.samples;
    made.codebooks.emplace_back();
    made.planes.emplace_back();
    if (options.light_probes > 2) {
      cell.light_probes.clear();
      for (std::uint32_t k = 1; k < options.light_probes; ++k) cell.light_probes.push_back(k);
      cell.light_weights = 0;
      streaming::LightWeightsChunk ready{{bundle::GroupIndex{g}, bundle::CellIndex{c}}, {}};
      for (std::uint32_t s = 0; s < options.samples; ++s)
        ready.samples.push_back(lightWeights(options.light_probes - 1));
      made.light_weights.push_back(std::move(ready));
    }
    transfer::TransferShape shape{.order = options.order,
                                  .light_columns = 0,
                                  .shadowed_channels = options.shadowed_channels,
                                  .full_channels = options.full_channels,
                                  .outputs = outputs};
    const auto add = [&](const transfer::TransferShape& part) {
      const auto index = static_cast<std::uint32_t>(cell.transfers.size());
      cell.transfers.push_back(makeTransfer(made, options, g, c, index, part));
    };
    if (outputs <= transfer::kMappedOutputs && domain == transfer::Domain::Vertex) {
      add(shape);
    } else {
      add({.order = options.order,
           .shadowed_channels = 1,
           .full_channels = 0,
           .outputs = outputs,
           .visibility_bands = options.order + transfer::bandsOf(outputs) - 1});
      if (options.bounced)
        add({.order = options.order, .shadowed_channels = 0, .full_channels = 3, .outputs = outputs});
    }
    if (options.lamps > 0) {
      shape.order = 0;
      shape.light_columns = options.lamps;
      add(shape);
    }
    return cell;
  }

  // Makes clusters of decreasing numbers of axes, with random samples in each.
  bundle::CellTransfer makeTransfer(RandomBundle& made, const RandomBundleOptions& options, std::uint32_t g,
                                    std::uint32_t c, std::uint32_t transfer_index,
                                    const transfer::TransferShape& shape) {
    bundle::CellTransfer transfer;
    transfer.shape = shape;
    transfer.clusters = options.clusters;
    transfer::Codebook codebook;
    for (std::uint32_t cluster = 0; cluster < options.clusters; ++cluster) {
      codebook.axis_counts.push_back(options.planes - cluster * (options.planes + 1) / options.clusters);
      for (std::uint32_t j = 0; j < codebook.axis_counts.back(); ++j)
        codebook.axes.push_back(
            {.offset = uniform(-1.0f, 0.0f), .scale = 2.0f / (bitsOf(j) == 16 ? 65535.0f : 255.0f)});
    }
    transfer.axes = static_cast<std::uint32_t>(codebook.axes.size());
    for (std::uint32_t i = 0; i < (options.clusters + transfer.axes) * shape.size(); ++i)
      codebook.vectors.push_back(uniform(-0.5f, 0.5f));
    std::vector<std::uint32_t> cluster_of;
    for (std::uint32_t s = 0; s < options.samples; ++s)
      cluster_of.push_back(s == 0 ? 0 : below(options.clusters));
    const std::vector<std::uint32_t> counts = transfer::planeCounts(codebook, cluster_of);
    const streaming::CodebookRequest place{bundle::GroupIndex{g}, bundle::CellIndex{c},
                                           bundle::TransferIndex{transfer_index}};
    for (std::uint32_t j = 0; j < counts.size(); ++j) {
      streaming::PlaneChunk plane{{place, bundle::PlaneIndex{j}}, {}};
      for (std::uint32_t i = 0; i < counts[j] * bitsOf(j) / 8; ++i)
        plane.codes.push_back(static_cast<std::byte>(below(256)));
      made.planes.back().push_back(std::move(plane));
      transfer.planes.push_back(
          {.payload = 0, .bits = bitsOf(j), .count = counts[j], .variance = j == 0 ? 0.95f : 0.01f});
    }
    std::vector<std::uint32_t> positions = transfer::positionsOf(cluster_of, options.clusters);
    for (std::uint32_t& position : positions) position |= cluster_of[position] << 16;
    made.codebooks.back().push_back({place, std::move(codebook), std::move(positions)});
    return transfer;
  }

  static std::uint32_t bitsOf(std::uint32_t plane) { return plane % 2 == 0 ? 16 : 8; }

  void addMesh(RandomBundle& made, const RandomBundleOptions& options, std::uint32_t g) {
    bundle::MeshData data;
    for (std::uint32_t v = 0; v < options.vertices; ++v) {
      data.positions.push_back(direction());
      // The poles are among them, because recurrences may fail there.
      data.normals.push_back(v == 0   ? glm::vec3(0.0f, 0.0f, 1.0f)
                             : v == 1 ? glm::vec3(0.0f, 0.0f, -1.0f)
                                      : direction());
    }
    for (std::uint32_t v = 0; v + 2 < options.vertices; ++v)
      data.indices.insert(data.indices.end(), {v, v + 1, v + 2});
    bundle::Primitive primitive;
    primitive.material = 0;
    primitive.vertex_count = options.vertices;
    primitive.index_count = static_cast<std::uint32_t>(data.indices.size());
    auto& primitives = made.description.meshes[g].primitives;
    made.meshes.push_back(
        streaming::MeshChunk{{g, static_cast<std::uint32_t>(primitives.size())}, std::move(data)});
    primitives.push_back(primitive);
  }

  transfer::VertexWeights makeRows(const RandomBundleOptions& options, std::uint32_t first_sample,
                                   std::uint32_t end_sample) {
    transfer::VertexWeights rows;
    rows.offsets.push_back(0);
    for (std::uint32_t v = 0; v < options.vertices; ++v) {
      const std::uint32_t entries = 1 + below(4);
      for (std::uint32_t e = 0; e < entries; ++e) {
        rows.samples.push_back(first_sample + below(end_sample - first_sample));
        rows.weights.push_back(1.0f / static_cast<float>(entries));
      }
      rows.offsets.push_back(static_cast<std::uint32_t>(rows.samples.size()));
    }
    return rows;
  }

  std::mt19937 random_;
};

}  // namespace lambent::testing
