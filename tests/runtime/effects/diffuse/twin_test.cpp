// Compares the kernels, compiled as C++, with closed forms and with plain decoding; needs no GPU.
#include <cstring>

#include <gtest/gtest.h>

#include "runtime/sh/basis.hpp"
#include "runtime/sh/zonal.hpp"
#include "tests/runtime/effects/diffuse/diffuse_fixture.hpp"
#include "tests/runtime/effects/diffuse/diffuse_kernels.hpp"

namespace lambent::effects::diffuse {
namespace {

// Makes the light at one light probe: without key lights, and of key lights alone if `keys`.
std::vector<glm::vec4> randomLight(testing::BundleMaker& maker, int order, bool keys = false) {
  std::vector<glm::vec4> light(transfer::kLightStride, glm::vec4(0.0f));
  for (const uint first : keys ? std::vector{0u, transfer::kKeyBlock} : std::vector{0u})
    for (uint i = 0; i < static_cast<uint>(order * order); ++i)
      light[first + i] = {maker.uniform(-1, 1), maker.uniform(-1, 1), maker.uniform(-1, 1), 0.0f};
  return light;
}

}  // namespace

TEST(DiffuseKernels, ShadesUnshadowedAsTheClosedFormOfOpenTransfer) {
  testing::BundleMaker maker(3);
  for (int order = 1; order <= 8; ++order) {
    const std::vector<glm::vec4> light = randomLight(maker, order);
    glsl::Vertices kernel;
    kernel.lights = light;
    for (int i = 0; i < 50; ++i) {
      const glm::vec3 normal = i == 0 ? glm::vec3(0, 0, 1) : i == 1 ? glm::vec3(0, -1, 0) : maker.direction();
      std::vector<float> transfer(static_cast<std::size_t>(order * order));
      sh::unoccludedTransfer(order, normal, transfer);
      glm::vec3 expected(0.0f);
      for (std::size_t k = 0; k < transfer.size(); ++k) expected += transfer[k] * glm::vec3(light[k]);
      const glm::vec3 got = kernel.unshadowedRadiance(normal, 0, order);
      // The tolerance is for float recurrences on up to 64 coefficients of size 1.
      EXPECT_LT(glm::distance(got, expected), 1e-5f * static_cast<float>(order)) << "order " << order;
    }
  }
}

namespace {

// Lays out a transfer in GPU memory as residency does, alone in its page.
struct Page {
  std::vector<uint> words, places;
  transfer::TransferRecord record{};

