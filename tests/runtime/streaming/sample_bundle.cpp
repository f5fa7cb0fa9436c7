#include "tests/runtime/streaming/sample_bundle.hpp"

#include <array>
#include <utility>

#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>
#include <gtest/gtest.h>

#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>

#include "runtime/bundle/brdf_table.hpp"
#include "runtime/bundle/container.hpp"
#include "runtime/bundle/mesh.hpp"
#include "runtime/transfer/codebook.hpp"

namespace lambent::streaming::testing {
namespace {

void append(void* context, void* data, int size) {
  auto& file = *static_cast<std::vector<std::byte>*>(context);
  const auto* bytes = static_cast<const std::byte*>(data);
  file.insert(file.end(), bytes, bytes + size);
}

std::vector<std::uint8_t> texels(std::uint32_t width, std::uint32_t height, std::uint32_t channels) {
  std::vector<std::uint8_t> all;
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      for (std::uint32_t c = 0; c < channels; ++c) all.push_back(texel(x, y, c));
    }
  }
  return all;
}

class Builder {
 public:
  std::uint32_t addBlob(bundle::Blob blob) {
    sample.blobs.push_back(std::move(blob));
    return static_cast<std::uint32_t>(sample.blobs.size() - 1);
  }

  std::uint32_t addPayload(bundle::PayloadType type, const std::vector<std::byte>& raw,
                           std::uint32_t priority) {
    // Every other payload is compressed, so that both codecs are used.
    const bool zstd = sample.description.payloads.size() % 2 == 1;
    const std::uint32_t view = addBlob(zstd ? bundle::compressZstd(raw, 3) : raw);
    sample.description.payloads.push_back(
        {.type = type,
         .codec = zstd ? bundle::PayloadCodec::Zstd : bundle::PayloadCodec::Raw,
         .view = view,
         .raw_length = raw.size(),
         .priority = priority});
    return static_cast<std::uint32_t>(sample.description.payloads.size() - 1);
  }

  // Makes a fan of triangles at a given height.
  bundle::Primitive makePrimitive(std::uint32_t triangles, float height) {
    draco::Mesh mesh;
    mesh.set_num_points(triangles + 2);
    std::array<int, 2> ids{};
    for (const auto type : {draco::GeometryAttribute::POSITION, draco::GeometryAttribute::NORMAL}) {
      draco::GeometryAttribute attribute;
      attribute.Init(type, nullptr, 3, draco::DT_FLOAT32, false, 3 * sizeof(float), 0);
      const int id = mesh.AddAttribute(attribute, /*identity_mapping=*/true, triangles + 2);
      for (std::uint32_t i = 0; i < triangles + 2; ++i) {
        const std::array<float, 3> position{static_cast<float>(i % 7), height,
                                            static_cast<float>(i * i % 11)};
        const std::array<float, 3> normal{0.0f, 1.0f, 0.0f};
        mesh.attribute(id)->SetAttributeValue(
            draco::AttributeValueIndex(i),
            type == draco::GeometryAttribute::POSITION ? position.data() : normal.data());
      }
      ids[type == draco::GeometryAttribute::POSITION ? 0 : 1] =
          static_cast<int>(mesh.attribute(id)->unique_id());
    }
    for (std::uint32_t i = 0; i < triangles; ++i) {
      mesh.AddFace({draco::PointIndex(0), draco::PointIndex(i + 1), draco::PointIndex(i + 2)});
    }
    draco::Encoder encoder;
    encoder.SetEncodingMethod(draco::MESH_SEQUENTIAL_ENCODING);
    draco::EncoderBuffer buffer;
    EXPECT_TRUE(encoder.EncodeMeshToBuffer(mesh, &buffer).ok());
    const auto* bytes = reinterpret_cast<const std::byte*>(buffer.data());
    const bundle::Blob blob(bytes, bytes + buffer.size());

    bundle::Primitive primitive;
    primitive.view = addBlob(blob);
    primitive.attributes.position = ids[0];
    primitive.attributes.normal = ids[1];
    primitive.vertex_count = triangles + 2;
    primitive.index_count = 3 * triangles;
    primitive.bounds_max = {6.0f, height, 10.0f};
    primitive.bounds_min = {0.0f, height, 0.0f};
    const auto decoded = bundle::decodeDraco(blob, primitive, "sample");
    EXPECT_TRUE(decoded) << decoded.error().line();
    if (decoded) primitive.digest = bundle::meshDigest(*decoded);
    return primitive;
  }

  void addDraw(std::uint32_t mesh, std::uint32_t primitive, std::uint32_t group, std::uint32_t priority) {
    const std::uint32_t vertices = sample.description.meshes[mesh].primitives[primitive].vertex_count;
    transfer::VertexWeights rows;
    rows.offsets.push_back(0);
    for (std::uint32_t v = 0; v < vertices; ++v) {
      rows.samples.push_back(v % sample.description.groups[group].sample_count);
      rows.weights.push_back(1.0f);
      rows.offsets.push_back(v + 1);
    }
    bundle::Draw draw;
    draw.node = mesh;  // each mesh at the node of the same number
    draw.mesh = mesh;
    draw.primitive = primitive;
    draw.group = group;
    draw.rows = addPayload(bundle::PayloadType::VertexWeights, transfer::encodeRows(rows), priority);
    sample.description.draws.push_back(draw);
  }

