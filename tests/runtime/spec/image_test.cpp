// Tests that images survive a round trip, and that broken ones give one clear error and never more memory
// than their bytes warrant.
#include "runtime/spec/image.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>
#include <tuple>

#include <Imath/ImathBox.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <glm/common.hpp>
#include <gtest/gtest.h>
#include <zlib.h>

namespace lambent::spec {
namespace {

namespace fs = std::filesystem;

class SpecImage : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ =
        fs::path(::testing::TempDir()) / ("lambent spec " + std::string(test->name()));  // paths have spaces
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  static std::string read(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  fs::path folder_;
};

RgbImage noise(std::uint32_t width, std::uint32_t height, unsigned seed) {
  std::mt19937 random(seed);
  RgbImage image{width, height, {}};
  for (std::uint32_t i = 0; i < width * height; ++i) {
    const float scale = std::ldexp(1.0f, static_cast<int>(random() % 40) - 20);
    const auto unit = [&] { return static_cast<float>(random() % 100000) / 100000.0f; };
    // Half of the texels repeat, so that there are runs to code.
    if (i > 0 && random() % 2)
      image.texels.push_back(image.texels.back());
    else
      image.texels.push_back(scale * glm::vec3(unit(), unit(), unit()));
  }
  return image;
}

TEST_F(SpecImage, HdrRoundTripStaysWithinHalfAStepOfTheLargestChannel) {
  for (const auto& [width, height] : {std::pair{1u, 1u}, {7u, 3u}, {8u, 2u}, {300u, 5u}, {33000u, 1u}}) {
    const RgbImage image = noise(width, height, width);
    const fs::path path = folder_ / "noise.hdr";
    ASSERT_TRUE(writeHdr(path, image));
    const Result<RgbImage> back = readHdr(path);
    ASSERT_TRUE(back) << back.error().line();
    ASSERT_EQ(back->width, width);
    ASSERT_EQ(back->texels.size(), image.texels.size());
    for (std::size_t i = 0; i < image.texels.size(); ++i) {
      const glm::vec3 a = image.texels[i], b = back->texels[i];
      const float largest = std::max({a.x, a.y, a.z});
      for (int c = 0; c < 3; ++c) ASSERT_LE(std::abs(a[c] - b[c]), largest / 255.0f) << i;
    }
  }
}

TEST_F(SpecImage, HdrReadsOldRunsFlatTexelsAndCommentLines) {
  std::string bytes = "#?RGBE\n# made by hand\nEXPOSURE=1\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 9\n";
  bytes += std::string("\x80\x40\x20\x81", 4);  // 1, 0.5, 0.25
  bytes += std::string("\x01\x01\x01\x07", 4);  // seven times more
  bytes += std::string("\x00\x00\x00\x00", 4);  // black
  const Result<RgbImage> image = readHdr(write("old.hdr", bytes));
  ASSERT_TRUE(image) << image.error().line();
  for (std::size_t x = 0; x < 8; ++x) EXPECT_EQ(image->texels[x], glm::vec3(1.0f, 0.5f, 0.25f)) << x;
  EXPECT_EQ(image->texels[8], glm::vec3(0.0f));
}

TEST_F(SpecImage, HdrRefusesWhatItCannotHold) {
  RgbImage image{1, 1, {glm::vec3(-1.0f, 0.0f, 0.0f)}};
  EXPECT_FALSE(writeHdr(folder_ / "negative.hdr", image));
  image.texels[0] = glm::vec3(std::numeric_limits<float>::infinity());
  EXPECT_FALSE(writeHdr(folder_ / "infinite.hdr", image));
  EXPECT_FALSE(fs::exists(folder_ / "negative.hdr"));
}

TEST_F(SpecImage, ExrRoundTripIsExactAndKeepsNonFiniteValues) {
  RgbaImage image{5, 3, {}};
  std::mt19937 random(3);
  for (int i = 0; i < 15; ++i)
    image.texels.push_back(glm::vec4(random() % 1000, random() % 1000, -1.0f, 1.0f) / 7.0f);
  image.texels[4].x = std::numeric_limits<float>::infinity();
  const fs::path path = folder_ / "picture.exr";
  ASSERT_TRUE(writeExr(path, image));
  const Result<RgbaImage> back = readExr(path);
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(back->width, 5u);
  EXPECT_EQ(back->height, 3u);
  EXPECT_EQ(back->texels, image.texels);
  const Result<RgbImage> light = readLightImage(path);
  ASSERT_TRUE(light) << light.error().line();
  EXPECT_EQ(light->texels[7], glm::max(glm::vec3(image.texels[7]), glm::vec3(0.0f)));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);  // no part file left behind
}

TEST_F(SpecImage, ExrKeepsDepthsAndHasTheirChannelOnlyWhereThereAreAny) {
  RgbaImage image{3, 2, std::vector<glm::vec4>(6, glm::vec4(0.5f))};
  const fs::path with = folder_ / "with.exr", without = folder_ / "without.exr";
  ASSERT_TRUE(writeExr(without, image));
  image.depths = {1.5f, 1e-6f, std::numeric_limits<float>::infinity(), 0.1f, 3e5f, 2.0f};
  ASSERT_TRUE(writeExr(with, image));
  const auto channels = [](const fs::path& path) {
    const Imf::InputFile file(path.c_str());
    std::string names;
    for (auto it = file.header().channels().begin(); it != file.header().channels().end(); ++it)
      names += it.name();
    return names;
  };
  EXPECT_EQ(channels(with), "ABGRZ");
  EXPECT_EQ(channels(without), "ABGR");
  const Result<RgbaImage> back = readExr(with), bare = readExr(without);
  ASSERT_TRUE(back && bare);
  EXPECT_EQ(back->texels, image.texels);
  EXPECT_EQ(back->depths, image.depths);
  EXPECT_EQ(bare->texels, image.texels);
  EXPECT_TRUE(bare->depths.empty());
}

// Writes a tiled half-float image whose data window exceeds the display window on one side and falls short of
// it on the other.
TEST_F(SpecImage, ExrReadsTiledHalfFloatsAndOffsetDataWindows) {
  const fs::path path = folder_ / "tiled.exr";
  const Imath::Box2i display({0, 0}, {7, 7}), data({-2, 2}, {5, 9});
  std::vector<half> grey(64);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x)
      grey[static_cast<std::size_t>(8 * y + x)] = half(static_cast<float>(10 * (y + 2) + x - 2));
  Imf::Header header(display, data);
  header.compression() = Imf::PIZ_COMPRESSION;
  header.setTileDescription(Imf::TileDescription(4, 4));
  Imf::FrameBuffer source;
  for (const char* name : {"R", "G", "B", "Z"}) {
    header.channels().insert(name, Imf::Channel(Imf::HALF));
    source.insert(name, Imf::Slice::Make(Imf::HALF, grey.data(), data));
  }
  {
    Imf::TiledOutputFile file(path.c_str(), header);
    file.setFrameBuffer(source);
    file.writeTiles(0, 1, 0, 1);
  }
  const Result<RgbaImage> image = readExr(path);
  ASSERT_TRUE(image) << image.error().line();
  ASSERT_EQ(image->width, 8u);
  EXPECT_EQ(image->texels[8 * 3 + 4], glm::vec4(34, 34, 34, 1));  // row 3, column 4
  EXPECT_EQ(image->texels[8 * 1 + 4], glm::vec4(0));              // above the data window
  EXPECT_EQ(image->texels[8 * 3 + 6], glm::vec4(0));              // right of it
  ASSERT_EQ(image->depths.size(), 64u);
  EXPECT_EQ(image->depths[8 * 3 + 4], 34.0f);
  EXPECT_EQ(image->depths[8 * 1 + 4], std::numeric_limits<float>::infinity());
  EXPECT_EQ(image->depths[8 * 3 + 6], std::numeric_limits<float>::infinity());
}

