// Tests light probes with texels that are not finite or absurdly bright: the light stays finite and the
// repair is reported.
#include <limits>

#include "runtime/lighting/environment.hpp"
#include "runtime/spec/image.hpp"
#include "tests/support/program.hpp"

namespace lambent {

class HostileLight : public testing::ProgramTest {
 protected:
  // Makes a grey sky of 32 x 16 with `poison` in two of its texels.
  Result<lighting::Environment> skyWith(float poison) const {
    spec::RgbaImage image{32, 16, std::vector<glm::vec4>(32 * 16, glm::vec4(1.0f))};
    image.texels[100] = image.texels[101] = glm::vec4(glm::vec3(poison), 1.0f);
    const auto path = folder / "sky.exr";
    EXPECT_TRUE(spec::writeExr(path, image));
    return lighting::Environment::create({spec::EnvironmentMapLight{path, {}}});
  }
  static bool isFinite(const sh::LightVector& light) {
    for (const auto& c : light.c)
      if (!std::isfinite(c.x) || !std::isfinite(c.y) || !std::isfinite(c.z)) return false;
    return true;
  }
};

// What is too bright for a half counts as the brightest of them, as in suns of skies that overflowed.
TEST_F(HostileLight, TexelsThatAreInfiniteOrAbsurdCountAsTheLargestHalfAndAreTold) {
  for (const float poison : {std::numeric_limits<float>::infinity(), 1.1e15f, 1e30f, 3e38f}) {
    auto sky = skyWith(poison);
    ASSERT_TRUE(sky) << sky.error().line();
    ASSERT_EQ(sky->notices().size(), 1u) << poison;
    EXPECT_NE(sky->notices()[0].find("2 of "), std::string::npos) << sky->notices()[0];
    EXPECT_TRUE(isFinite(sky->light()));
    auto bright = skyWith(65504.0f);
    ASSERT_TRUE(bright);
    EXPECT_EQ(sky->light().c[0].x, bright->light().c[0].x) << poison;
  }
}

TEST_F(HostileLight, TexelsThatAreNotFiniteCountAsBlackAndAreTold) {
  for (const float poison :
       {std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::infinity(), -1e30f}) {
    auto sky = skyWith(poison);
    ASSERT_TRUE(sky) << sky.error().line();
    EXPECT_TRUE(isFinite(sky->light()));
    ASSERT_EQ(sky->notices().size(), 1u);
    EXPECT_NE(sky->notices()[0].find("2 texels"), std::string::npos) << sky->notices()[0];
    // Two of 512 texels are missing, which is less than the fraction of two texels at the equator.
    EXPECT_NEAR(sky->light().c[0].x, 3.5449077f, 3.5449077f * 2.0f / 512.0f * 1.6f);
    sky->setTurn(33.0f);
    EXPECT_TRUE(isFinite(sky->light()));
  }
}

TEST_F(HostileLight, TexelsOfRadianceThatIsStillLightAreTaken) {
  auto sky = skyWith(1e15f);
  ASSERT_TRUE(sky) << sky.error().line();
  EXPECT_TRUE(sky->notices().empty());
  EXPECT_TRUE(isFinite(sky->light()));
  // Two texels of 32 x 16 in the fourth row from the top.
  const float solid_angle =
      2.0f * (2.0f * 3.14159265f / 32.0f) * (3.14159265f / 16.0f) * std::sin(3.5f * 3.14159265f / 16.0f);
  EXPECT_NEAR(sky->light().c[0].x / (0.28209479f * 1e15f * solid_angle), 1.0f, 0.01f);
}

}  // namespace lambent
