// The CPU twin against closed forms and against the plain way of decoding: always runs.
#include <cstring>

#include <gtest/gtest.h>

#include "runtime/effects/diffuse/diffuse_ref.hpp"
#include "runtime/sh/light_vector.hpp"
#include "runtime/sh/zonal.hpp"
#include "tests/runtime/effects/diffuse/diffuse_fixture.hpp"

namespace lambent::effects::diffuse {
namespace {

std::vector<glm::vec4> randomLight(testing::BundleMaker& maker, int order) {
  std::vector<glm::vec4> light(kLightStride, glm::vec4(0.0f));
  for (int i = 0; i < order * order; ++i)
    light[static_cast<std::size_t>(i)] = {maker.uniform(-1, 1), maker.uniform(-1, 1), maker.uniform(-1, 1),
                                          0.0f};
  return light;
}

}  // namespace

TEST(DiffuseTwin, ShadesUnshadowedAsTheClosedFormOfOpenTransfer) {
  testing::BundleMaker maker(3);
  for (int order = 1; order <= 8; ++order) {
    const std::vector<glm::vec4> light = randomLight(maker, order);
    ref::Memory memory;
    memory.lights = light;
    for (int i = 0; i < 50; ++i) {
      const glm::vec3 normal = i == 0 ? glm::vec3(0, 0, 1) : i == 1 ? glm::vec3(0, -1, 0) : maker.direction();
      std::vector<float> transfer(static_cast<std::size_t>(order * order));
      sh::unoccludedTransfer(order, normal, transfer);
      glm::vec3 expected(0.0f);
      for (std::size_t k = 0; k < transfer.size(); ++k) expected += transfer[k] * glm::vec3(light[k]);
      const glm::vec3 got = ref::unshadowedRadiance(memory, normal, 0, order);
      // Float recurrences on coefficients of size 1, up to 64 of them.
      EXPECT_LT(glm::distance(got, expected), 1e-5f * static_cast<float>(order)) << "order " << order;
    }
  }
}

namespace {

// A transfer as residency lays it out, alone in its page.
struct Page {
  std::vector<uint> words, places;
  TransferRecord record{};