TEST_F(SpecImage, PngRoundTripIsExact) {
  std::mt19937 random(5);
  Rgba8Image image{13, 9, {}};
  for (int i = 0; i < 13 * 9 * 4; ++i) image.texels.push_back(static_cast<std::uint8_t>(random()));
  const fs::path path = folder_ / "picture.png";
  ASSERT_TRUE(writePng(path, image));
  const Result<Rgba8Image> back = readPng(path);
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(back->width, 13u);
  EXPECT_EQ(back->texels, image.texels);
  EXPECT_FALSE(readPng(write("not.png", "GIF89a")));
}

TEST_F(SpecImage, PngSaysThatItIsSrgbBeforeThePixels) {
  ASSERT_TRUE(writePng(folder_ / "picture.png", {2, 1, {1, 2, 3, 4, 5, 6, 7, 8}}));
  const std::string file = read(folder_ / "picture.png");
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = (value << 8) | static_cast<std::uint8_t>(file[at + i]);
    return value;
  };
  std::size_t at = 8 + 25;  // after the signature and IHDR
  // The perceptual intent in one byte; 1 / 2.2; x of white, 0.3127.
  for (const auto& [name, size, first] :
       {std::tuple{"sRGB", 1u, 0u}, {"gAMA", 4u, 45455u}, {"cHRM", 32u, 31270u}}) {
    EXPECT_EQ(file.substr(at + 4, 4), name);
    ASSERT_EQ(number(at), size);
    EXPECT_EQ(number(at + 8) >> (size < 4 ? 24 : 0), first) << name;
    const auto* named = reinterpret_cast<const Bytef*>(file.data() + at + 4);
    EXPECT_EQ(number(at + 8 + size), ::crc32(0, named, size + 4)) << name;
    at += 12 + size;
  }
  EXPECT_EQ(file.substr(at + 4, 4), "IDAT");
}

