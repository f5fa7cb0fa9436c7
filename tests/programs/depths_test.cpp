// Tests depths by rasterization and by rays: pictures of lambent-demo and of lambent reference have the same
// distances for the same surfaces, and compare says where they show different ones.
#include <cmath>

#include <nlohmann/json.hpp>

#include "baker/accuracy/compare.hpp"
#include "runtime/spec/image.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/program.hpp"
#include "tests/support/require.hpp"

namespace lambent {
namespace {

using testing::Outcome;

// Returns whether everything around the pixel is at nearly the same distance (2 %): one surface, not seen
// edge-on, where the rounding of positions (16 bits over a group) would change depths by far more.
bool isInsideASurface(const spec::RgbaImage& image, std::size_t pixel) {
  const std::size_t x = pixel % image.width, y = pixel / image.width;
  if (x == 0 || y == 0 || x + 1 == image.width || y + 1 == image.height) return false;
  const auto near = [&](std::size_t other) {
    return std::abs(image.depths[other] / image.depths[pixel] - 1.0f) < 0.02f;
  };
  return near(pixel - 1) && near(pixel + 1) && near(pixel - image.width) && near(pixel + image.width);
}

class Depths : public testing::ProgramTest {
 protected:
  std::string path(const std::string& name) const { return (folder / name).string(); }
};

}  // namespace

TEST_F(Depths, OfAReferenceAndOfTheDemoAgreeWhereTheyShowOneSurface) {
  const std::string scene = LAMBENT_BINARY_DIR "/assets/hello.glb";
  const Outcome baked = run(LAMBENT_PROGRAM, {"bake", scene, "-o", path("hello.lmb.glb"), "--quality",
                                              "draft", "--rays", "128", "--bounces", "0"});
  ASSERT_EQ(baked.exit_code, 0) << baked.err;
  for (const char* camera : {"main", "detail", "orbit:200,35,1.6,60"}) {
    const std::vector<std::string> words = {"--light", "constant:1,1,1", "--camera",
                                            camera,    "--size",         "192x144"};
    const auto with = [&](std::vector<std::string> first, const std::vector<std::string>& last) {
      first.insert(first.end(), words.begin(), words.end());
      first.insert(first.end(), last.begin(), last.end());
      return first;
    };
    const Outcome traced =
        run(LAMBENT_PROGRAM,
            with({"reference", scene}, {"--spp", "1", "--bounces", "0", "-o", path("reference.exr")}));
    ASSERT_EQ(traced.exit_code, 0) << traced.err;
    const Outcome shown = run(LAMBENT_DEMO, with({path("hello.lmb.glb")}, {"--headless", path("demo.exr")}));
    if (testing::lacksDevice(shown)) LAMBENT_LACKS("gl", shown.err);
    ASSERT_EQ(shown.exit_code, 0) << shown.err;

    const auto picture = spec::readExr(path("demo.exr")), reference = spec::readExr(path("reference.exr"));
    ASSERT_TRUE(picture && reference);
    ASSERT_EQ(picture->depths.size(), picture->texels.size());
    ASSERT_EQ(reference->depths.size(), picture->texels.size());
    std::size_t others = 0, inside = 0;
    float worst = 0.0f;
    for (std::size_t i = 0; i < picture->texels.size(); ++i) {
      // Nothing is blended here: there is a depth exactly where something covers.
      ASSERT_EQ(std::isfinite(picture->depths[i]), picture->texels[i].w > 0.0f) << i;
      ASSERT_EQ(std::isfinite(reference->depths[i]), reference->texels[i].w > 0.0f) << i;
      if (!std::isfinite(picture->depths[i]) || !std::isfinite(reference->depths[i])) continue;
      const float apart = std::abs(picture->depths[i] / reference->depths[i] - 1.0f);
      others += !(apart <= baker::kSameDepth);
      if (!isInsideASurface(*reference, i)) continue;
      ++inside;
      worst = testing::larger(worst, apart);
    }
    EXPECT_GT(inside, 5000u) << camera;
    EXPECT_LT(worst, 1e-4f) << camera;
    EXPECT_LE(others, 4u) << camera << ": outlines";

    const Outcome compared =
        run(LAMBENT_PROGRAM, {"compare", path("demo.exr"), path("reference.exr"), "--json"});
    ASSERT_EQ(compared.exit_code, 0) << compared.err;
    const auto figures = nlohmann::json::parse(compared.out);
    EXPECT_EQ(figures["sameSurface"]["pixelsLeftOut"], others);
    EXPECT_GT(figures["sameSurface"]["relativeRms"], 0.0);
    const Outcome words_of_it = run(LAMBENT_PROGRAM, {"compare", path("demo.exr"), path("reference.exr")});
    EXPECT_NE(words_of_it.out.find(fmt::format("; {} pixels show another surface", others)),
              std::string::npos)
        << words_of_it.out;
  }
}

}  // namespace lambent