  // One cell of order 2: 4 columns, as many planes as priorities. Of two clusters, the second has no axes and
  // holds every third sample.
  void addCell(bundle::Group& group, std::uint32_t samples, std::uint32_t codebook_priority,
               const std::vector<std::uint32_t>& plane_priorities, std::uint32_t clusters = 1) {
    bundle::Cell cell;
    cell.first_sample = group.sample_count;
    cell.sample_count = samples;
    group.sample_count += samples;
    bundle::CellTransfer transfer;
    transfer.shape.order = 2;
    transfer.clusters = clusters;
    transfer.axes = static_cast<std::uint32_t>(plane_priorities.size());
    transfer::Codebook codebook;
    codebook.axis_counts.assign(clusters, 0);
    codebook.axis_counts[0] = transfer.axes;
    codebook.axes.assign(transfer.axes, {0.0f, 0.01f});
    for (std::size_t i = 0; i < 4 * (clusters + transfer.axes); ++i) {
      codebook.vectors.push_back(static_cast<float>(i) + static_cast<float>(codebook_priority) * 0.5f);
    }
    transfer.codebook =
        addPayload(bundle::PayloadType::Codebook, transfer::encodeCodebook(codebook), codebook_priority);
    std::vector<std::uint32_t> cluster_of(samples, 0);
    if (clusters > 1) {
      for (std::uint32_t i = 0; i < samples; i += 3) cluster_of[i] = 1;
      transfer.cluster_ids = static_cast<std::int32_t>(
          addPayload(bundle::PayloadType::ClusterIds, transfer::encodeClusterIds(cluster_of, clusters),
                     codebook_priority));
    }
    const std::vector<std::uint32_t> counts = transfer::planeCounts(codebook, cluster_of);
    for (std::size_t p = 0; p < plane_priorities.size(); ++p) {
      const std::uint32_t bits = p % 2 == 0 ? 8 : 16;
      std::vector<std::uint32_t> codes(counts[p]);
      for (std::uint32_t i = 0; i < codes.size(); ++i)
        codes[i] = (31 * i + plane_priorities[p]) % (1u << bits);
      bundle::WeightPlane plane;
      plane.payload = addPayload(bundle::PayloadType::WeightPlane, transfer::encodeWeightPlane(codes, bits),
                                 plane_priorities[p]);
      plane.bits = bits;
      plane.count = counts[p];
      plane.variance = 0.5f;
      transfer.planes.push_back(plane);
    }
    cell.transfers.push_back(transfer);
    group.cells.push_back(cell);
  }

  Sample sample;
};

}  // namespace

std::uint8_t texel(std::uint32_t x, std::uint32_t y, std::uint32_t channel) {
  return static_cast<std::uint8_t>(40 + 17 * x + 29 * y + 61 * channel);
}

std::vector<std::byte> pngFile(std::uint32_t width, std::uint32_t height, std::uint32_t channels) {
  std::vector<std::byte> file;
  const auto pixels = texels(width, height, channels);
  stbi_write_png_to_func(append, &file, static_cast<int>(width), static_cast<int>(height),
                         static_cast<int>(channels), pixels.data(), static_cast<int>(width * channels));
  return file;
}

std::vector<std::byte> jpegFile(std::uint32_t width, std::uint32_t height, std::uint8_t grey) {
  std::vector<std::byte> file;
  const std::vector<std::uint8_t> pixels(std::size_t{3} * width * height, grey);
  stbi_write_jpg_to_func(append, &file, static_cast<int>(width), static_cast<int>(height), 3, pixels.data(),
                         95);
  return file;
}

Sample sampleBundle() {
  Builder b;
  bundle::Description& d = b.sample.description;
  d.nodes.resize(2);
  d.nodes[0].mesh = 0;
  d.nodes[1].mesh = 1;
  d.roots = {0, 1};
  d.groups.resize(2);
  d.groups[0].name = "first";
  d.groups[1].name = "second";
  b.addCell(d.groups[0], 300, /*codebook_priority=*/20, {21, 40});
  b.addCell(d.groups[1], 500, 10, {12, 11, 30}, /*clusters=*/2);
  b.addCell(d.groups[1], 200, 20, {5});
  bundle::Mesh fan, pair;
  fan.name = "fan";
  fan.primitives = {b.makePrimitive(400, 1.0f)};
  pair.name = "pair";
  pair.primitives = {b.makePrimitive(3, 2.0f), b.makePrimitive(50, 3.0f)};
  d.meshes = {fan, pair};
  b.addDraw(0, 0, 0, 3);
  b.addDraw(1, 0, 1, 2);
  b.addDraw(1, 1, 1, 3);
  d.images.push_back({.name = "bark", .mime_type = "image/png", .view = b.addBlob(pngFile(20, 10, 3))});
  d.images.push_back({.name = "leaf", .mime_type = "image/jpeg", .view = b.addBlob(jpegFile(16, 8, 100))});
  d.brdf_tables.push_back(
      {.family = bundle::BrdfFamily::Ggx,
       .name = "",
       .payload = b.addPayload(bundle::PayloadType::BrdfTable, bundle::encodeBrdfTable(brdfTable()), 50)});
  return std::move(b.sample);
}

bundle::BrdfTable brdfTable() {
  bundle::BrdfTable table{.order = 4, .lobes = 2, .angles = 3, .roughnesses = 2, .values = {}};
  for (std::size_t i = 0; i < table.nodes() * table.nodeValues(); ++i)
    table.values.push_back(0.001f * static_cast<float>(i));
  return table;
}

Sample manyImages(std::uint32_t count, std::uint32_t side) {
  Sample sample;
  sample.blobs = {jpegFile(side, side, 100)};
  for (std::uint32_t i = 0; i < count; ++i) {
    sample.description.images.push_back({.name = "wall", .mime_type = "image/jpeg", .view = 0});
  }
  return sample;
}

}  // namespace lambent::streaming::testing
