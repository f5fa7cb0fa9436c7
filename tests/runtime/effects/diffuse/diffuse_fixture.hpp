// Random bundles for the diffuse effect: several groups, cells and draws of odd sizes with random meshes,
// rows, bases and codes, as descriptions and as what the loader would hand on.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include <glm/geometric.hpp>

#include "runtime/bundle/description.hpp"
#include "runtime/bundle/transfer_codec.hpp"
#include "runtime/streaming/loader.hpp"

namespace lambent::testing {

struct RandomBundle {
  bundle::Description description;
  std::vector<streaming::Ready> meshes, rows, bases;
  std::vector<std::vector<streaming::PlaneReady>> planes;  // per cell
};

struct RandomBundleOptions {
  std::uint32_t order = 5;
  std::uint32_t channels = 1;
  std::uint32_t planes = 7;
  std::uint32_t groups = 2;
  std::uint32_t cells = 3;      // per group
  std::uint32_t samples = 101;  // per cell, odd on purpose
  std::uint32_t vertices = 131;
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
    bundle::Group group{.name = "group",
                        .node = static_cast<std::int32_t>(g),
                        .rest_translation = {},
                        .rest_rotation = rotation(),
                        .bounds_min = {},
                        .bounds_max = {},
                        .sample_count = options.cells * options.samples,
                        .cells = {}};
    for (std::uint32_t c = 0; c < options.cells; ++c) group.cells.push_back(makeCell(made, options, g, c));
    gltf::Node node;
    node.parent_from_node = glm::mat4_cast(group.rest_rotation);
    // Scale differs by axis: normals must go by the inverse transpose.
    for (int axis = 0; axis < 3; ++axis) node.parent_from_node[axis] *= uniform(0.5f, 2.0f);
    node.mesh = static_cast<std::int32_t>(g);
    description.nodes.push_back(node);
    description.roots.push_back(static_cast<std::int32_t>(g));
    addMesh(made, options, g);
    description.payloads.push_back({});
    description.draws.push_back({.node = g, .mesh = g, .primitive = 0, .group = g, .rows = g});
    made.rows.push_back(streaming::RowsReady{.draw = g, .rows = makeRows(options, group.sample_count)});
    description.groups.push_back(std::move(group));
  }

  bundle::Cell makeCell(RandomBundle& made, const RandomBundleOptions& options, std::uint32_t g,
                        std::uint32_t c) {
    bundle::DiffuseTransfer transfer{.part = bundle::TransferPart::Direct,
                                     .order = options.order,
                                     .light_columns = 0,
                                     .channels = options.channels,
                                     .basis = 0,
                                     .planes = {},
                                     .error_bound = 0.0f,
                                     .error = 0.0f};
    const std::uint32_t length = options.channels * options.order * options.order;
    streaming::BasisReady basis{.group = g, .cell = c, .transfer = 0, .vectors = {}};
    for (std::uint32_t i = 0; i < (1 + options.planes) * length; ++i)
      basis.vectors.push_back(uniform(-0.5f, 0.5f));
    made.bases.emplace_back(std::move(basis));
    auto& planes = made.planes.emplace_back();
    for (std::uint32_t j = 0; j < options.planes; ++j) {
      const std::uint32_t bits = j % 2 == 0 ? 16 : 8;
      std::vector<std::uint32_t> codes;
      for (std::uint32_t s = 0; s < options.samples; ++s) codes.push_back(below(bits == 16 ? 65536 : 256));
      transfer.planes.push_back({.payload = 0,
                                 .bits = bits,
                                 .offset = uniform(-1.0f, 0.0f),
                                 .scale = 2.0f / (bits == 16 ? 65535.0f : 255.0f),
                                 .variance = j == 0 ? 0.95f : 0.01f});
      planes.push_back(
          {.group = g, .cell = c, .transfer = 0, .plane = j, .codes = bundle::encodePlane(codes, bits)});
    }
    return {.first_sample = c * options.samples,
            .sample_count = options.samples,
            .bounds_min = {},
            .bounds_max = {},
            .diffuse = {transfer}};
  }

  void addMesh(RandomBundle& made, const RandomBundleOptions& options, std::uint32_t g) {
    bundle::MeshData data;
    for (std::uint32_t v = 0; v < options.vertices; ++v) {
      data.positions.push_back(direction());
      // Poles among them: the recurrences must not mind.
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
    made.description.meshes.push_back({.name = "mesh", .primitives = {primitive}});
    made.meshes.push_back(streaming::MeshReady{.mesh = g, .primitive = 0, .data = std::move(data)});
  }

  bundle::VertexRows makeRows(const RandomBundleOptions& options, std::uint32_t sample_count) {
    bundle::VertexRows rows;
    rows.offsets.push_back(0);
    for (std::uint32_t v = 0; v < options.vertices; ++v) {
      const std::uint32_t entries = 1 + below(4);
      for (std::uint32_t e = 0; e < entries; ++e) {
        rows.samples.push_back(below(sample_count));
        rows.weights.push_back(1.0f / static_cast<float>(entries));
      }
      rows.offsets.push_back(static_cast<std::uint32_t>(rows.samples.size()));
    }
    return rows;
  }

  std::mt19937 random_;
};

}  // namespace lambent::testing
