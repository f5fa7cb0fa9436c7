// The container: what is written comes back, and nothing damaged gets through.
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "runtime/bundle/reader.hpp"
#include "runtime/bundle/transfer_codec.hpp"
#include "runtime/bundle/writer.hpp"

namespace lambent::bundle {
namespace {

namespace fs = std::filesystem;

class BundleFile : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("lambent-bundle-test-" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    path_ = folder_ / "scene.lmb.glb";
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string bytes() const {
    std::ifstream in(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void replace(const std::string& bytes) const {
    std::ofstream(path_, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }
  // Everything that the demo would read of the file.
  Result<void> readAll() const {
    auto reader = Reader::open(path_);
    if (!reader) return failAgain(reader.error());
    return reader->checkAll();
  }

  fs::path folder_, path_;
};

Blob blobOf(std::size_t size, unsigned first) {
  Blob blob(size);
  for (std::size_t i = 0; i < size; ++i) blob[i] = static_cast<std::byte>((first + 7 * i) & 255u);
  return blob;
}

// A description that uses every list but meshes (mesh_test.cpp has those), with values that are easy to lose.
struct Sample {
  Description description;
  std::vector<Blob> blobs;
};

Sample sampleBundle() {
  Sample s;
  Description& d = s.description;
  d.generator = {"lambent", "0.1.0", "x86-64-v3", {{"order", "2"}, {"rays", "64"}}};
  gltf::Node parent, child;
  parent.name = "root \"quoted\" \xc3\xa4";
  parent.children = {1};
  parent.movable = true;
  child.name = "child";
  child.parent = 0;
  child.camera = 0;
  child.parent_from_node[3] = glm::vec4(0.1f, -2.5e-7f, 3.0e8f, 1.0f);
  d.nodes = {parent, child};
  d.roots = {0};
  gltf::Material material;
  material.name = "leaf";
  material.base_color = {0.1f, 0.2f, 0.3f, 0.4f};
  material.base_color_texture = {0, 1};
  material.alpha_mode = gltf::AlphaMode::Mask;
  material.alpha_cutoff = 0.25f;
  material.double_sided = true;
  d.materials = {material};
  d.textures = {{0, {33071, 33648, 9728, 9985}}};
  d.images = {{"bark", "image/png", 0}};
  gltf::Camera camera;
  camera.name = "main";
  camera.yfov_rad = 0.7f;
  d.cameras = {camera};

  const std::vector<std::uint32_t> codes = {1, 65535, 7};
  const std::vector<float> basis = {0.5f, 0.25f, -0.125f, 1.0f, 0.75f, 0.0f, 1.0f, 2.0f};
  s.blobs = {blobOf(13, 1), encodeBasis(basis), compressZstd(encodePlane(codes, 16), 3)};
  d.payloads = {{PayloadType::TransferBasis, PayloadCodec::Raw, 1, 16, 1},
                {PayloadType::WeightPlane, PayloadCodec::Zstd, 2, 6, 2}};
  DiffuseTransfer transfer;
  transfer.order = 2;
  transfer.basis = 0;
  transfer.planes = {{1, 16, -0.5f, 0.001f, 0.9f}};
  transfer.error_bound = 0.005f;
  transfer.error = 0.004f;
  Cell cell{0, 3, glm::vec3(-1.0f), glm::vec3(1.0f), {transfer}};
  Group group;
  group.name = "root";
  group.node = 0;
  group.rest_translation = {1.0f, 2.0f, 3.0f};
  group.rest_rotation = glm::quat(0.5f, 0.5f, -0.5f, 0.5f);
  group.sample_count = 3;
  group.cells = {cell};
  d.groups = {group};
  return s;
}

TEST_F(BundleFile, GivesBackWhatWasWritten) {
  const Sample sample = sampleBundle();
  ASSERT_TRUE(write(path_, sample.description, sample.blobs));
  auto reader = Reader::open(path_);
  ASSERT_TRUE(reader) << reader.error().line();
  const Description& d = reader->description();
  ASSERT_EQ(d.nodes.size(), 2u);
  EXPECT_EQ(d.nodes[0].name, sample.description.nodes[0].name);
  EXPECT_TRUE(d.nodes[0].movable);
  EXPECT_EQ(d.nodes[1].parent, 0);
  EXPECT_EQ(d.nodes[1].parent_from_node, sample.description.nodes[1].parent_from_node);
  EXPECT_EQ(d.materials[0].base_color, sample.description.materials[0].base_color);
  EXPECT_EQ(d.materials[0].alpha_mode, gltf::AlphaMode::Mask);
  EXPECT_EQ(d.materials[0].alpha_cutoff, 0.25f);
  EXPECT_EQ(d.materials[0].base_color_texture.texcoord, 1u);
  EXPECT_EQ(d.textures[0].sampler, sample.description.textures[0].sampler);
  EXPECT_EQ(d.cameras[0].yfov_rad, 0.7f);
  EXPECT_EQ(d.groups[0].rest_rotation, sample.description.groups[0].rest_rotation);
  EXPECT_EQ(d.generator.settings.at("rays"), "64");
  const DiffuseTransfer& transfer = d.groups[0].cells[0].diffuse[0];
  EXPECT_EQ(transfer.planes[0].scale, 0.001f);
  EXPECT_EQ(transfer.error, 0.004f);
  EXPECT_EQ(*reader->readView(0), sample.blobs[0]);
  const auto plane = reader->readPayload(1);
  ASSERT_TRUE(plane) << plane.error().line();
  EXPECT_EQ(*decodePlane(*plane, 16, 3, "plane"), (std::vector<std::uint32_t>{1, 65535, 7}));
}

TEST_F(BundleFile, IsTheSameBytesTwice) {
  const Sample sample = sampleBundle();
  ASSERT_TRUE(write(path_, sample.description, sample.blobs));
  const std::string first = bytes();
  ASSERT_TRUE(write(path_, sample.description, sample.blobs));
  EXPECT_EQ(first, bytes());
}

TEST_F(BundleFile, TruncatedAtAnyPrefixIsRefusedInOneLine) {
  const Sample sample = sampleBundle();
  ASSERT_TRUE(write(path_, sample.description, sample.blobs));
  const std::string whole = bytes();
  for (std::size_t length = 0; length < whole.size(); ++length) {
    replace(whole.substr(0, length));
    const auto read = readAll();
    ASSERT_FALSE(read) << "prefix of " << length << " bytes";
    EXPECT_EQ(read.error().subject, path_.string());
    EXPECT_EQ(read.error().line().find('\n'), std::string::npos);
  }
  replace(whole + "x");
  EXPECT_FALSE(readAll());
}

TEST_F(BundleFile, AnyFlippedByteIsRefused) {
  const Sample sample = sampleBundle();
  ASSERT_TRUE(write(path_, sample.description, sample.blobs));
  const std::string whole = bytes();
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << (at % 8)));
    replace(damaged);
    const auto read = readAll();
    ASSERT_FALSE(read) << "byte " << at << " of " << whole.size();
    EXPECT_FALSE(read.error().mend.empty());
  }
}

TEST_F(BundleFile, TooNewIsCalledTooNew) {
  Sample sample = sampleBundle();
  sample.description.version = kVersionCurrent + 1;
  ASSERT_TRUE(write(path_, sample.description, sample.blobs));
  const auto reader = Reader::open(path_);
  ASSERT_FALSE(reader);
  EXPECT_NE(reader.error().problem.find("newer than this program's"), std::string::npos)
      << reader.error().line();
}

// Valid checksums around nonsense: what a hostile or buggy writer could make.
TEST_F(BundleFile, IndicesOutOfRangeAreRefusedByName) {
  const auto refused = [&](auto spoil, const char* place) {
    Sample sample = sampleBundle();
    spoil(sample.description);
    ASSERT_TRUE(write(path_, sample.description, sample.blobs));
    const auto reader = Reader::open(path_);
    ASSERT_FALSE(reader) << place;
    EXPECT_NE(reader.error().problem.find(place), std::string::npos) << reader.error().line();
  };
  refused([](Description& d) { d.roots = {2}; }, "scenes[0].nodes[0]");
  refused([](Description& d) { d.nodes[1].children = {0}; }, "nodes form a ring");
  refused([](Description& d) { d.images[0].view = 3; }, "images[0].bufferView");
  refused([](Description& d) { d.textures[0].image = 1; }, "textures[0].source");
  refused([](Description& d) { d.groups[0].cells[0].sample_count = 4; }, "sampleCount");
  refused([](Description& d) { d.groups[0].sample_count = 4; }, "do not hold all samples");
  refused([](Description& d) { d.groups[0].cells[0].diffuse[0].order = 9; }, "order");
  refused([](Description& d) { d.groups[0].cells[0].diffuse[0].channels = 3; }, "basis");
  refused([](Description& d) { d.groups[0].cells[0].diffuse[0].planes[0].payload = 0; }, "another type");
  refused([](Description& d) { d.payloads[0].raw_length = 17; }, "rawLength");
  refused([](Description& d) { d.groups[0].rest_rotation = glm::quat(0.0f, 0.0f, 0.0f, 0.0f); },
          "restRotation");
}

TEST_F(BundleFile, APlainGltfFileIsSaidNotToBeBaked) {
  std::string json = R"({"asset":{"version":"2.0"}})";
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const auto word = [](std::size_t value) {
    const auto v = static_cast<std::uint32_t>(value);
    std::string bytes(4, '\0');
    std::memcpy(bytes.data(), &v, 4);
    return bytes;
  };
  replace("glTF" + word(2) + word(28 + json.size()) + word(json.size()) + "JSON" + json + word(0) +
          std::string("BIN\0", 4));
  const auto reader = Reader::open(path_);
  ASSERT_FALSE(reader);
  EXPECT_NE(reader.error().problem.find("without baked transfer"), std::string::npos)
      << reader.error().line();
}

TEST_F(BundleFile, AFailedWriteLeavesTheOldFile) {
  replace("precious");
  const Sample sample = sampleBundle();
  const auto written = write(folder_ / "missing" / "scene.lmb.glb", sample.description, sample.blobs);
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().problem.find("folder does not exist"), std::string::npos);
  EXPECT_EQ(bytes(), "precious");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
}

}  // namespace
}  // namespace lambent::bundle
