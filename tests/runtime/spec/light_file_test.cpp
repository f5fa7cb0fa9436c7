// Tests that light comes out as files say it, with pictures that other programs would write.
#include <array>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>

#include <OpenEXR/ImfArray.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineOutputFile.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <half.h>

#include "runtime/spec/distant_lights.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::spec {
namespace {

namespace fs = std::filesystem;

class LightFile : public ::testing::Test {
 protected:
  void SetUp() override {
    file_ = fs::path(::testing::TempDir()) /
            ("lambent_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
  }
  void TearDown() override { fs::remove(file_); }

  // Reads a Radiance picture with these lines in its header.
  Result<RgbImage> hdr(const std::string& lines, const std::string& rest) const {
    std::ofstream(file_, std::ios::binary) << "#?RADIANCE\n" << lines << "\n" << rest;
    return readLightImage(file_);
  }
  // A picture of one texel, whose components are multiples of 1/128 below 2.
  Result<RgbImage> oneTexel(const std::string& lines, glm::vec3 color) const {
    std::string texel = "-Y 1 +X 1\n";
    for (int channel = 0; channel < 3; ++channel)
      texel += static_cast<char>(static_cast<int>(128.0f * color[channel]));
    return hdr(lines, texel + '\x81');
  }
  static glm::vec3 first(const Result<RgbImage>& image) {
    EXPECT_TRUE(image) << image.error().line();
    return image ? image->texels.at(0) : glm::vec3(std::numeric_limits<float>::quiet_NaN());
  }
  static void expectColor(glm::vec3 color, glm::vec3 expected, float tolerance) {
    EXPECT_LE(glm::distance(color, expected), tolerance)
        << color.r << " " << color.g << " " << color.b << ", expected " << expected.r << " " << expected.g
        << " " << expected.b;
  }

  // Writes one texel of half floats.
  void writeHalves(glm::vec3 color, const std::optional<Imf::Chromaticities>& chromaticities) const {
    Imf::Header header(1, 1);
    if (chromaticities) Imf::addChromaticities(header, *chromaticities);
    const std::array<half, 3> values = {half(color.r), half(color.g), half(color.b)};
    Imf::FrameBuffer source;
    for (std::size_t i = 0; i < 3; ++i) {
      const char name[] = {"RGB"[i], '\0'};
      header.channels().insert(name, Imf::Channel(Imf::HALF));
      source.insert(name, Imf::Slice::Make(Imf::HALF, &values[i], header.dataWindow()));
    }
    Imf::OutputFile file(file_.c_str(), header);
    file.setFrameBuffer(source);
    file.writePixels(1);
  }

  fs::path file_;
};

TEST_F(LightFile, ExposuresAndColorCorrectionsOfAHeaderMultiplyAndAreDividedOut) {
  const glm::vec3 color(1.0f, 0.5f, 0.25f);
  EXPECT_EQ(first(oneTexel("EXPOSURE=0.25\n", color)), 4.0f * color);
  EXPECT_EQ(first(oneTexel("EXPOSURE=   5.000000e-01\r\nEXPOSURE=4\n", color)), 0.5f * color);
  EXPECT_EQ(first(oneTexel("COLORCORR= 2 1 .5\nEXPOSURE=.5\n", color)), glm::vec3(1.0f, 1.0f, 1.0f));
  EXPECT_EQ(first(oneTexel("pcomb\n\tEXPOSURE=8\n# EXPOSURE=8\n", color)), color) << "that of an input";
}

TEST_F(LightFile, LinesOfAHeaderWithoutUsableNumbersAreIgnoredWithANotice) {
  for (const char* line :
       {"EXPOSURE=", "EXPOSURE=0", "EXPOSURE=-1", "EXPOSURE=nan", "EXPOSURE=1e-30", "COLORCORR=1 2",
        "COLORCORR=1 0 1", "PRIMARIES=.3 .3 .3 .3 .3 .3 .3 .3", "PRIMARIES=1"}) {
    const Result<RgbImage> image = oneTexel(std::string(line) + "\n", glm::vec3(1.0f));
    EXPECT_EQ(first(image), glm::vec3(1.0f)) << line;
    ASSERT_EQ(image->notices.size(), 1u) << line;
    EXPECT_NE(image->notices[0].find(line), std::string::npos) << image->notices[0];
  }
  EXPECT_TRUE(oneTexel("PRIMARIES=0 0 0 0 0 0 0 0\n", glm::vec3(1.0f))->notices.empty())
      << "Photoshop writes it into every picture";
}

// The matrices are those that colour libraries print for these spaces, with Bradford's adaptation.
TEST_F(LightFile, ColorsOfOtherPrimariesBecomeThoseOfRec709) {
  const glm::vec3 color(0.5f, 0.75f, 0.25f);
  const auto times = [&](glm::vec3 r, glm::vec3 g, glm::vec3 b) {
    return glm::vec3(glm::dot(r, color), glm::dot(g, color), glm::dot(b, color));
  };
  struct Space {
    Imf::Chromaticities said;
    glm::vec3 expected;
  };
  const Imath::V2f d60(0.32168f, 0.33767f), d65(0.3127f, 0.3290f);
  const Space spaces[] = {
      {{{0.7347f, 0.2653f}, {0.0f, 1.0f}, {0.0001f, -0.077f}, d60},  // ACES AP0
       times({2.5217f, -1.1341f, -0.3876f}, {-0.2765f, 1.3727f, -0.0962f}, {-0.0154f, -0.1530f, 1.1683f})},
      {{{0.713f, 0.293f}, {0.165f, 0.830f}, {0.128f, 0.044f}, d60},  // ACEScg, AP1
       times({1.7051f, -0.6218f, -0.0833f}, {-0.1303f, 1.1408f, -0.0105f}, {-0.0240f, -0.1290f, 1.1530f})},
      {{{0.680f, 0.320f}, {0.265f, 0.690f}, {0.150f, 0.060f}, d65},  // Display P3
       times({1.2249f, -0.2249f, 0.0f}, {-0.0421f, 1.0421f, 0.0f}, {-0.0196f, -0.0786f, 1.0979f})},
      {{{0.708f, 0.292f}, {0.170f, 0.797f}, {0.131f, 0.046f}, d65},  // Rec. 2020
       times({1.6605f, -0.5876f, -0.0728f}, {-0.1246f, 1.1329f, -0.0083f}, {-0.0182f, -0.1006f, 1.1187f})},
  };
  for (const auto& [said, expected] : spaces) {
    std::string line = "PRIMARIES=";
    for (const Imath::V2f& xy : {said.red, said.green, said.blue, said.white})
      line += " " + std::to_string(xy.x) + " " + std::to_string(xy.y);
    writeHalves(color, said);
    expectColor(first(readLightImage(file_)), glm::max(expected, glm::vec3(0.0f)), 5e-4f);
    expectColor(glm::vec3(readExr(file_).value().texels[0]), expected, 5e-4f);
    expectColor(first(oneTexel(line + "\n", color)), glm::max(expected, glm::vec3(0.0f)), 5e-4f);
    expectColor(first(oneTexel(line + "\n", glm::vec3(1.0f))), glm::vec3(1.0f), 1e-5f);
  }
  writeHalves(color, Imf::Chromaticities());
  EXPECT_EQ(first(readLightImage(file_)), color) << "Rec. 709 is not touched";
  writeHalves(color, Imf::Chromaticities({0, 0}, {0, 0}, {0, 0}, {0, 0}));
  const Result<RgbImage> without = readLightImage(file_);
  EXPECT_EQ(first(without), color);
  EXPECT_EQ(without->notices.size(), 1u);
}

// A matrix would make NaN of the other channels.
TEST_F(LightFile, ASunThatHalfFloatsCannotHoldIsAsBrightAsTheyCanInAnyColors) {
  writeHalves(glm::vec3(std::numeric_limits<float>::infinity()),
              Imf::Chromaticities({.713f, .293f}, {.165f, .83f}, {.128f, .044f}, {.32168f, .33767f}));
  expectColor(first(readLightImage(file_)), glm::vec3(65504.0f), 1.0f);
}

TEST_F(LightFile, XyzBecomesRec709) {
  // A white of luminance 1 under D65, in steps of 1/128.
  expectColor(first(oneTexel("FORMAT=32-bit_rle_xyze\n", {0.9505f, 1.0f, 1.089f})), glm::vec3(1.0f), 0.02f);
  // Red of Rec. 709 has these tristimulus values.
  expectColor(first(oneTexel("FORMAT=32-bit_rle_xyze\n", {0.4124f, 0.2126f, 0.0193f})), {1.0f, 0.0f, 0.0f},
              0.03f);
}

// Writes the picture "012 / 345" in every order.
TEST_F(LightFile, EveryOrderOfScanlinesGivesTheSamePicture) {
  constexpr std::pair<const char*, const char*> kOrders[] = {
      {"-Y 2 +X 3", "012345"}, {"-Y 2 -X 3", "210543"}, {"+Y 2 +X 3", "345012"}, {"+Y 2 -X 3", "543210"},
      {"+X 3 -Y 2", "031425"}, {"+X 3 +Y 2", "304152"}, {"-X 3 -Y 2", "251403"}, {"-X 3 +Y 2", "524130"}};
  for (const auto& [order, texels] : kOrders) {
    std::string bytes = std::string(order) + "\n";
    for (const char value : std::string(texels))
      bytes += {static_cast<char>(16 * (value - '0')), 0, 0, '\x84'};
    const Result<RgbImage> image = hdr("", bytes);
    ASSERT_TRUE(image) << order << " " << image.error().line();
    ASSERT_EQ(image->width, 3u) << order;
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_EQ(image->texels[i].r, static_cast<float>(i)) << order << " " << i;
  }
}

// Writes parts of one texel each, with the named channels.
void writeParts(const fs::path& file, const std::vector<std::vector<std::string>>& parts) {
  std::vector<Imf::Header> headers;
  for (std::size_t part = 0; part < parts.size(); ++part) {
    Imf::Header& header = headers.emplace_back(1, 1);
    header.setName("part " + std::to_string(part));
    header.setType(Imf::SCANLINEIMAGE);
    for (const std::string& name : parts[part]) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
  }
  Imf::MultiPartOutputFile out(file.c_str(), headers.data(), static_cast<int>(headers.size()));
  for (std::size_t part = 0; part < parts.size(); ++part) {
    const float value = static_cast<float>(part + 1);
    Imf::FrameBuffer source;
    for (const std::string& name : parts[part])
      source.insert(name, Imf::Slice::Make(Imf::FLOAT, &value, headers[part].dataWindow()));
    Imf::OutputPart written(out, static_cast<int>(part));
    written.setFrameBuffer(source);
    written.writePixels(1);
  }
}

TEST_F(LightFile, ThePictureIsFoundAmongThePartsOfAFile) {
  writeParts(file_, {{"Z"}, {"A", "B", "G", "R"}, {"B", "G", "R"}});
  EXPECT_EQ(first(readLightImage(file_)), glm::vec3(2.0f));
  writeParts(file_, {{"Z"}, {"left.B", "left.G", "left.R"}});
  const Result<RgbImage> layers = readLightImage(file_);
  ASSERT_FALSE(layers);
  EXPECT_NE(layers.error().line().find("it has Z; left.B, left.G, left.R"), std::string::npos)
      << layers.error().line();
}

TEST_F(LightFile, DeepPicturesAndCroppedOnesWithoutAnyTexelAreRefusedByName) {
  {
    Imf::Header header(1, 1);
    header.setType(Imf::DEEPSCANLINE);
    header.compression() = Imf::ZIPS_COMPRESSION;
    unsigned count = 1;
    float value = 1.0f;
    float* samples = &value;
    Imf::DeepFrameBuffer source;
    source.insertSampleCountSlice(
        Imf::Slice(Imf::UINT, reinterpret_cast<char*>(&count), sizeof(count), sizeof(count)));
    for (const char* name : {"R", "G", "B", "A", "Z"}) {
      header.channels().insert(name, Imf::Channel(Imf::FLOAT));
      source.insert(name, Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(&samples), sizeof(samples),
                                         sizeof(samples), sizeof(value)));
    }
    Imf::DeepScanLineOutputFile file(file_.c_str(), header);
    file.setFrameBuffer(source);
    file.writePixels(1);
  }
  const Result<RgbImage> deep = readLightImage(file_);
  ASSERT_FALSE(deep);
  EXPECT_NE(deep.error().line().find("it has deep A, B, G, R, Z"), std::string::npos) << deep.error().line();
  {
    const float value = 1.0f;
    Imf::Header header(Imath::Box2i({0, 0}, {1, 0}), Imath::Box2i({5, 5}, {5, 5}));
    Imf::FrameBuffer source;
    for (const char* name : {"R", "G", "B"}) {
      header.channels().insert(name, Imf::Channel(Imf::FLOAT));
      source.insert(name, Imf::Slice::Make(Imf::FLOAT, &value, header.dataWindow()));
    }
    Imf::OutputFile file(file_.c_str(), header);
    file.setFrameBuffer(source);
    file.writePixels(1);
  }
  const Result<RgbImage> outside = readLightImage(file_);
  ASSERT_FALSE(outside);
  EXPECT_NE(outside.error().line().find("outside its display window"), std::string::npos)
      << outside.error().line();
}

}  // namespace
}  // namespace lambent::spec