  Page(const testing::RandomBundle& made, std::size_t transfer_index, bool full) {
    const bundle::CellTransfer& transfer = made.description.groups[0].cells[0].transfers[transfer_index];
    const bundle::TransferShape& shape = transfer.shape;
    const bundle::Codebook& codebook = made.codebooks[0][transfer_index].codebook;
    const auto& positions = made.codebooks[0][transfer_index].positions;
    const std::uint32_t lights =
        shape.order > 0 && !made.light_weights.empty()
            ? static_cast<std::uint32_t>(made.description.groups[0].light_samples.size()) - 1
            : 1;
    for (std::uint32_t k = 0; k < lights; ++k)
      places.push_back(shape.order > 0 ? kLightStride * k : lampsOf(made));
    record = {.light_count = lights,
              .first_light = 0,
              .light_weights_word = 0,
              .columns = shape.columns(),
              .channels = full ? shape.full_channels : shape.shadowed_channels,
              .outputs = shape.outputs,
              .clusters = transfer.clusters,
              .clusters_word = 0,
              .weights_word = 0,
              .vectors_word = 0,
              .positions_word = 0,
              .vector_size = shape.size(),
              .first_value = full ? shape.shadowed_channels * shape.outputs * shape.columns() : 0,
              .plane_count = static_cast<uint>(transfer.planes.size()),
              .first_plane = lights,
              .first_product = 0,
              .light_products = (transfer.clusters + transfer.axes) * shape.outputs,
              .first_output = 0,
              .sample_count = static_cast<uint>(positions.size()),
              .accumulate = transfer_index > 0 ? 1u : 0u,
              .order = shape.order,
              .visibility = 0};
    uint vector = 0;
    for (const uint axes : codebook.axis_counts) {
      words.insert(words.end(), {vector, axes});
      vector += 1 + axes;
    }
    record.weights_word = size();
    for (std::size_t c = 0, axis = 0; c < codebook.clusters(); ++c) {
      append(std::vector{1.0f, 0.0f});
      for (uint j = 0; j < codebook.axis_counts[c]; ++j, ++axis)
        append(std::vector{codebook.axes[axis].offset, codebook.axes[axis].scale});
    }
    record.vectors_word = size();
    append(codebook.vectors);
    record.positions_word = size();
    words.insert(words.end(), positions.begin(), positions.end());
    for (const streaming::PlaneReady& plane : made.planes[0]) {
      if (plane.transfer != transfer_index) continue;
      places.push_back(size() | (transfer.planes[plane.plane].bits == 16 ? kCodes16Bit : 0u));
      words.resize(words.size() + (plane.codes.size() + 3) / 4);
      std::memcpy(&words[places.back() & ~kCodes16Bit], plane.codes.data(), plane.codes.size());
    }
    if (lights > 1) {
      record.light_weights_word = size();
      const auto& weights = made.light_weights[0].samples;
      words.resize(words.size() + 2 * weights.size());
      std::memcpy(&words[record.light_weights_word], weights.data(), 8 * weights.size());
    }
  }
  // The lamps come after the light samples.
  static uint lampsOf(const testing::RandomBundle& made) {
    return made.light_weights.empty()
               ? kLightStride
               : kLightStride * static_cast<uint>(made.description.groups[0].light_samples.size() - 1);
  }
  uint size() const { return static_cast<uint>(words.size()); }
  void append(const std::vector<float>& values) {
    for (const float value : values) words.push_back(std::bit_cast<uint>(value));
  }
};

std::vector<std::vector<std::uint32_t>> codesOf(const testing::RandomBundle& made, std::size_t transfer) {
  std::vector<std::vector<std::uint32_t>> all;
  for (const streaming::PlaneReady& plane : made.planes[0]) {
    if (plane.transfer != transfer) continue;
    const std::size_t bytes =
        made.description.groups[0].cells[0].transfers[transfer].planes[plane.plane].bits / 8;
    auto& codes = all.emplace_back(plane.codes.size() / bytes, 0u);
    for (std::size_t i = 0; i < codes.size(); ++i) std::memcpy(&codes[i], &plane.codes[i * bytes], bytes);
  }
  return all;
}

// What all transfers of the cell give, decoded the plain way: [sample][output].
std::vector<glm::vec3> decodedTimesLight(const testing::RandomBundle& made,
                                         const std::vector<glm::vec4>& light, bool full) {
  std::vector<glm::vec3> out;
  for (std::size_t t = 0; t < made.codebooks[0].size(); ++t) {
    const bundle::TransferShape& shape = made.description.groups[0].cells[0].transfers[t].shape;
    const auto& positions = made.codebooks[0][t].positions;
    std::vector<std::uint32_t> cluster_of(positions.size());
    for (const std::uint32_t place : positions) cluster_of[place & 0xffff] = place >> 16;
    const std::vector<float> vectors =
        bundle::decodeTransfer(shape, made.codebooks[0][t].codebook, cluster_of, codesOf(made, t));
    out.resize(positions.size() * shape.outputs, glm::vec3(0.0f));
    const std::uint32_t first = full ? shape.shadowed_channels : 0;
    const std::uint32_t channels = full ? shape.full_channels : shape.shadowed_channels;
    for (std::size_t s = 0; s < positions.size(); ++s)
      for (std::uint32_t j = 0; j < shape.outputs; ++j)
        for (std::uint32_t c = 0; c < 3; ++c)
          for (std::uint32_t i = 0; i < shape.columns(); ++i) {
            const std::uint32_t channel = first + (channels == 3 ? c : 0);
            float arriving = 0.0f;
            if (shape.order == 0) {
              arriving = light[Page::lampsOf(made) + i][static_cast<int>(c)];
            } else if (made.light_weights.empty()) {
              arriving = light[i][static_cast<int>(c)];
            } else {
              const bundle::LightWeights& weights = made.light_weights[0].samples[s];
              for (std::size_t k = 0; k < 4; ++k)
                arriving += static_cast<float>(weights.weight[k]) / 255.0f *
                            light[kLightStride * weights.light[k] + i][static_cast<int>(c)];
            }
            out[s * shape.outputs + j][static_cast<int>(c)] +=
                vectors[s * shape.size() + (channel * shape.outputs + j) * shape.columns() + i] * arriving;
          }
  }
  return out;
}

}  // namespace

TEST(DiffuseTwin, ShadesSamplesAsDecodedTransferTimesLight) {
  testing::BundleMaker maker(4);
  for (const std::uint32_t clusters : {1u, 3u, 300u})
    for (const std::uint32_t lights : {1u, 7u})
      for (const std::uint32_t lamps : {0u, 5u})
        for (const bool mapped : {false, true})
          for (const bool full : {false, true}) {
            const testing::RandomBundle made = maker.make({.order = 3,
                                                           .shadowed_channels = mapped ? 3u : 1u,
                                                           .full_channels = mapped ? 1u : 3u,
                                                           .planes = 5,
                                                           .clusters = clusters,
                                                           .lamps = lamps,
                                                           .groups = 1,
                                                           .cells = mapped ? 0u : 1u,
                                                           .mapped_cells = mapped ? 1u : 0u,
                                                           .light_samples = lights});
            std::vector<glm::vec4> light = randomLight(maker, 3);
            for (std::uint32_t k = 2; k < lights; ++k) {
              const std::vector<glm::vec4> more = randomLight(maker, 3);
              light.insert(light.end(), more.begin(), more.end());
            }
            for (std::uint32_t k = 0; k < lamps; ++k)
              light.emplace_back(maker.uniform(0, 1), maker.uniform(0, 1), maker.uniform(0, 1), 0.0f);
            const std::vector<glm::vec3> expected = decodedTimesLight(made, light, full);
            std::vector<glm::vec4> samples(expected.size(), glm::vec4(0.0f));
            for (std::size_t t = 0; t < made.codebooks[0].size(); ++t) {
              const Page page(made, t, full);
              ref::Memory memory;
              memory.lights = light;
              memory.transfer = page.words;
              std::vector<glm::vec4> products(lights * page.words.size());
              ref::projectTransfer(memory, page.record, page.places, products);
              for (uint p = 0; p < page.record.sample_count; ++p)
                ref::shadePosition(memory, page.record, page.places, products, p, samples);
            }
            for (std::size_t i = 0; i < samples.size(); ++i) {
              // Values are of size 1, sums of 100 floats.
              EXPECT_LT(glm::distance(glm::vec3(samples[i]), expected[i]), 1e-4f)
                  << clusters << " clusters, " << lights << " lights";
              EXPECT_EQ(samples[i].w, 1.0f);
            }
          }
}

TEST(DiffuseTwin, MappedLightOfAnUnshadowedVertexIsTheLight) {
  testing::BundleMaker maker(5);
  const std::vector<glm::vec4> light = randomLight(maker, 3);
  ref::Memory memory;
  memory.lights = light;
  DrawRecord draw{};
  draw.rows_word = kNoRows;
  const ref::MappedLight found = ref::vertexLight(memory, draw, 0);
  for (std::size_t j = 0; j < 9; ++j) EXPECT_EQ(found[j], glm::vec3(light[j]));
}

}  // namespace lambent::effects::diffuse