TEST_F(SpecImage, ExrSaysThatItsColoursAreThoseOfRec709) {
  ASSERT_TRUE(writeExr(folder_ / "picture.exr", {1, 1, {glm::vec4(1.0f)}}));
  const Imf::InputFile file((folder_ / "picture.exr").c_str());
  ASSERT_TRUE(Imf::hasChromaticities(file.header()));
  const Imf::Chromaticities& said = Imf::chromaticities(file.header());
  EXPECT_EQ(said.red, Imath::V2f(0.64f, 0.33f));
  EXPECT_EQ(said.green, Imath::V2f(0.30f, 0.60f));
  EXPECT_EQ(said.blue, Imath::V2f(0.15f, 0.06f));
  EXPECT_EQ(said.white, Imath::V2f(0.3127f, 0.3290f));
}

TEST_F(SpecImage, MissingAndForeignFilesAreToldApart) {
  const auto problem = [](const Result<RgbImage>& result) {
    return result ? std::string("read") : result.error().problem;
  };
  EXPECT_EQ(problem(readLightImage(folder_ / "none.hdr")), "no such file");
  EXPECT_EQ(problem(readLightImage(folder_)), "is a folder");
  EXPECT_EQ(problem(readLightImage(write("empty.hdr", ""))), "is empty");
  EXPECT_EQ(problem(readLightImage(write("text.hdr", "hello world"))),
            "is neither Radiance (.hdr) nor OpenEXR (.exr)");
  EXPECT_NE(problem(readLightImage(write("turned.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n+X 4 -X 4\n")))
                .find("size line"),
            std::string::npos);
  EXPECT_NE(
      problem(readLightImage(write("spectra.hdr", "#?RADIANCE\nFORMAT=Radiance_spectra\n\n-Y 1 +X 1\n")))
          .find("FORMAT=Radiance_spectra"),
      std::string::npos);
  EXPECT_FALSE(writeExr(folder_ / "no such folder" / "a.exr", {1, 1, {glm::vec4(1.0f)}}));
}

TEST_F(SpecImage, AbsurdSizesAreRefusedBeforeMemoryIsAsked) {
  const std::string head = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n";
  for (const char* size :
       {"-Y 100000 +X 100000\n", "-Y 0 +X 5\n", "-Y 16384 +X 8192\nabc", "-Y 18446744073709551615 +X 2\n",
        "-Y 99999999999999999999999 +X 2\n", "-Y -5 +X 5\n"})
    EXPECT_FALSE(readLightImage(write("absurd.hdr", head + size))) << size;
}

// Every truncation must fail. Every flipped byte must give an image or an error, within the bounds of memory
// (the sanitizer run checks those).
void breakInEveryWay(const fs::path& path, const std::string& whole, std::size_t step) {
  for (std::size_t length = 0; length < whole.size(); length += step) {
    std::ofstream(path, std::ios::binary) << whole.substr(0, length);
    EXPECT_FALSE(readLightImage(path)) << length << " of " << whole.size();
  }
  std::mt19937 random(11);
  for (int i = 0; i < 300; ++i) {
    std::string broken = whole;
    broken[random() % broken.size()] = static_cast<char>(random());
    std::ofstream(path, std::ios::binary) << broken;
    const Result<RgbImage> image = readLightImage(path);
    if (image) {
      EXPECT_EQ(image->texels.size(), std::size_t{image->width} * image->height);
    }
  }
}

TEST_F(SpecImage, BrokenHdrFilesGiveErrors) {
  const fs::path path = folder_ / "whole.hdr";
  ASSERT_TRUE(writeHdr(path, noise(32, 8, 2)));
  breakInEveryWay(folder_ / "broken.hdr", read(path), 1);
}

TEST_F(SpecImage, BrokenExrFilesGiveErrors) {
  const fs::path path = folder_ / "whole.exr";
  RgbaImage image{32, 8, {}};
  for (const glm::vec3 texel : noise(32, 8, 2).texels) {
    image.texels.emplace_back(texel, 1.0f);
    image.depths.push_back(texel.x);
  }
  ASSERT_TRUE(writeExr(path, image));
  breakInEveryWay(folder_ / "broken.exr", read(path), 7);
}

TEST(SpecDisplay, MapsLightToTheColoursOfAScreen) {
  const RgbaImage linear{
      5,
      1,
      {glm::vec4(0.0f), glm::vec4(0.18f, 0.18f, 0.18f, 1.0f), glm::vec4(-1.0f, -1.0f, -1.0f, 1.0f),
       glm::vec4(1e9f, 1e9f, 1e9f, 1.0f), glm::vec4(0.5f, 0.2f, 0.1f, 1.0f)}};
  const Rgba8Image shown = displayed(linear);
  ASSERT_EQ(shown.texels.size(), 20u);
  const auto red = [&](std::size_t i) { return int{shown.texels[4 * i]}; };
  EXPECT_EQ(red(0), 0);
  EXPECT_EQ(red(1), 105) << "0.18 - 0.04, in sRGB";
  EXPECT_EQ(red(2), 0);
  EXPECT_EQ(red(3), 255);
  EXPECT_EQ(red(4), 181) << "0.5 - 0.04";
  EXPECT_EQ(shown.texels[18], 69) << "0.1 - 0.04";
}

}  // namespace
}  // namespace lambent::spec
