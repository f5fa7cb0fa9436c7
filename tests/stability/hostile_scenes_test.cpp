// Tests, from the scene to the bytes and back, scenes that tools produce and bakers stumble over.
#include <random>

#include "baker/import/gltf.hpp"
#include "runtime/spec/image.hpp"
#include "tests/stability/end_to_end_bake.hpp"

namespace lambent {
namespace {

using testing::box;
using testing::DecodedDraw;
using testing::flipped;
using testing::grid;
using testing::icosphere;
using testing::joined;
using testing::kCodingTolerance;
using testing::sceneOf;

using HostileScene = testing::EndToEndBake;

// Makes a floor with a ball on it.
baker::Scene ballOnFloor(float scale, glm::vec3 place) {
  return sceneOf(
      {grid(place, 4.0f * scale, 16), icosphere(place + glm::vec3(0, 0.6f * scale, 0), 0.5f * scale, 2)});
}

float meanRadiance(const std::vector<DecodedDraw>& draws) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const DecodedDraw& draw : draws)
    for (std::size_t v = 0; v < draw.mesh.positions.size(); ++v, ++count)
      sum += static_cast<double>(draw.uniformRadiance(v));
  return static_cast<float>(sum / static_cast<double>(count));
}

}  // namespace

// Means over vertices are compared, so that all scenes have the same.
TEST_F(HostileScene, OfAnySizeAndPlaceLooksTheSame) {
  baker::BakeOptions unrefined = options();
  unrefined.refine_bound = 0.0f;
  const float reference = meanRadiance(bakeAndDecode(ballOnFloor(1.0f, glm::vec3(0.0f)), unrefined));
  EXPECT_NEAR(reference, 0.8f, 0.1f);  // the ball's lower half sees mostly floor
  for (const float scale : {1e-6f, 1e-3f, 1e3f, 1e6f})
    EXPECT_NEAR(meanRadiance(bakeAndDecode(ballOnFloor(scale, glm::vec3(0.0f)), unrefined)), reference, 2e-3f)
        << scale;
  EXPECT_NEAR(meanRadiance(bakeAndDecode(ballOnFloor(1.0f, glm::vec3(1e4f)), unrefined)), reference, 5e-3f);
  // At a distance of 1000 km floats are 6 cm apart and rays start metres off surfaces, so only the range is
  // checked.
  EXPECT_FALSE(bakeAndDecode(ballOnFloor(1.0f, glm::vec3(1e6f, 0, 0))).empty());
}

TEST_F(HostileScene, FarFromTheOriginIsNotRefinedForTheRoundingOfItsPlaces) {
  EXPECT_LT(bakeAndDecode(ballOnFloor(1.0f, glm::vec3(1e4f)))[1].mesh.positions.size(), 400u);
}

TEST_F(HostileScene, SizeAndPlaceMayStandInTheNodesInstead) {
  baker::BakeOptions unrefined = options();
  unrefined.refine_bound = 0.0f;
  const float reference = meanRadiance(bakeAndDecode(ballOnFloor(1.0f, glm::vec3(0.0f)), unrefined));
  for (const float scale : {1e-6f, 1e6f}) {
    baker::Scene scene = ballOnFloor(1.0f, glm::vec3(0.0f));
    for (gltf::Node& node : scene.nodes)
      node.parent_from_node = glm::scale(glm::translate(glm::mat4(1.0f), glm::vec3(scale)), glm::vec3(scale));
    EXPECT_NEAR(meanRadiance(bakeAndDecode(scene, unrefined)), reference, 2e-3f) << scale;
  }
}

TEST_F(HostileScene, OfOneTriangleIsOpen) {
  bundle::MeshData triangle;
  triangle.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  triangle.normals.assign(3, {0, 0, 1});
  triangle.indices = {0, 1, 2};
  const auto draws = bakeAndDecode(sceneOf({triangle}));
  ASSERT_EQ(draws.size(), 1u);
  EXPECT_NEAR(meanRadiance(draws), 1.0f, kCodingTolerance);
}