  Page(const testing::RandomBundle& made, std::size_t transfer_index, bool full, bool keys = false) {
    const bundle::CellTransfer& transfer = made.description.groups[0].cells[0].transfers[transfer_index];
    const transfer::TransferShape& shape = transfer.shape;
    const transfer::Codebook& codebook = made.codebooks[0][transfer_index].codebook;
    const auto& positions = made.codebooks[0][transfer_index].positions;
    const std::uint32_t lights =
        shape.order > 0 && !made.light_weights.empty()
            ? static_cast<std::uint32_t>(made.description.groups[0].light_probes.size()) - 1
            : 1;
    for (std::uint32_t k = 0; k < lights; ++k)
      places.push_back(shape.order > 0 ? transfer::kLightStride * k : lampsOf(made));
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
              .visibility = 0,
              .bounced = full && keys ? 1u : 0u,
              .straight_channels = keys ? shape.shadowed_channels : 0u,
              .apart = shape.order > 0 ? transfer::kKeyBlock : shape.light_columns,
              .pad = 0};
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
    for (const streaming::PlaneChunk& plane : made.planes[0]) {
      if (plane.transfer.value != transfer_index) continue;
      places.push_back(size() | (transfer.planes[plane.plane.value].bits == 16 ? transfer::kCodes16Bit : 0u));
      words.resize(words.size() + (plane.codes.size() + 3) / 4);
      std::memcpy(&words[places.back() & ~transfer::kCodes16Bit], plane.codes.data(), plane.codes.size());
    }
    if (lights > 1) {
      record.light_weights_word = size();
      const auto& weights = made.light_weights[0].samples;
      words.resize(words.size() + 2 * weights.size());
      std::memcpy(&words[record.light_weights_word], weights.data(), 8 * weights.size());
    }
  }
  // The lamps come after the light probes: the part of their light that is not shaded per pixel, then the
  // part that is.
  static uint lampsOf(const testing::RandomBundle& made) {
    return made.light_weights.empty()
               ? transfer::kLightStride
               : transfer::kLightStride *
                     static_cast<uint>(made.description.groups[0].light_probes.size() - 1);
  }
  uint size() const { return static_cast<uint>(words.size()); }
  void append(const std::vector<float>& values) {
    for (const float value : values) words.push_back(std::bit_cast<uint>(value));
  }
};

std::vector<std::vector<std::uint32_t>> codesOf(const testing::RandomBundle& made, std::size_t transfer) {
  std::vector<std::vector<std::uint32_t>> all;
  for (const streaming::PlaneChunk& plane : made.planes[0]) {
    if (plane.transfer.value != transfer) continue;
    const std::size_t bytes =
        made.description.groups[0].cells[0].transfers[transfer].planes[plane.plane.value].bits / 8;
    auto& codes = all.emplace_back(plane.codes.size() / bytes, 0u);
    for (std::size_t i = 0; i < codes.size(); ++i) std::memcpy(&codes[i], &plane.codes[i * bytes], bytes);
  }
  return all;
}

// Returns what all transfers of the cell give, decoded directly: [sample][output]. Of lights that are shaded
// per pixel it has only the bounces, full minus shadowed; w is 1 plus the luminance of their direct light.
std::vector<glm::vec4> decodedTimesLight(const testing::RandomBundle& made,
                                         const std::vector<glm::vec4>& light, bool full) {
  std::vector<glm::vec4> out;
  for (std::size_t t = 0; t < made.codebooks[0].size(); ++t) {
    const transfer::TransferShape& shape = made.description.groups[0].cells[0].transfers[t].shape;
    const auto& positions = made.codebooks[0][t].positions;
    std::vector<std::uint32_t> cluster_of(positions.size());
    for (const std::uint32_t place : positions) cluster_of[place & 0xffff] = place >> 16;
    const std::vector<float> vectors =
        transfer::decodeTransfer(shape, made.codebooks[0][t].codebook, cluster_of, codesOf(made, t));
    if (out.empty()) out.resize(positions.size() * shape.outputs, glm::vec4(0, 0, 0, 1));
    // Returns coefficient i of what arrives at a sample, from the block at this offset from the first.
    const auto arriving = [&](std::size_t s, std::uint32_t block, std::uint32_t i) {
      if (shape.order == 0)
        return glm::vec3(light[Page::lampsOf(made) + (block == 0 ? 0 : shape.light_columns) + i]);
      if (made.light_weights.empty()) return glm::vec3(light[block + i]);
      const transfer::LightWeights& weights = made.light_weights[0].samples[s];
      glm::vec3 sum(0.0f);
      for (std::size_t k = 0; k < 4; ++k)
        sum += static_cast<float>(weights.weight[k]) / 255.0f *
               glm::vec3(light[transfer::kLightStride * weights.light[k] + block + i]);
      return sum;
    };
    const auto times = [&](std::size_t s, std::uint32_t j, std::uint32_t first, std::uint32_t channels,
                           std::uint32_t block) {
      glm::vec3 sum(0.0f);
      for (std::uint32_t c = 0; c < 3 && channels > 0; ++c)
        for (std::uint32_t i = 0; i < shape.columns(); ++i) {
          const std::uint32_t channel = first + (channels == 3 ? c : 0);
          sum[static_cast<int>(c)] +=
              vectors[s * shape.size() + (channel * shape.outputs + j) * shape.columns() + i] *
              arriving(s, block, i)[static_cast<int>(c)];
        }
      return sum;
    };
    const std::uint32_t first = full ? shape.shadowed_channels : 0;
    const std::uint32_t channels = full ? shape.full_channels : shape.shadowed_channels;
    for (std::size_t s = 0; s < positions.size(); ++s)
      for (std::uint32_t j = 0; j < shape.outputs; ++j) {
        const glm::vec3 straight = times(s, j, 0, shape.shadowed_channels, transfer::kKeyBlock);
        glm::vec3 sum = times(s, j, first, channels, 0);
        if (full) sum += times(s, j, first, channels, transfer::kKeyBlock) - straight;
        const float luminance = glm::dot(straight, glsl::Vertices::kLuminance);
        out[s * shape.outputs + j] +=
            glm::vec4(sum, t == 0 && j == 0 ? std::max(luminance, 0.0f) : luminance);
      }
  }
  return out;
}

}  // namespace

