#include "runtime/sh/light_vector.hpp"

#include <gtest/gtest.h>

#include "runtime/sh/zonal.hpp"

namespace lambent::sh {
namespace {

const glm::vec3 kDir = glm::vec3(0.36f, 0.48f, -0.8f);

TEST(ShLightVector, AddsAndScalesAsFunctionsDo) {
  const LightVector disc = discLight(5, {0, 1, 0}, 0.5, {1, 2, 3});
  const LightVector sky = constantLight(3, {0.5f, 0.25f, 0});
  const LightVector sum = 2.0f * disc + sky * glm::vec3(2, 4, 8);
  EXPECT_EQ(sum.order, 5);
  const glm::vec3 expected = 2.0f * disc.evaluate(kDir) + glm::vec3(1, 1, 0);
  for (int channel = 0; channel < 3; ++channel)
    EXPECT_NEAR(sum.evaluate(kDir)[channel], expected[channel], 1e-6f);
}

}  // namespace
}  // namespace lambent::sh