TEST_F(HostileScene, WithANodeScaledToNothingBakesTheRest) {
  for (const glm::vec3 scale : {glm::vec3(0.0f), glm::vec3(1, 0, 1), glm::vec3(1e-30f)}) {
    baker::Scene scene = sceneOf({grid({0, 0, 0}, 4.0f, 8), icosphere({0, 1, 0}, 0.5f, 2)});
    scene.nodes[1].parent_from_node = glm::scale(glm::mat4(1.0f), scale);
    EXPECT_FALSE(bakeAndDecode(scene).empty());
    std::swap(scene.roots[0], scene.roots[1]);
    scene.roots.resize(1);  // nothing but the vanished node
    baker::Progress progress;
    const auto alone = baker::bake(scene, options(), folder / "alone.lmb.glb", {progress});
    if (!alone) {
      EXPECT_NE(alone.error().line().find("test.glb"), std::string::npos) << alone.error().line();
    }
  }
}

TEST_F(HostileScene, WithCoincidentDuplicatesIsLitAsOne) {
  const bundle::MeshData ball = icosphere({0, 0, 0}, 1.0f, 3);
  EXPECT_NEAR(meanRadiance(bakeAndDecode(sceneOf({ball, ball, ball}))), 1.0f, 5e-3f);
  const bundle::MeshData floor = grid({0, 0, 0}, 2.0f, 8);
  EXPECT_NEAR(meanRadiance(bakeAndDecode(sceneOf({floor, floor}))), 1.0f, 5e-3f);
}

TEST_F(HostileScene, TurnedInsideOutStaysInRange) {
  bakeAndDecode(sceneOf({flipped(icosphere({0, 0, 0}, 1.0f, 3))}));
  bakeAndDecode(sceneOf({grid({0, -1, 0}, 4.0f, 8), flipped(box({0, 0, 0}, {1, 1, 1}, 4))}));
}

TEST_F(HostileScene, WithAHundredthOfItsNormalsFlippedStaysInRange) {
  bundle::MeshData ball = icosphere({0, 0, 0}, 1.0f, 4);
  std::mt19937 random(1);
  for (std::size_t i = 0; i < ball.normals.size() / 100; ++i) {
    glm::vec3& normal = ball.normals[random() % ball.normals.size()];
    normal = -normal;
  }
  // The test uses a mean over vertices, and refinement would add many around the flipped ones.
  baker::BakeOptions as_it_is = options();
  as_it_is.refine_bound = 0.0f;
  EXPECT_GT(meanRadiance(bakeAndDecode(sceneOf({ball}), as_it_is)), 0.98f);
  bakeAndDecode(sceneOf({ball}));
}

TEST_F(HostileScene, OfSliversIsOpen) {
  bundle::MeshData slivers;  // a million times as long as wide, side by side
  for (int i = 0; i <= 40; ++i)
    for (const float x : {0.0f, 100.0f}) {
      slivers.positions.emplace_back(x, 0.0f, -1e-4f * static_cast<float>(i));
      slivers.normals.emplace_back(0, 1, 0);
    }
  for (std::uint32_t i = 0; i < 40; ++i)
    for (const std::uint32_t corner : {0u, 1u, 2u, 1u, 3u, 2u}) slivers.indices.push_back(2 * i + corner);
  bakeAndDecode(sceneOf({slivers}));
  // Slivers among ordinary triangles must give the same.
  EXPECT_NEAR(meanRadiance(bakeAndDecode(sceneOf({joined(grid({50, 0, 0}, 100.0f, 16), slivers)}))), 1.0f,
              0.02f);
}

