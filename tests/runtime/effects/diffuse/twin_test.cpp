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

TEST(DiffuseTwin, ShadesSamplesAsDecodedTransferTimesLight) {
  testing::BundleMaker maker(4);
  for (const std::uint32_t channels : {1u, 3u}) {
    const testing::RandomBundle made =
        maker.make({.order = 4, .channels = channels, .planes = 5, .cells = 1});
    const bundle::DiffuseTransfer& transfer = made.description.groups[0].cells[0].diffuse[0];
    const auto& basis = std::get<streaming::BasisReady>(made.bases[0]).vectors;
    const std::uint32_t samples = made.description.groups[0].cells[0].sample_count;
    const std::vector<glm::vec4> light = randomLight(maker, 4);
    // The page: basis, then planes, each from a whole word.
    std::vector<uint> page(basis.size());
    std::memcpy(page.data(), basis.data(), 4 * basis.size());
    std::vector<VectorRecord> vectors;
    std::vector<std::vector<std::uint32_t>> decoded;
    const uint length = channels * 16;
    for (uint j = 0; j <= transfer.planes.size(); ++j) {
      VectorRecord vector{j * length, 0, 1.0f, 0.0f, channels, 16, 4, j};
      if (j > 0) {
        const bundle::WeightPlane& plane = transfer.planes[j - 1];
        const auto& codes = made.planes[0][j - 1].codes;
        vector.codes = static_cast<uint>(page.size()) | (plane.bits == 16 ? kCodes16Bit : 0u);
        vector.offset = plane.offset;
        vector.scale = plane.scale;
        page.resize(page.size() + (codes.size() + 3) / 4);
        std::memcpy(&page[vector.codes & ~kCodes16Bit], codes.data(), codes.size());
        decoded.push_back(*bundle::decodePlane(codes, plane.bits, samples, "plane"));
      }
      vectors.push_back(vector);
    }
    const std::vector<float> plain = bundle::decodeTransfer(transfer, samples, basis, decoded);
    ref::Memory memory;
    memory.lights = light;
    memory.transfer = page;
    const CellRecord cell{.light = 0,
                          .first_vector = 0,
                          .vector_count = static_cast<uint>(vectors.size()),
                          .first_product = 0,
                          .plane_count = static_cast<uint>(vectors.size()) - 1,
                          .first_output = 0,
                          .sample_count = samples,
                          .order = 4};
    std::vector<Product> products(vectors.size());
    ref::projectCell(memory, cell, vectors, products);
    for (uint s = 0; s < samples; ++s) {
      glm::vec3 expected(0.0f);
      for (glm::length_t channel = 0; channel < 3; ++channel)
        for (std::size_t i = 0; i < 16; ++i)
          expected[channel] +=
              plain[(s * channels + (channels == 3 ? static_cast<uint>(channel) : 0u)) * 16 + i] *
              light[i][channel];
      const glm::vec4 got = ref::shadeSample(memory, cell, products, s);
      EXPECT_LT(glm::distance(glm::vec3(got), expected), 1e-4f);  // values are of size 1, sums of 100 floats
      EXPECT_EQ(got.w, 1.0f);
    }
  }
}

}  // namespace lambent::effects::diffuse
