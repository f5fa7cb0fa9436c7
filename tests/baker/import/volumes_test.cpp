// Tests volumes and requests for neighborhoods: extras of nodes, and the files that they name.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "baker/import/density_file.hpp"
#include "baker/import/gltf.hpp"
#include "tests/baker/import/gltf_writer.hpp"
#include "tests/support/shared_data.hpp"

namespace lambent::baker {
namespace {

using nlohmann::json;
using testing::GltfWriter;
using testing::imported;
using testing::oneTriangle;
using testing::refusal;
using testing::TemporaryFolder;

constexpr const char* kHeader =
    "NRRD0004\n# made by hand\ntype: float\ndimension: 3\nsizes: 2 1 3\nspacings: 2 1 0.5\nendian: "
    "little\nencoding: raw\nkey:=value\n\n";

template <typename T>
std::string bytesOf(const std::vector<T>& values) {
  return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

std::string sixFloats(std::vector<float> values = {0, 1, 2, 3, 4, 5}) {
  return bytesOf(values);
}

GltfWriter withVolume(const json& volume) {
  GltfWriter writer = oneTriangle();
  writer.json["nodes"].push_back(
      {{"translation", {1, 2, 3}}, {"extras", {{"lambent", {{"volume", volume}}}}}});
  writer.json["scenes"][0]["nodes"].push_back(1);
  return writer;
}

TEST(Volume, IsReadFromNrrdWithItsPlacement) {
  TemporaryFolder folder;
  folder.write("fog.nrrd", kHeader + sixFloats());
  const Scene scene = imported(
      withVolume({{"file", "fog.nrrd"}, {"density_scale", 0.5}, {"albedo", {1, 0.5, 0}}, {"g", 0.25}}),
      folder);
  ASSERT_EQ(scene.volumes.size(), 1u);
  const SceneVolume& volume = scene.volumes[0];
  EXPECT_EQ(volume.node, 1u);
  EXPECT_EQ(volume.size, glm::uvec3(2, 1, 3));
  EXPECT_EQ(volume.density, (std::vector<float>{0, 0.5f, 1, 1.5f, 2, 2.5f}));
  EXPECT_EQ(volume.albedo, glm::vec3(1, 0.5f, 0));
  EXPECT_EQ(volume.g, 0.25f);
  EXPECT_EQ(glm::vec3(volume.node_from_grid * glm::vec4(2, 1, 3, 1)), glm::vec3(4, 1, 1.5f));
  EXPECT_EQ(volume.name, "fog.nrrd");
}

TEST(Volume, TakesAllKindsOfNumbersInBothByteOrders) {
  TemporaryFolder folder;
  const auto write = [&](const char* name, const char* type, const char* endian, const std::string& values) {
    return folder.write(name, std::string("NRRD0005\ntype: ") + type +
                                  "\ndimension: 3\nsizes: 2 1 1\nendian: " + endian + "\nencoding: raw\n\n" +
                                  values);
  };
  const std::vector<float> wanted{3, 200};
  const auto big = [](auto values) {
    for (auto& value : values) {
      auto bytes = std::bit_cast<std::array<char, sizeof(value)>>(value);
      std::reverse(bytes.begin(), bytes.end());
      value = std::bit_cast<std::remove_reference_t<decltype(value)>>(bytes);
    }
    return bytesOf(values);
  };
  for (const auto& file :
       {write("a.nrrd", "float", "big", big(wanted)),
        write("b.nrrd", "double", "little", bytesOf<double>({3, 200})),
        write("c.nrrd", "uchar", "little", bytesOf<std::uint8_t>({3, 200})),
        write("d.nrrd", "unsigned short", "big", big(std::vector<std::uint16_t>{3, 200}))}) {
    const auto grid = readNrrd(file);
    ASSERT_TRUE(grid) << grid.error().line();
    EXPECT_EQ(grid->values, wanted) << file;
  }
}

TEST(Volume, StandsAtTheSpaceOriginWithItsFirstVoxelsCentre) {
  TemporaryFolder folder;
  const auto grid = readNrrd(folder.write(
      "a.nrrd",
      "NRRD0004\ntype: float\ndimension: 3\nspace dimension: 3\nsizes: 2 1 3\nspace directions: (0,2,0) "
      "(1,0,0) (0,0,4)\nspace origin: (10,20,30)\nendian: little\nencoding: raw\n\n" +
          sixFloats()));
  ASSERT_TRUE(grid) << grid.error().line();
  EXPECT_EQ(glm::dvec3(grid->file_from_grid * glm::dvec4(0.5, 0.5, 0.5, 1)), glm::dvec3(10, 20, 30));
  EXPECT_EQ(glm::dvec3(grid->file_from_grid * glm::dvec4(1.5, 0.5, 2.5, 1)), glm::dvec3(10, 22, 38));
}

TEST(Volume, RefusesNrrdFilesThatItDoesNotKnowByTheirFault) {
  TemporaryFolder folder;
  const auto refused = [&](const std::string& from, const std::string& to,
                           const std::string& values = sixFloats()) {
    std::string text = kHeader;
    if (!from.empty()) text.replace(text.find(from), from.size(), to);
    const auto grid = readNrrd(folder.write("a.nrrd", text + values));
    EXPECT_FALSE(grid);
    return grid ? std::string() : grid.error().line();
  };
  const auto has = [](const std::string& line, const char* word) {
    return line.find(word) != std::string::npos;
  };
  EXPECT_TRUE(has(refused("NRRD0004", "NRXD0004"), "does not begin like"));
  EXPECT_TRUE(has(refused("dimension: 3", "dimension: 2"), "2 dimensions"));
  EXPECT_TRUE(has(refused("type: float", "type: int"), "\"int\""));
  EXPECT_TRUE(has(refused("encoding: raw", "encoding: bzip2"), "bzip2"));
  EXPECT_TRUE(has(refused("endian: little\n", ""), "endian"));
  EXPECT_TRUE(has(refused("sizes: 2 1 3", "sizes: 2 1"), "sizes"));
  EXPECT_TRUE(has(refused("sizes: 2 1 3", "sizes: 2 1 0"), "2 x 1 x 0"));
  EXPECT_TRUE(has(refused("sizes: 2 1 3", "sizes: 99999 99999 99999"), "voxels"));
  EXPECT_TRUE(has(refused("spacings: 2 1 0.5", "spacings: 2 1 0"), "flat"));
  EXPECT_TRUE(has(refused("# made by hand", "data file: b.raw"), "data file"));
  EXPECT_TRUE(has(refused("# made by hand", "type: float"), "twice"));
  EXPECT_TRUE(has(refused("", "", sixFloats({1, 2, 3})), "12 bytes"));
  EXPECT_TRUE(has(refused("", "", sixFloats() + "x"), "25 bytes"));
  const auto cut = readNrrd(folder.write("cut.nrrd", std::string(kHeader).substr(0, 40)));
  ASSERT_FALSE(cut);
  EXPECT_TRUE(has(cut.error().line(), "within its header"));
}

TEST(Volume, CountsDensitiesThatAreNoneAndTakesThemAsZero) {
  TemporaryFolder folder;
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  folder.write("fog.nrrd", kHeader + sixFloats({nan, 1, -2, inf, -inf, 5}));
  const Scene scene = imported(withVolume({{"file", "fog.nrrd"}}), folder);
  ASSERT_EQ(scene.volumes.size(), 1u);
  EXPECT_EQ(scene.volumes[0].density, (std::vector<float>{0, 1, 0, 0, 0, 5}));
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("4 of 6 densities"), std::string::npos) << scene.warnings[0];
}

TEST(Volume, OfAGivenSizeIsCentredOnItsNode) {
  TemporaryFolder folder;
  folder.write("fog.nrrd", kHeader + sixFloats());
  const Scene scene = imported(withVolume({{"file", "fog.nrrd"}, {"size", {4, 2, 1}}}), folder);
  ASSERT_EQ(scene.volumes.size(), 1u);
  const glm::mat4& m = scene.volumes[0].node_from_grid;
  EXPECT_EQ(glm::vec3(m * glm::vec4(0, 0, 0, 1)), glm::vec3(-2, -1, -0.5f));
  EXPECT_EQ(glm::vec3(m * glm::vec4(2, 1, 3, 1)), glm::vec3(2, 1, 0.5f));
}

TEST(Volume, IsRefusedByWhatIsWrongWithIt) {
  TemporaryFolder folder;
  folder.write("fog.txt", "fog");
  const auto says = [&](const json& volume, const char* word) {
    const std::string line = refusal(withVolume(volume), folder);
    return line.find(word) != std::string::npos ? std::string() : line;
  };
  EXPECT_EQ(says(json::object(), "names no file"), "");
  EXPECT_EQ(says({{"file", 3}}, "not a string"), "");
  EXPECT_EQ(says(json::array(), "not an object"), "");
  EXPECT_EQ(says({{"file", "fog.nrrd"}}, "no such file"), "");
  EXPECT_EQ(says({{"file", "fog.txt"}}, "neither .vdb nor .nrrd"), "");
  EXPECT_EQ(says({{"file", "../fog.nrrd"}}, "outside"), "");
  EXPECT_EQ(says({{"file", "https://example.com/fog.nrrd"}}, "not a file beside"), "");
  EXPECT_EQ(says({{"file", "procedural:fog"}}, "procedural:cloud,SEED"), "");
  EXPECT_EQ(says({{"file", "procedural:cloud,-1"}}, "procedural:cloud,SEED"), "");
  EXPECT_EQ(says({{"file", "a.nrrd"}, {"g", 1}}, "g is 1"), "");
  EXPECT_EQ(says({{"file", "a.nrrd"}, {"density_scale", -1}}, "density_scale"), "");
  EXPECT_EQ(says({{"file", "a.nrrd"}, {"albedo", {0, 0, 2}}}, "albedo"), "");
  EXPECT_EQ(says({{"file", "a.nrrd"}, {"albedo", {0, 0}}}, "albedo"), "");
  EXPECT_EQ(says({{"file", "a.nrrd"}, {"size", {1, 0, 1}}}, "size"), "");
  folder.write("broken.vdb", "not a vdb at all");
  EXPECT_EQ(says({{"file", "broken.vdb"}}, "cannot be read"), "");
}

TEST(Neighborhood, IsAskedForWithSizeAndExtentOrWithout) {
  TemporaryFolder folder;
  GltfWriter writer = oneTriangle();
  json& extras = writer.json["nodes"][0]["extras"];
  extras = {
      {"lambent", {{"movable", true}, {"neighborhood", {{"size", {64, 64, 8}}, {"extent", {4, 4, 0.5}}}}}}};
  Scene scene = imported(writer, folder);
  ASSERT_EQ(scene.neighborhoods.size(), 1u);
  EXPECT_EQ(scene.neighborhoods[0].node, 0u);
  EXPECT_EQ(scene.neighborhoods[0].size, glm::uvec3(64, 64, 8));
  EXPECT_EQ(scene.neighborhoods[0].extent, glm::vec3(4, 4, 0.5f));

  extras["lambent"]["neighborhood"] = json::object();
  scene = imported(writer, folder);
  ASSERT_EQ(scene.neighborhoods.size(), 1u);
  EXPECT_EQ(scene.neighborhoods[0].size, glm::uvec3(0));
  EXPECT_EQ(scene.neighborhoods[0].extent, glm::vec3(0.0f));

  extras["lambent"]["neighborhood"] = {{"size", {64, 64, 1}}};
  EXPECT_NE(refusal(writer, folder).find("not between 2 and 256"), std::string::npos);
  extras["lambent"]["neighborhood"] = {{"extent", {1, -1, 1}}};
  EXPECT_NE(refusal(writer, folder).find("extent"), std::string::npos);
}

TEST(ProceduralCloud, IsDenseInsideEmptyAtItsFacesFlatBelowAndTheSameEachTime) {
  const DensityGrid cloud = proceduralCloud(7);
  ASSERT_EQ(cloud.size, glm::uvec3(96, 64, 96));
  EXPECT_EQ(cloud.values, proceduralCloud(7).values);
  EXPECT_NE(cloud.values, proceduralCloud(8).values);
  std::size_t filled = 0;
  std::vector<std::uint32_t> lowest;  // filled voxel of each column
  for (std::uint32_t z = 0; z < 96; ++z)
    for (std::uint32_t x = 0; x < 96; ++x)
      for (std::uint32_t y = 0, first = 64; y < 64; ++y) {
        const float value = cloud.values[x + 96u * (y + 64u * z)];
        ASSERT_TRUE(value >= 0.0f && value <= 1.0f);
        filled += value > 0.0f;
        const bool face = x == 0 || y == 0 || z == 0 || x == 95 || y == 63 || z == 95;
        ASSERT_TRUE(!face || value == 0.0f);
        if (value > 0.5f && first == 64) lowest.push_back(first = y);
      }
  const double share = static_cast<double>(filled) / static_cast<double>(cloud.values.size());
  EXPECT_GT(share, 0.06);
  EXPECT_LT(share, 0.5);
  EXPECT_GT(*std::max_element(cloud.values.begin(), cloud.values.end()), 0.99f);
  // No column hangs below the base, and more begin in its three voxels than in all the five above them.
  ASSERT_GT(lowest.size(), 500u);
  std::sort(lowest.begin(), lowest.end());
  const auto from = [&](std::uint32_t first, std::uint32_t last) {
    return std::count_if(lowest.begin(), lowest.end(),
                         [&](std::uint32_t y) { return y >= first && y < last; });
  };
  EXPECT_GT(from(lowest.front(), lowest.front() + 3), from(lowest.front() + 3, lowest.front() + 8));
}

TEST(VdbFile, OfTheSharedCloudIsTheSameAsItsNrrd) {
  const auto vdb = testing::sharedFile("volumes/wdas_cloud_sixteenth.vdb");
  const auto nrrd = testing::sharedFile("volumes/wdas_cloud_sixteenth.nrrd");
  LAMBENT_NEEDS_SHARED(vdb);
  LAMBENT_NEEDS_SHARED(nrrd);
  const auto a = readVdb(vdb, "density"), b = readNrrd(nrrd);
  ASSERT_TRUE(a) << a.error().line();
  ASSERT_TRUE(b) << b.error().line();
  EXPECT_EQ(a->name, "density");
  ASSERT_EQ(a->size, glm::uvec3(126, 86, 154));
  ASSERT_EQ(b->size, a->size);
  EXPECT_EQ(a->values, b->values);
  for (const glm::dvec4& at : {glm::dvec4(0, 0, 0, 1), glm::dvec4(126, 86, 154, 1)})
    EXPECT_LT(glm::distance(a->file_from_grid * at, b->file_from_grid * at), 1e-3);
  const auto unnamed = readVdb(vdb, "");
  ASSERT_TRUE(unnamed);
  EXPECT_EQ(unnamed->values, a->values);
}

TEST(VdbFile, DamagedDoesNotTakeAllMemory) {
#ifdef LAMBENT_SANITIZED
  GTEST_SKIP() << "AddressSanitizer ends a process that lacks memory, in place of throwing";
#endif
  const auto vdb = testing::sharedFile("volumes/wdas_cloud_sixteenth.vdb");
  LAMBENT_NEEDS_SHARED(vdb);
  std::ifstream in(vdb, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  bytes[58] = '\xff';  // a count that the library believes: it took over 4 GiB
  const TemporaryFolder folder;
  folder.write("damaged.vdb", bytes);
  const auto grid = readVdb(folder.path() / "damaged.vdb", "density");
  ASSERT_FALSE(grid);
  EXPECT_NE(grid.error().problem.find("far more memory"), std::string::npos) << grid.error().line();
  EXPECT_TRUE(readVdb(vdb, "density")) << "the limit is gone";
}

TEST(VdbFile, WithoutTheGridAskedForSaysWhatItHas) {
  const auto vdb = testing::sharedFile("volumes/wdas_cloud_sixteenth.vdb");
  LAMBENT_NEEDS_SHARED(vdb);
  const auto grid = readVdb(vdb, "temperature");
  ASSERT_FALSE(grid);
  EXPECT_NE(grid.error().line().find("no grid \"temperature\""), std::string::npos);
  EXPECT_NE(grid.error().hint.find("density"), std::string::npos);
}

}  // namespace
}  // namespace lambent::baker