// Rays start 2.5e-5 m off these faces: a hundred times the walls' thickness.
TEST_F(HostileScene, WithWallsThinnerThanItsRaysStandOffIsDarkInside) {
  constexpr float kThick = 2.5e-7f;
  const auto draws = bakeAndDecode(sceneOf(
      {box({0, 0, 0}, glm::vec3(2.0f), 8), flipped(box({0, 0, 0}, glm::vec3(2.0f - 2.0f * kThick), 8))}));
  ASSERT_EQ(draws.size(), 2u);
  EXPECT_NEAR(range({draws[0]}).first, 1.0f, kCodingTolerance) << "outside";
  EXPECT_NEAR(range({draws[1]}).second, 0.0f, kCodingTolerance) << "inside";
}

// One surface is the wall for both sides.
TEST_F(HostileScene, OfASheetOfTwoSidesIsOpenOutsideAndDarkInside) {
  // Something within keeps the inside from being left out.
  baker::Scene scene = sceneOf({box({0, 0, 0}, glm::vec3(2.0f), 8), icosphere({0, 0, 0}, 0.3f, 1)});
  scene.materials[0].double_sided = true;
  const auto draws = bakeAndDecode(scene);
  ASSERT_EQ(draws.size(), 3u);
  EXPECT_NEAR(range({draws[0]}).first, 1.0f, kCodingTolerance) << "outside";
  EXPECT_NEAR(range({draws[1], draws[2]}).second, 0.0f, kCodingTolerance) << "inside";
}

TEST_F(HostileScene, OfALongThinTerrainKeepsItsSlopes) {
  bundle::MeshData strip;
  constexpr int kLength = 2000;
  for (int i = 0; i <= kLength; ++i)
    for (const float z : {1.0f, 0.0f, -1.0f}) {
      const float x = 10.0f * static_cast<float>(i);
      strip.positions.emplace_back(x, 2.0f * std::sin(0.05f * x), z);
      strip.normals.push_back(glm::normalize(glm::vec3(-0.1f * std::cos(0.05f * x), 1.0f, 0.0f)));
    }
  for (std::uint32_t i = 0; i < kLength; ++i)
    for (const std::uint32_t row : {0u, 1u})
      for (const std::uint32_t corner : {0u, 3u, 1u, 1u, 3u, 4u})
        strip.indices.push_back(3 * i + row + corner);
  EXPECT_NEAR(meanRadiance(bakeAndDecode(sceneOf({strip}))), 1.0f, 0.02f);  // valleys are shallow
}

// The normals of such a mesh have no inverse transpose, in floats or at all.
TEST_F(HostileScene, OfAFloorThatItsNodeFlattensIsAsLightAsAnother) {
  for (const float height : {1.0f, 0.0f, 1e-20f, 1e-40f}) {
    baker::Scene scene = sceneOf({grid({0, 0, 0}, 4.0f, 4)});
    scene.nodes[0].parent_from_node = glm::scale(glm::mat4(1.0f), {1.0f, height, 1.0f});
    EXPECT_NEAR(meanRadiance(bakeAndDecode(scene)), 1.0f, 1e-3f) << height;
  }
}

TEST_F(HostileScene, OfTwoHundredMovableGroupsBakesThemAll) {
  baker::Scene scene = sceneOf({icosphere({0, 0, 0}, 0.5f, 1)});
  for (int i = 0; i < 200; ++i) {
    gltf::Node node = scene.nodes[0];
    node.movable = true;
    node.parent_from_node = glm::translate(glm::mat4(1.0f), {static_cast<float>(i), 0, 0});
    scene.roots.push_back(static_cast<std::int32_t>(scene.nodes.size()));
    scene.nodes.push_back(node);
  }
  const auto draws = bakeAndDecode(scene);
  ASSERT_EQ(draws.size(), 201u);
  EXPECT_NEAR(meanRadiance(draws), 1.0f, 5e-3f) << "groups do not shadow each other";
}

