// Tests which texture coordinates may hold transfer, and what is said of those that may not.
#include "baker/import/texture_transfer.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "baker/import/check.hpp"
#include "tests/support/shapes.hpp"

namespace lambent::baker {
namespace {

bundle::MeshData unwrapped() {
  return testing::grid({0, 0, 0}, 1.0f, 3);
}

TEST(TextureTransfer, TakesCoordinatesInWhichEveryPointHasAPlaceOfItsOwn) {
  EXPECT_EQ(faultOfCharts(unwrapped(), 0, 128), "");
}

TEST(TextureTransfer, RefusesCoordinatesThatDoNotServe) {
  struct Case {
    const char* says;
    glm::vec2 corner;  // of the grid's first vertex
  };
  for (const Case& bent : {Case{"leaves the texture", {-0.5f, 0.0f}},
                           Case{"leaves the texture", {std::numeric_limits<float>::quiet_NaN(), 0.0f}},
                           Case{"leaves the texture", {std::numeric_limits<float>::infinity(), 0.0f}},
                           Case{"overlaps", {0.9f, 0.9f}}, Case{"no area", {1.0f / 3.0f, 0.0f}}}) {
    bundle::MeshData mesh = unwrapped();
    mesh.texcoords0.front() = bent.corner;
    ScenePrimitive primitive{.mesh = mesh};
    std::vector<std::string> warnings;
    giveTexels(64, "mesh 7, primitive 2", primitive, warnings);
    EXPECT_EQ(primitive.texels, 0u) << bent.says;
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].find(bent.says), std::string::npos) << warnings[0];
    EXPECT_NE(warnings[0].find("mesh 7, primitive 2"), std::string::npos) << warnings[0];
    EXPECT_NE(warnings[0].find("unwrap"), std::string::npos) << warnings[0];
  }
}

TEST(TextureTransfer, PrefersTheSecondSetAndNeedsOne) {
  ScenePrimitive primitive{.mesh = unwrapped()};
  std::vector<std::string> warnings;
  primitive.mesh.texcoords1 = primitive.mesh.texcoords0;
  for (glm::vec2& tiled : primitive.mesh.texcoords0) tiled *= 8.0f;
  giveTexels(64, "mesh", primitive, warnings);
  EXPECT_EQ(primitive.texels, 64u);
  EXPECT_EQ(primitive.texel_set, 1u);
  EXPECT_TRUE(warnings.empty());

  ScenePrimitive bare{.mesh = unwrapped()};
  bare.mesh.texcoords0.clear();
  giveTexels(64, "mesh", bare, warnings);
  EXPECT_EQ(bare.texels, 0u);
  EXPECT_EQ(warnings.size(), 1u);
}

TEST(TextureTransfer, IsAPowerOfTwoOfAPrimitiveOrItsMesh) {
  const auto asking = [](const nlohmann::json& texels) {
    return nlohmann::json{{"extras", {{"lambent", {{"texture_transfer", texels}}}}}};
  };
  const nlohmann::json none = nlohmann::json::object();
  for (const nlohmann::json& wrong :
       {nlohmann::json(0), nlohmann::json(3), nlohmann::json(65536), nlohmann::json(-64),
        nlohmann::json(64.5), nlohmann::json("64"), nlohmann::json(nullptr)}) {
    const nlohmann::json owner = asking(wrong);
    EXPECT_THROW(checkTextureTransfer({owner, "mesh 0"}), BrokenField) << wrong.dump();
  }
  for (const std::uint32_t right : {16u, 256u, 2048u}) {
    const nlohmann::json owner = asking(right);
    EXPECT_NO_THROW(checkTextureTransfer({owner, "mesh 0"}));
    EXPECT_EQ(textureTransferOf(owner, none), right);
    EXPECT_EQ(textureTransferOf(asking(32), owner), right) << "the primitive's own goes first";
  }
  EXPECT_EQ(textureTransferOf(none, none), 0u);
}

}  // namespace
}  // namespace lambent::baker
