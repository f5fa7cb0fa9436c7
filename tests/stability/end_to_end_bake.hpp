// Bakes scenes to a file and reads them back. It checks what every bake must hold: finite values, and no more
// light than arrives.
#pragma once

#include "baker/bake/bake.hpp"
#include "tests/support/decoded_bundle.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/program.hpp"
#include "tests/support/shapes.hpp"

namespace lambent::testing {

// Coded transfer may leave [0, 1] by this much under uniform light.
inline constexpr float kCodingTolerance = 1e-3f;

class EndToEndBake : public ProgramTest {
 protected:
  // The coding is fine, because these tests do not look for its error, whose bound is an RMS.
  static baker::BakeOptions options() {
    baker::BakeOptions options;
    options.quality = baker::Quality::Draft;
    options.order = 4;
    options.error_bound = 1e-4f;
    options.bounces = 0;  // direct light has closed forms, and a white scene with all bounces is white
    return options;
  }

  std::vector<DecodedDraw> bakeAndDecode(const baker::Scene& scene,
                                         const baker::BakeOptions& settings = options()) const {
    const std::filesystem::path path = folder / "scene.lmb.glb";
    baker::Progress progress;
    const auto report = baker::bake(scene, settings, path, {progress});
    EXPECT_TRUE(report) << report.error().line();
    if (!report) return {};
    auto draws = decodeBundle(path);
    EXPECT_TRUE(draws) << draws.error().line();
    if (!draws) return {};
    expectSane(*draws);
    return std::move(*draws);
  }

  // Returns the values of the darkest and the brightest vertex under uniform light.
  static std::pair<float, float> range(const std::vector<DecodedDraw>& draws) {
    std::pair<float, float> range{1e30f, -1e30f};
    for (const DecodedDraw& draw : draws)
      for (std::size_t v = 0; v < draw.mesh.positions.size(); ++v) {
        range.first = smaller(range.first, draw.uniformRadiance(v));
        range.second = larger(range.second, draw.uniformRadiance(v));
      }
    return range;
  }

 private:
  static void expectSane(const std::vector<DecodedDraw>& draws) {
    for (const DecodedDraw& draw : draws) {
      for (const float value : draw.transfer) ASSERT_TRUE(std::isfinite(value));
      for (const glm::vec3& normal : draw.mesh.normals) ASSERT_NEAR(glm::length(normal), 1.0f, 1e-3f);
    }
    const auto [darkest, lightest] = range(draws);
    EXPECT_GE(darkest, -kCodingTolerance);
    EXPECT_LE(lightest, 1.0f + kCodingTolerance);
  }
};

}  // namespace lambent::testing
