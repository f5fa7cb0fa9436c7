// Tests what a bake says of the error of its pictures.

#include <cmath>

#include <gtest/gtest.h>

#include "baker/bake/bake.hpp"
#include "runtime/bundle/container.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lambent::baker {
namespace {

// Makes a box that stands on a floor of n x n cells.
Scene boxOnFloor(int n) {
  return testing::sceneOf({testing::grid({0.0f, 0.0f, 0.0f}, 4.0f, n),
                           testing::box({0.13f, 0.4f, -0.21f}, {0.7f, 0.8f, 0.7f}, 4)});
}

// Makes a room that is open at the top, seen from inside.
Scene openRoom() {
  Scene scene = testing::sceneOf({testing::flipped(testing::box({0.0f, 1.0f, 0.0f}, {4.0f, 2.0f, 3.0f}, 6))});
  bundle::MeshData& mesh = scene.meshes[0].primitives[0].mesh;
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
    if (mesh.normals[mesh.indices[i]].y > -0.5f)
      kept.insert(kept.end(), mesh.indices.begin() + static_cast<std::ptrdiff_t>(i),
                  mesh.indices.begin() + static_cast<std::ptrdiff_t>(i) + 3);
  mesh.indices = std::move(kept);
  return scene;
}

Scene ofMetal(Scene scene) {
  for (auto& material : scene.materials) material.metallic = 1.0f, material.roughness = 0.5f;
  return scene;
}

bundle::PictureError errorOf(const Scene& scene, const BakeOptions& options) {
  const testing::TemporaryFolder folder;
  Progress progress;
  const auto report = bake(scene, options, folder.path() / "scene.lmb.glb", {progress});
  if (!report || report->groups.size() != 1 || !report->groups[0].picture_error) {
    ADD_FAILURE() << "no figure";
    return {};
  }
  const auto reader = bundle::Reader::open(folder.path() / "scene.lmb.glb");
  EXPECT_EQ(reader->description().groups[0].picture_error, report->groups[0].picture_error)
      << "the bundle says the same";
  return *report->groups[0].picture_error;
}

BakeOptions plainOptions() {
  BakeOptions options;
  options.rays = 256;
  options.refine_bound = 0.0f;
  return options;
}

TEST(PictureError, OfAnOpenSphereIsThatOfItsCodesAndOfItsFlatFaces) {
  const bundle::PictureError error =
      errorOf(testing::sceneOf({testing::icosphere(glm::vec3(0.0f), 1.0f, 4)}), plainOptions());
  EXPECT_GT(error.points, 300u);
  EXPECT_LT(error.samples, 1e-3f) << "weights of rays are exact where nothing is hidden";
  EXPECT_LT(error.codes, 0.01f);
  EXPECT_LT(error.interpolation, 0.004f) << "edges of 4 degrees";
  EXPECT_NEAR(std::hypot(error.samples, error.codes, error.interpolation), error.all, 0.1f * error.all);
}

TEST(PictureError, FallsWithMoreVerticesAndWithMoreRays) {
  BakeOptions options = plainOptions();
  const bundle::PictureError coarse = errorOf(boxOnFloor(8), options),
                             fine = errorOf(boxOnFloor(64), options);
  EXPECT_GT(coarse.interpolation, 0.02f) << "a shadow is narrower than half a metre";
  EXPECT_LT(fine.interpolation, 0.5f * coarse.interpolation);
  options.rays = 2048;
  EXPECT_LT(errorOf(boxOnFloor(64), options).samples, 0.6f * fine.samples);
}

TEST(PictureError, IsWithinTheBoundThatWasAskedForAndNotFarBelow) {
  for (const float bound : {0.03f, 0.015f}) {
    BakeOptions options;
    options.picture_bound = bound;
    const bundle::PictureError error = errorOf(openRoom(), options);
    EXPECT_EQ(error.bound, bound);
    EXPECT_LE(error.all, bound) << "rays " << error.samples << ", codes " << error.codes << ", interpolation "
                                << error.interpolation;
    EXPECT_GE(error.all, 0.5f * bound);
  }
}

TEST(PictureError, OfMetalsFallsWithMoreVerticesWithMoreRaysAndWithFinerCodes) {
  BakeOptions options = plainOptions();
  const bundle::PictureError coarse = errorOf(ofMetal(boxOnFloor(6)), options),
                             fine = errorOf(ofMetal(boxOnFloor(24)), options);
  EXPECT_GT(coarse.interpolation, 0.02f);
  EXPECT_LT(fine.interpolation, 0.5f * coarse.interpolation);
  options.error_bound = 0.004f;
  EXPECT_LT(errorOf(ofMetal(boxOnFloor(24)), options).codes, 0.5f * fine.codes);
  options.rays = 1024;
  EXPECT_LT(errorOf(ofMetal(boxOnFloor(24)), options).samples, 0.7f * fine.samples);
}

TEST(PictureError, OfMetalsIsWithinTheBoundThatWasAskedForAndNotFarBelow) {
  BakeOptions options;
  options.picture_bound = 0.05f;
  const bundle::PictureError error = errorOf(ofMetal(openRoom()), options);
  EXPECT_LE(error.all, options.picture_bound)
      << "rays " << error.samples << ", codes " << error.codes << ", interpolation " << error.interpolation;
  EXPECT_GE(error.all, 0.5f * options.picture_bound);
}

}  // namespace
}  // namespace lambent::baker
