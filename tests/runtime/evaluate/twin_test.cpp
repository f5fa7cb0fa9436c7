// Compares projection and open samples, by the kernels as C++, with closed forms.
#include <gtest/gtest.h>

#include "runtime/evaluate/samples.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/gaunt.hpp"
#include "tests/runtime/effects/diffuse/diffuse_fixture.hpp"
#include "tests/support/glsl/glossy_kernels.hpp"

namespace lambent::evaluate {
namespace {

// Holds one vector of visibility, and light, in the layout of the kernels.
struct OneVector {
  std::uint32_t in, out;
  std::vector<uint> gaunt, page;
  std::vector<glm::vec4> lights;
  transfer::TransferRecord record{};

  OneVector(std::uint32_t bands_in, std::uint32_t bands_out)
      : in(bands_in), out(bands_out), gaunt(gauntWords(bands_in, bands_out)) {
    const std::uint32_t bands = in + out - 1;
    page.assign(bands * bands, 0);
    lights.assign(in * in, glm::vec4(0.0f));
    record.outputs = out * out;
    record.vector_size = bands * bands;
  }
  void setVisibility(std::size_t k, float value) { page[k] = std::bit_cast<uint>(value); }
  glm::vec4 output(uint i) const {
    transfer::glsl::ProjectVisibility kernel;
    kernel.lights = lights;
    kernel.page = page;
    kernel.gaunt = gaunt;
    return kernel.projectVisibility(record, 0, i, 0);
  }
};

}  // namespace

TEST(GlossyKernels, AnOpenSampleReceivesTheLightItself) {
  lambent::testing::BundleMaker maker(41);
  for (const std::uint32_t in : {3u, 5u, 6u})
    for (const std::uint32_t out : {4u, 5u, 6u}) {
      OneVector one(in, out);
      one.setVisibility(0, transfer::glsl::FillSamples::kSqrtFourPi);
      for (glm::vec4& light : one.lights) light = {maker.uniform(-1, 1), maker.uniform(-1, 1), 1.0f, 0.0f};
      for (uint i = 0; i < out * out; ++i) {
        const glm::vec4 expected = i < in * in ? one.lights[i] : glm::vec4(0.0f);
        const glm::vec4 got = one.output(i);
        EXPECT_LT(glm::distance(glm::vec3(got), glm::vec3(expected)), 1e-5f)
            << in << " in, " << out << " out";
        EXPECT_NEAR(got.w, i == 0 ? transfer::glsl::FillSamples::kSqrtFourPi : 0.0f, 1e-6f);
      }
    }
}

TEST(GlossyKernels, IsTheProductOfVisibilityAndLightPointByPoint) {
  // V and L of few bands: their product has no more bands than the outputs, so it holds in every direction.
  lambent::testing::BundleMaker maker(42);
  OneVector one(3, 5);
  for (std::size_t k = 0; k < 9; ++k) one.setVisibility(k, maker.uniform(-1, 1));
  for (glm::vec4& light : one.lights)
    light = {maker.uniform(-1, 1), maker.uniform(-1, 1), maker.uniform(-1, 1), 0.0f};
  for (int n = 0; n < 100; ++n) {
    const glm::vec3 direction = maker.direction();
    std::vector<float> y(25);
    sh::evaluate(5, direction, y);
    float visibility = 0.0f, visibility_out = 0.0f;
    glm::vec3 light(0.0f), product(0.0f);
    for (uint k = 0; k < 9; ++k) {
      visibility += y[k] * std::bit_cast<float>(one.page[k]);
      light += y[k] * glm::vec3(one.lights[k]);
    }
    for (uint i = 0; i < 25; ++i) {
      product += y[i] * glm::vec3(one.output(i));
      visibility_out += y[i] * one.output(i).w;
    }
    EXPECT_LT(glm::distance(product, visibility * light), 2e-5f);
    EXPECT_NEAR(visibility_out, visibility, 1e-5f);
  }
}

TEST(GlossyKernels, FillsOpenSamplesWithTheLightAndFullVisibility) {
  const std::vector<glm::vec4> lights(9, glm::vec4(1.0f, 2.0f, 3.0f, 0.0f));
  transfer::glsl::FillSamples kernel;
  kernel.lights = lights;
  transfer::FillRecord fill{
      .first_output = 0, .output_count = 25, .outputs = 25, .light = 0, .coefficients = 9, .open = 1};
  EXPECT_EQ(kernel.openLight(fill, 0), glm::vec4(1.0f, 2.0f, 3.0f, transfer::glsl::FillSamples::kSqrtFourPi));
  EXPECT_EQ(kernel.openLight(fill, 8), glm::vec4(1.0f, 2.0f, 3.0f, 0.0f));
  EXPECT_EQ(kernel.openLight(fill, 9), glm::vec4(0.0f));
  // Grid points of a neighborhood store changes, so unloaded ones give 0.
  fill.coefficients = fill.open = 0;
  for (std::uint32_t i = 0; i < 25; ++i) EXPECT_EQ(kernel.openLight(fill, i), glm::vec4(0.0f));
}

}  // namespace lambent::evaluate