TEST(DiffuseKernels, ShadesSamplesAsDecodedTransferTimesLight) {
  testing::BundleMaker maker(4);
  for (const bool keys : {false, true})
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
                                                             .light_probes = lights});
              std::vector<glm::vec4> light = randomLight(maker, 3, keys);
              for (std::uint32_t k = 2; k < lights; ++k) {
                const std::vector<glm::vec4> more = randomLight(maker, 3, keys);
                light.insert(light.end(), more.begin(), more.end());
              }
              for (std::uint32_t k = 0; k < 2 * lamps; ++k) {
                const float on = k < lamps || keys ? 1.0f : 0.0f;
                light.emplace_back(on * maker.uniform(0, 1), on * maker.uniform(0, 1),
                                   on * maker.uniform(0, 1), 0.0f);
              }
              const std::vector<glm::vec4> expected = decodedTimesLight(made, light, full);
              std::vector<glm::vec4> samples(expected.size(), glm::vec4(0.0f));
              for (std::size_t t = 0; t < made.codebooks[0].size(); ++t) {
                const Page page(made, t, full, keys);
                std::vector<glm::vec4> products(lights * page.words.size());
                transfer::glsl::shadeVectors({.lights = light,
                                              .page = page.words,
                                              .places = page.places,
                                              .gaunt = {},
                                              .products = products,
                                              .samples = samples},
                                             page.record);
              }
              for (std::size_t i = 0; i < samples.size(); ++i) {
                // Values are of size 1, sums of 100 floats.
                EXPECT_LT(glm::distance(samples[i], expected[i]), 1e-4f)
                    << clusters << " clusters, " << lights << " lights" << (keys ? ", key lights" : "");
                if (!keys) {
                  EXPECT_EQ(samples[i].w, 1.0f);
                }
              }
            }
}

TEST(DiffuseKernels, OfKeyLightsOnlyTheBouncesArriveAndBouncesWithATransferOfTheirOwnAlone) {
  // The result is the plain sum above, computed by hand: one column, one vector, no codes.
  std::vector<glm::vec4> light(transfer::kLightStride, glm::vec4(0.0f));
  light[0] = {1.0f, 2.0f, 3.0f, 0.0f};
  light[transfer::kKeyBlock] = {10.0f, 20.0f, 40.0f, 0.0f};
  constexpr float kShadowed = 0.5f;
  constexpr glm::vec3 kFull(0.75f, 1.0f, 1.25f);
  std::vector<uint> words;
  for (const float value : {kShadowed, kFull.r, kFull.g, kFull.b})
    words.push_back(std::bit_cast<uint>(value));
  transfer::glsl::ProjectVectors kernel;
  kernel.lights = light;
  kernel.page = words;
  const auto project = [&](const transfer::TransferRecord& record) {
    return kernel.projectOnLight(record, 0, 0, record.columns, 0);
  };
  transfer::TransferRecord record{};
  record.columns = record.outputs = record.order = 1;
  record.apart = transfer::kKeyBlock;
  record.channels = 3;
  record.vector_size = 4;
  record.first_value = 1;
  const glm::vec3 rest(light[0]), key(light[transfer::kKeyBlock]);
  EXPECT_EQ(project(record), glm::vec4(kFull * rest, 0.0f)) << "no key lights";
  record.bounced = 1;
  record.straight_channels = 1;
  EXPECT_EQ(project(record), glm::vec4(kFull * (rest + key) - kShadowed * key,
                                       glm::dot(kShadowed * key, glsl::Vertices::kLuminance)));
  record.channels = 1;  // without bounces
  record.first_value = 0;
  record.bounced = 0;
  EXPECT_EQ(project(record),
            glm::vec4(kShadowed * rest, glm::dot(kShadowed * key, glsl::Vertices::kLuminance)));
  record.channels = 3;  // bounces that have a transfer of their own: nothing of it is straight
  record.first_value = 1;
  record.bounced = 1;
  record.straight_channels = 0;
  EXPECT_EQ(project(record), glm::vec4(kFull * (rest + key), 0.0f));
}

}  // namespace lambent::effects::diffuse