TEST_F(HostileScene, OfMirroredAndSquashedInstancesIsLitFromOutside) {
  baker::Scene scene = sceneOf({icosphere({0, 0, 0}, 0.5f, 2)});
  scene.nodes.clear(), scene.roots.clear();
  std::mt19937 random(2);
  std::uniform_real_distribution<float> factor(0.3f, 1.5f);
  for (int i = 0; i < 50; ++i) {
    gltf::Node node;
    node.mesh = 0;
    const glm::vec3 scale(i % 2 == 0 ? factor(random) : -factor(random), factor(random),
                          i % 3 == 0 ? -factor(random) : factor(random));
    node.parent_from_node =
        glm::scale(glm::rotate(glm::translate(glm::mat4(1.0f), {10.0f * static_cast<float>(i), 0, 0}),
                               static_cast<float>(i), glm::normalize(glm::vec3(1, 2, 3))),
                   scale);
    scene.roots.push_back(i);
    scene.nodes.push_back(node);
  }
  const auto draws = bakeAndDecode(scene);
  ASSERT_EQ(draws.size(), 50u);
  for (const DecodedDraw& draw : draws) EXPECT_GT(meanRadiance({draw}), 0.97f) << draw.draw.node;
}

TEST_F(HostileScene, WithAMaskedLeafLetsLightThroughItsHoles) {
  const auto scene = [&](std::uint8_t alpha) {
    baker::Scene leaf = sceneOf({grid({0, 0, 0}, 1.0f, 8), grid({0, 0.5f, 0}, 8.0f, 8)});
    leaf.materials.push_back(leaf.materials[0]);
    gltf::Material& mask = leaf.materials[1];
    mask.alpha_mode = gltf::AlphaMode::Mask;
    mask.double_sided = true;
    mask.base_color_texture.texture = 0;
    leaf.meshes[1].primitives[0].material = 1;
    const auto png = spec::encodePng(
        {2, 2, {90, 200, 40, alpha, 90, 200, 40, alpha, 90, 200, 40, alpha, 90, 200, 40, alpha}});
    const auto* bytes = reinterpret_cast<const std::byte*>(png.data());
    leaf.images.push_back({"leaf", "image/png", {bytes, bytes + png.size()}});
    leaf.textures.push_back({0, {}});
    return leaf;
  };
  const auto open = bakeAndDecode(scene(0)), closed = bakeAndDecode(scene(255));
  ASSERT_EQ(open.size(), 3u) << "the leaf has two sides";
  EXPECT_NEAR(meanRadiance({open[0]}), 1.0f, 5e-3f);
  EXPECT_LT(meanRadiance({closed[0]}), 0.1f) << "sees out only below the leaf's rim";
}

TEST_F(HostileScene, WithPositionsThatAreNoNumbersIsMendedOrRefusedByName) {
  const std::string path = (folder / "nan.gltf").string();
  for (const float poison :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 3e38f}) {
    const std::vector<float> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, poison, 1, 1};
    const auto* bytes = reinterpret_cast<const char*>(positions.data());
    testing::writeBytes(folder / "nan.bin", {bytes, bytes + positions.size() * sizeof(float)});
    testing::writeBytes(path, R"({"asset":{"version":"2.0"},"buffers":[{"uri":"nan.bin","byteLength":72}],
      "bufferViews":[{"buffer":0,"byteLength":72}],
      "accessors":[{"bufferView":0,"componentType":5126,"count":6,"type":"VEC3","min":[0,0,0],"max":[1,1,1]}],
      "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}]})");
    const auto scene = baker::importScene(path);
    if (!scene) {
      EXPECT_NE(scene.error().line().find("nan.gltf"), std::string::npos) << scene.error().line();
      continue;
    }
    const auto draws = bakeAndDecode(*scene);
    for (const DecodedDraw& draw : draws)
      for (const glm::vec3& p : draw.mesh.positions)
        EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) << poison;
  }
}

}  // namespace lambent
