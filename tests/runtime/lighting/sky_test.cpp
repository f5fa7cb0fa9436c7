// The sky as drawn is the radiance of the environment as it stands: turned, faded and scaled.
#include "runtime/lighting/sky.hpp"

#include <vector>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "tests/support/gpu_context.hpp"

namespace lambent::lighting {

class SkyTest : public testing::GpuTest {
 protected:
  // What the middle pixel of a narrow picture shows that looks along dir.
  static glm::vec3 seen(const Sky& sky, const Environment& environment, glm::vec3 dir) {
    constexpr std::uint32_t kSide = 5;
    const gpu::Texture color("color", {.format = GL_RGBA32F, .width = kSide, .height = kSide});
    const gpu::Framebuffer target("target", color, nullptr);
    glBindFramebuffer(GL_FRAMEBUFFER, target.id());
    glViewport(0, 0, kSide, kSide);
    glClear(GL_COLOR_BUFFER_BIT);
    const glm::vec3 up = std::abs(dir.y) > 0.9f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
    gpu::Counters counters;
    sky.draw(environment, glm::lookAt(glm::vec3(0.0f), dir, up), glm::perspective(0.05f, 1.0f, 0.1f, 10.0f),
             kSide, counters);
    std::vector<glm::vec4> texels(kSide * kSide);
    glGetTextureImage(color.id(), 0, GL_RGBA, GL_FLOAT, static_cast<GLsizei>(texels.size() * 16),
                      texels.data());
    return glm::vec3(texels[kSide * kSide / 2]);
  }
};

TEST_F(SkyTest, ShowsTheMixOfBothSets) {
  auto environment = Environment::create(
      {spec::ConstantLight{.radiance = {1, 2, 3}},
       spec::SunLight{.azimuth_deg = 20, .elevation_deg = 0, .angle_deg = 8, .radiance = {4, 4, 4}}},
      {spec::ConstantLight{.radiance = {0, 0, 8}},
       spec::SunLight{.azimuth_deg = 90, .elevation_deg = 60, .angle_deg = 9, .radiance = {2, 0, 1}}});
  ASSERT_TRUE(environment);
  const auto sky = Sky::create(*environment);
  ASSERT_TRUE(sky) << sky.error().line();
  environment->setTurn(-30.0f);
  environment->setFade(0.75f);
  environment->setIntensity(2.0f);
  const auto expectSeen = [&](float azimuth, float elevation, glm::vec3 expected) {
    const glm::vec3 found = seen(*sky, *environment, spec::directionFromAzimuthElevation(azimuth, elevation));
    EXPECT_LT(glm::distance(found, expected), 1e-4f)
        << azimuth << ", " << elevation << ": " << found.r << " " << found.g << " " << found.b;
  };
  const glm::vec3 between(0.5f, 1.0f, 13.5f);  // 0.5 of the first set, 1.5 of the second
  expectSeen(120, -10, between);
  expectSeen(-10, 0, between + glm::vec3(2.0f));
  expectSeen(60, 60, between + glm::vec3(3.0f, 0.0f, 1.5f));
}

}  // namespace lambent::lighting
