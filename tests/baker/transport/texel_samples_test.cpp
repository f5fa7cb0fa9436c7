// Tests where the samples of texels lie, and that they see, bounce and fill as those of vertices do.
#include "baker/transport/texel_samples.hpp"

#include <algorithm>
#include <cmath>

#include "baker/transport/samples.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/transport.hpp"

namespace lambent::baker {
namespace {

using testing::Transport;

Scene texturedFloor(std::uint32_t texels, std::vector<bundle::MeshData> others = {}) {
  std::vector<bundle::MeshData> meshes = {testing::grid({0, 0, 0}, 4.0f, 1)};
  meshes.insert(meshes.end(), others.begin(), others.end());
  Scene scene = testing::sceneOf(meshes);
  scene.meshes[0].primitives[0].texels = texels;
  return scene;
}

TEST(TexelSamples, StandAtTheCentresOfTheTexelsOfAFloor) {
  const Transport t(texturedFloor(16));
  ASSERT_EQ(t.samples.texels.size(), 1u);
  EXPECT_EQ(t.samples.size(), 4u + 256u);
  for (std::uint32_t texel = 0; texel < 256; ++texel) {
    const std::uint32_t sample = t.samples.texels[0].sample_of[texel];
    ASSERT_NE(sample, kNoSample);
    const auto centre = [](std::uint32_t i) { return (static_cast<float>(i) + 0.5f) / 16.0f * 4.0f - 2.0f; };
    EXPECT_NEAR(t.samples.positions[sample].x, centre(texel % 16), 1e-5f);
    EXPECT_NEAR(t.samples.positions[sample].z, centre(texel / 16), 1e-5f);
    EXPECT_EQ(t.samples.originsOf(sample).size(), 1u);
  }
}

TEST(TexelSamples, OfTheBorderStayOnTheChartAndTheRestIsDilated) {
  Scene scene = texturedFloor(32);
  for (glm::vec2& at : scene.meshes[0].primitives[0].mesh.texcoords0) at = 0.25f + 0.4f * at;
  const Transport t(scene);
  const TexelMap& map = t.samples.texels[0];
  for (const std::uint32_t sample : map.sample_of) {
    if (sample == kNoSample) continue;
    const glm::vec3 at = glm::abs(t.samples.positions[sample]);
    EXPECT_LT(at.x, 2.0f);
    EXPECT_LT(at.z, 2.0f);
  }
  EXPECT_EQ(map.sample_of[0], kNoSample);
  const std::vector<std::uint32_t> shown = dilated(map);
  EXPECT_EQ(std::ranges::count(shown, kNoSample), 0);
  for (std::size_t i = 0; i < shown.size(); ++i)
    if (map.sample_of[i] != kNoSample) {
      EXPECT_EQ(shown[i], map.sample_of[i]);
    }
}

// Every texel that a bilinear filter reads on the chart, up to its very edge, has a sample of the chart.
TEST(TexelSamples, LeaveNoGapAlongTheEdgeOfAChart) {
  Scene scene = texturedFloor(64);
  for (glm::vec2& at : scene.meshes[0].primitives[0].mesh.texcoords0)
    at = glm::vec2(0.5f) + glm::mat2(0.4f, 0.31f, -0.31f, 0.4f) * (at - 0.5f);
  const Transport t(scene);
  const TexelMap& map = t.samples.texels[0];
  for (std::uint32_t triangle = 0; triangle < 2; ++triangle)
    for (int edge = 0; edge < 3; ++edge)
      for (int step = 0; step <= 500; ++step) {
        glm::vec3 shares(0.0f);
        shares[edge] = static_cast<float>(step) / 500.0f;
        shares[(edge + 1) % 3] = 1.0f - shares[edge];
        const glm::uvec3 corners = t.geometry.triangles[triangle];
        glm::vec2 at(0.0f);
        glm::vec3 position(0.0f), shown(0.0f);
        for (int c = 0; c < 3; ++c) {
          at += shares[c] * t.geometry.chart_coordinates[corners[c]];
          position += shares[c] * t.geometry.positions[corners[c]];
        }
        const glm::vec2 low = glm::floor(64.0f * at - 0.5f);
        for (std::uint32_t i = 0; i < 4; ++i) {
          const auto x = static_cast<std::uint32_t>(low.x) + i % 2,
                     y = static_cast<std::uint32_t>(low.y) + i / 2;
          EXPECT_NE(map.sample_of[x + 64 * y], kNoSample);
        }
        for (const auto& [sample, share] : shownSamples(t.geometry, t.samples, triangle, shares))
          shown += share * t.samples.positions[sample];
        EXPECT_LT(glm::distance(shown, position), 4.0f / 64.0f / 0.5f) << "a texel on the surface is 0.12 m";
      }
}

// What rays see of an open floor is 1 everywhere, and a box darkens the texels beside it and no others. The
// texels under it are dark, and are filled from those beside it.
TEST(TexelSamples, SeeTheBoxThatStandsOnThem) {
  const Transport t(texturedFloor(32, {testing::box({0, 0.5f, 0}, {1.1f, 1.0f, 1.1f}, 1)}));
  const TransferField field = t.direct();
  const TexelMap& map = t.samples.texels[0];
  const auto seen = [&](std::uint32_t x, std::uint32_t y) { return field.at(map.sample_of[x + 32 * y])[0]; };
  const float open = 0.28209479f * 3.5449077f;  // A_0 / pi y_0 times sqrt(4 pi)
  const float corner = seen(0, 0) * 3.5449077f / open, beside = seen(11, 16) * 3.5449077f / open,
              under = seen(16, 16) * 3.5449077f / open;
  EXPECT_GT(corner, 0.97f);
  EXPECT_NEAR(beside, 0.5f, 0.15f) << "a wall hides half of the sky";
  EXPECT_NEAR(under, beside, 0.1f) << "nothing dark leaks out from under the box";
}

// Returns how wrong direct light is shown between samples of the floor: RMS over its two triangles, relative.
double errorOnFloor(const Transport& t) {
  SampleSet points;
  std::vector<std::pair<std::uint32_t, glm::vec3>> places;
  for (std::uint32_t triangle = 0; triangle < 2; ++triangle)
    for (int i = 0; i < 20; ++i)
      for (int j = 0; i + j < 20; ++j) {
        const glm::vec3 shares(1.0f - static_cast<float>(i + j + 1) / 21.0f,
                               static_cast<float>(i) / 21.0f + 0.02f,
                               static_cast<float>(j + 1) / 21.0f - 0.02f);
        const FacePoint point = facePoint(t.geometry, t.geometry.triangles[triangle], shares);
        places.emplace_back(triangle, shares);
        points.origin_offsets.push_back(static_cast<std::uint32_t>(points.size()));
        points.positions.push_back(point.position);
        points.normals.push_back(point.normal);
        points.origins.push_back(point.origin);
      }
  points.origin_offsets.push_back(static_cast<std::uint32_t>(points.size()));
  points.diffuse = {0, points.size()};
  points.normal_mapped = points.glossy = {points.size(), points.size()};
  const TracedScene at_points{t.scene, t.geometry, points, t.rays, t.colors, t.lights};
  Progress progress;
  const auto truth = bakeDirect(DirectPass(at_points, {.order = 5, .rays = 2048}), {progress});
  const TransferField field = t.direct();
  double wrong = 0.0, all = 0.0;
  for (std::size_t p = 0; p < places.size(); ++p) {
    if (truth->looks.valid[p] == 0) continue;  // under the box
    const auto is = truth->field.at(p);
    const auto shown = shownSamples(t.geometry, t.samples, places[p].first, places[p].second);
    for (std::size_t k = 0; k < is.size(); ++k) {
      double sum = 0.0;
      for (const auto& [sample, share] : shown) sum += double{share} * double{field.at(sample)[k]};
      wrong += (sum - double{is[k]}) * (sum - double{is[k]});
      all += double{is[k]} * double{is[k]};
    }
  }
  return std::sqrt(wrong / all);
}

TEST(TexelSamples, ShowLightOnAFloorThatItsCornersDoNotKnow) {
  const auto box = std::vector{testing::box({0, 0.5f, 0}, {1.1f, 1.0f, 1.1f}, 1)};
  const double of_corners = errorOnFloor(Transport(texturedFloor(0, box))),
               of_texels = errorOnFloor(Transport(texturedFloor(64, box)));
  EXPECT_GT(of_corners, 0.15);
  EXPECT_LT(of_texels, 0.03) << "noise of 512 rays is most of it";
}

// Light that bounces off the floor comes from the texel that a ray meets.
TEST(TexelSamples, SendOnTheLightThatTheyReceive) {
  const auto boxes = std::vector{testing::box({0, 0.5f, 0}, {1.1f, 1.0f, 1.1f}, 2)};
  Scene fine = texturedFloor(32, boxes), dense = texturedFloor(0, boxes);
  dense.meshes[0].primitives[0].mesh = testing::grid({0, 0, 0}, 4.0f, 40);
  const Transport with_texels(fine), with_vertices(dense), coarse(texturedFloor(0, boxes));
  const auto bounced = [](const Transport& t) {
    const auto baked = t.bake(1, 1024, 1);
    return baked.bounced.field.at(t.sampleAt({0.55f, 0.5f, 0.0f}))[0];
  };
  const float truth = bounced(with_vertices);
  EXPECT_NEAR(bounced(with_texels), truth, 0.03f * truth);
  EXPECT_GT(std::abs(bounced(coarse) - truth), 0.06f * truth)
      << "corners of the floor know nothing of the box";
}

TEST(TexelSamples, AreLeftOutForRefinementAndGlossySurfaces) {
  const Transport t(texturedFloor(16));
  EXPECT_EQ(buildSamples(t.geometry, /*with_texels=*/false).size(), 4u);
  Scene glossy = texturedFloor(16);
  glossy.materials[0].metallic = 1.0f;
  glossy.materials[0].roughness = 0.5f;
  EXPECT_TRUE(Transport(glossy, /*with_glossy=*/true).samples.texels.empty());
}

}  // namespace
}  // namespace lambent::baker
