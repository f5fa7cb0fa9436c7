// Compares linear pictures, with one ray per pixel, of hello.glb as baked by `lambent` and shown by
// `lambent-demo`.
//
// hello_sky.exr is what the programs drew when the stored picture was last checked. To update it after an
// intended change: cmake --build --preset release --target golden-pictures
#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "runtime/spec/image.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/program.hpp"
#include "tests/support/require.hpp"

namespace lambent {
namespace {

constexpr const char* kStored = LAMBENT_SOURCE_DIR "/tests/golden/hello_sky.exr";
constexpr const char* kSky = LAMBENT_BINARY_DIR "/assets/sky.hdr";

bool isCovered(const glm::vec4& texel) {
  return texel.a > 0.5f;
}

// Returns sqrt(sum (X - A)² / sum A²) over pixels that are covered in both pictures.
double relativeRms(const spec::RgbaImage& x, const spec::RgbaImage& a) {
  double error = 0.0, energy = 0.0;
  for (std::size_t i = 0; i < a.texels.size(); ++i) {
    if (!isCovered(x.texels[i]) || !isCovered(a.texels[i])) continue;
    const glm::dvec3 value(a.texels[i]), off = glm::dvec3(x.texels[i]) - value;
    error += off.x * off.x + off.y * off.y + off.z * off.z;
    energy += value.x * value.x + value.y * value.y + value.z * value.z;
  }
  return std::sqrt(error / energy);
}

// Returns the largest channel of the difference.
float largest(const glm::vec3& difference) {
  const glm::vec3 size = glm::abs(difference);
  return std::max({size.r, size.g, size.b});
}

class HelloPicture : public testing::ProgramTest {
 protected:
  void SetUp() override {
    ProgramTest::SetUp();
    const auto baked = run(LAMBENT_PROGRAM, {"bake", LAMBENT_BINARY_DIR "/assets/hello.glb", "-o",
                                             (folder / "hello.lmb.glb").string(), "--quality", "draft"});
    ASSERT_EQ(baked.exit_code, 0) << baked.err;
  }
  // Draws a picture into a file of the test's folder. Skips the test if no picture can be drawn.
  void draw(const std::vector<std::string>& options, const std::string& file) const {
    std::vector<std::string> words = {(folder / "hello.lmb.glb").string(),
                                      "--size",
                                      "128x96",
                                      "--window",
                                      "off",
                                      "--headless",
                                      (folder / file).string()};
    words.insert(words.end(), options.begin(), options.end());
    const auto outcome = run(LAMBENT_DEMO, words);
    if (testing::lacksDevice(outcome)) LAMBENT_LACKS("gl", outcome.err);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  void show(const std::vector<std::string>& options, spec::RgbaImage& picture) const {
    draw(options, "picture.exr");
    if (IsSkipped() || HasFatalFailure()) return;
    auto read = spec::readExr(folder / "picture.exr");
    ASSERT_TRUE(read) << read.error().line();
    picture = std::move(*read);
    ASSERT_EQ(picture.texels.size(), 128u * 96u);
  }
  static std::size_t covered(const spec::RgbaImage& image) {
    return static_cast<std::size_t>(std::count_if(image.texels.begin(), image.texels.end(), isCovered));
  }
};

// Calls `use` with every pixel whose surroundings of 5 x 5 pixels are smooth: covered, with values within
// this share of the middle one's. A contour may cross pixels beside those whose centre it passes.
void forSmoothPixels(const spec::RgbaImage& picture, float share, const auto& use) {
  constexpr std::uint32_t kAround = 2;
  const std::uint32_t width = picture.width;
  const auto isSmooth = [&](std::size_t middle) {
    const glm::vec3 value(picture.texels[middle]);
    for (std::size_t row = middle - kAround * width; row <= middle + kAround * width; row += width)
      for (std::size_t i = row - kAround; i <= row + kAround; ++i)
        if (!isCovered(picture.texels[i]) ||
            !(largest((glm::vec3(picture.texels[i]) - value) / value) < share))
          return false;
    return true;
  };
  for (std::uint32_t y = kAround; y + kAround < picture.height; ++y)
    for (std::uint32_t x = kAround; x + kAround < width; ++x)
      if (const std::size_t i = std::size_t{y} * width + x; isSmooth(i)) use(i);
}

}  // namespace

TEST_F(HelloPicture, UnderTheSkyIsTheStoredOne) {
  const auto stored = spec::readExr(kStored);
  ASSERT_TRUE(stored) << stored.error().line();
  spec::RgbaImage picture;
  show({"--light", kSky}, picture);
  if (picture.texels.empty()) return;
  // Devices may disagree about single pixels of an outline.
  EXPECT_NEAR(static_cast<double>(covered(picture)), static_cast<double>(covered(*stored)), 20.0);
  EXPECT_LT(relativeRms(picture, *stored), 0.01);
}

TEST_F(HelloPicture, UnderUniformLightIsNeverBrighterThanItsAlbedo) {
  spec::RgbaImage shadowed, open;
  show({"--light", "constant:1,1,1"}, shadowed);
  if (shadowed.texels.empty()) return;
  show({"--light", "constant:1,1,1", "--transfer", "unshadowed"}, open);
  const std::vector<glm::vec3> albedos = {{0.7f, 0.68f, 0.64f}, {0.75f, 0.25f, 0.12f}, {0.2f, 0.4f, 0.7f}};
  std::size_t in_shadow = 0;
  for (std::size_t i = 0; i < open.texels.size(); ++i) {
    if (!isCovered(open.texels[i])) continue;
    // Without shadows every pixel shows the albedo of one of the three materials.
    float nearest = 1e9f;
    for (const glm::vec3& albedo : albedos)
      nearest = testing::smaller(nearest, glm::distance(glm::vec3(open.texels[i]), albedo));
    EXPECT_LT(nearest, 1e-3f) << i;
    for (int c = 0; c < 3; ++c) {
      EXPECT_GE(shadowed.texels[i][c], 0.0f) << i;
      // Transfer is coded to 1 % RMS at draft; single vertices may be three times as far.
      EXPECT_LE(shadowed.texels[i][c], 1.03f * open.texels[i][c]) << i;
    }
    in_shadow += shadowed.texels[i].r < 0.9f * open.texels[i].r;
  }
  EXPECT_GT(in_shadow, covered(open) / 50) << "where box and ball stand";
}

// PNG pictures are drawn with several samples a pixel. The edges of triangles cross smooth surfaces, and a
// pixel on one is made of several triangles there. Its colour must still be that of its surroundings:
// positions at the centroid of what each triangle covers, for example, drew dark lines.
TEST_F(HelloPicture, WithSeveralSamplesAPixelHasNoLinesWhereTheOneWithOneIsSmooth) {
  const std::vector<std::string> options = {"--keys",  "auto",
                                            "--light", "constant:0.3,0.3,0.3",
                                            "--light", "sun:40,50,3,200,150,100",
                                            "--light", "sphere:0,2.5,1,0.2,40,40,40"};
  spec::RgbaImage one;
  show(options, one);
  if (one.texels.empty()) return;
  draw(options, "picture.png");
  const auto several = spec::readPng(folder / "picture.png");
  ASSERT_TRUE(several) << several.error().line();
  const auto at = [&](std::size_t i) {
    const std::uint8_t* texel = several->texels.data() + 4 * i;
    return glm::vec3(texel[0], texel[1], texel[2]);
  };
  std::size_t smooth = 0, lines = 0;
  float farthest = 0.0f;
  forSmoothPixels(one, 0.1f, [&](std::size_t i) {
    const glm::vec3 across = 0.5f * (at(i - 1) + at(i + 1)),
                    along = 0.5f * (at(i - one.width) + at(i + one.width));
    const float off = largest(at(i) - 0.5f * (across + along));
    farthest = std::max(farthest, off);
    ++smooth;
    lines += off > 6.0f;  // of 255
  });
  EXPECT_GT(smooth, covered(one) / 3);
  EXPECT_EQ(lines, 0u) << "of " << smooth << "; the farthest differs by " << farthest;
}

}  // namespace lambent
