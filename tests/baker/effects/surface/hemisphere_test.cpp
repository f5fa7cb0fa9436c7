// Tests the weights of rays, and transfer for any normal, as normal maps need it.
#include "baker/effects/surface/hemisphere.hpp"

#include <algorithm>
#include <numeric>

#include "runtime/sh/basis.hpp"
#include "runtime/sh/zonal.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/transport.hpp"

namespace lambent::baker {
namespace {

using testing::grid;
using testing::icosphere;
using testing::sceneOf;
using testing::Transport;

constexpr float kPi = std::numbers::pi_v<float>;

// Returns sum_j (A_l/pi) y_j(n) l'_j.
float atNormal(std::span<const float> incident, glm::vec3 n, std::size_t stride = 1) {
  std::array<float, 9> kernel;
  sh::unoccludedTransfer(3, n, std::span<float>(kernel));
  float sum = 0.0f;
  for (std::size_t j = 0; j < 9; ++j) sum += kernel[j] * incident[j * stride];
  return sum;
}

TEST(IncidentBasis, IsExactAtTheSurfacesOwnNormalForEveryDirection) {
  const IncidentBasis basis;
  for (float z = 0.0f; z <= 1.0f; z += 0.093f)
    for (float phi = 0.0f; phi < 6.28f; phi += 0.7f) {
      const float side = std::sqrt(1.0f - z * z);
      const auto c = basis.evaluate({side * std::cos(phi), side * std::sin(phi), z});
      EXPECT_NEAR(atNormal(c, {0, 0, 1}), z / kPi, 1e-5f);
    }
}

Scene mappedScene(std::vector<bundle::MeshData> meshes) {
  Scene scene = sceneOf(meshes);
  scene.materials[0].normal_texture.texture = 0;  // its texels do not matter to the bake
  for (SceneMesh& mesh : scene.meshes)
    mesh.primitives[0].mesh.texcoords0.resize(mesh.primitives[0].mesh.positions.size());
  return scene;
}

TEST(NormalMappedTransfer, OfAnOpenPlaneUnderUniformLightFollowsTheTilt) {
  const Transport t(mappedScene({grid({0, 0, 0}, 1.0f, 2)}));
  ASSERT_EQ(t.samples.normal_mapped.begin, 0u);
  const auto baked = t.bake(4, 1024, 0);
  ASSERT_EQ(baked.direct.mapped.size(), t.samples.size());
  for (std::size_t s = 0; s < t.samples.size(); ++s)
    for (float tilt = 0.0f; tilt <= 60.0f; tilt += 15.0f) {
      const float a = glm::radians(tilt);
      const float value = atNormal(baked.direct.mapped.at(s), {std::sin(a), std::cos(a), 0.0f}, 16);
      // (1 + cos) / 2 of the tilted normal's hemisphere lies above the plane.
      EXPECT_NEAR(value * std::sqrt(4.0f * kPi), 0.5f * (1.0f + std::cos(a)), 0.02f) << tilt;
    }
}

TEST(NormalMappedTransfer, AtTheSurfacesOwnNormalIsThePlainTransferBouncesIncluded) {
  const Transport t(mappedScene({grid({0, 0, 0}, 2.0f, 12), icosphere({0.1f, 0.7f, 0.0f}, 0.5f, 3)}));
  const auto baked = t.bake(5, 512, 2);
  for (std::size_t s = 0; s < t.samples.size(); ++s) {
    if (!baked.direct.looks.valid[s]) continue;
    const auto plain = baked.direct.field.at(s), mapped = baked.direct.mapped.at(s);
    const auto diffuse_bounced = baked.bounced.field.at(s), mapped_bounced = baked.bounced.mapped.at(s);
    for (std::size_t i = 0; i < 25; ++i) {
      EXPECT_NEAR(atNormal(mapped.subspan(i), t.samples.normals[s], 25), plain[i], 2e-4f);
      EXPECT_NEAR(atNormal(mapped_bounced.subspan(i), t.samples.normals[s], 25), diffuse_bounced[i], 2e-4f);
    }
  }
}

TEST(NormalMappedTransfer, OfThePointLightFollowsTheTilt) {
  Scene scene = mappedScene({grid({0, 0, 0}, 1.0f, 2)});
  testing::addPointLight(scene, {0, 2, 0});
  const Transport t(scene);
  const auto baked = t.bake(2, 256, 0);
  const std::size_t s = t.sampleAt({0, 0, 0});
  for (const float tilt : {0.0f, 20.0f, 40.0f}) {
    const float a = glm::radians(tilt);
    const float value = atNormal(baked.direct.mapped.at(s).subspan(4), {std::sin(a), std::cos(a), 0.0f}, 5);
    EXPECT_NEAR(value, std::cos(a) / 4.0f / kPi, 0.1f / 4.0f / kPi) << tilt;  // three bands of a delta
  }
}

std::vector<double> evenly(const DirectionTable& table) {
  return std::vector<double>(table.size(), 1.0 / static_cast<double>(table.size()));
}

class ProjectionTableOfOrder : public ::testing::TestWithParam<std::tuple<int, int>> {};

TEST_P(ProjectionTableOfOrder, IsExactWhereTheAnswerIsKnown) {
  const auto [order, rays] = GetParam();
  const DirectionTable directions = cosineTable(static_cast<std::size_t>(rays));
  const ProjectionTable table(directions, evenly(directions), order);
  const auto columns = static_cast<std::size_t>(sh::coefficientCount(order));
  std::vector<float> open(columns), out(columns);
  sh::unoccludedTransfer(order, glm::vec3(0.0f, 0.0f, 1.0f), open);

  table.project(std::vector<std::uint16_t>(directions.packets(), 0), out);
  for (std::size_t i = 0; i < columns; ++i) EXPECT_NEAR(out[i], open[i], 1e-7f);
  table.project(std::vector<std::uint16_t>(directions.packets(), 0xffff), out);
  EXPECT_EQ(out, std::vector<float>(columns, 0.0f));

  // What one side of the hemisphere lacks, the other has; the two are summed in different ways. 1e-5: float
  // sums.
  std::vector<std::uint16_t> left(directions.packets()), right(directions.packets());
  for (std::size_t r = 0; r < directions.size(); ++r)
    (directions.x[r] < 0.3f ? left : right)[r / 16] |= static_cast<std::uint16_t>(1u << (r % 16));
  std::vector<float> a(columns), b(columns);
  table.project(left, a);
  table.project(right, b);
  for (std::size_t i = 0; i < columns; ++i) EXPECT_NEAR(a[i] + b[i], open[i], 1e-5f) << i;
}

// A negative weight could make uniform light brighter than the albedo.
TEST_P(ProjectionTableOfOrder, WeightsArePositiveAndSumToOne) {
  const auto [order, rays] = GetParam();
  const DirectionTable directions = cosineTable(static_cast<std::size_t>(rays));
  const ProjectionTable table(directions, evenly(directions), order);
  const auto weights = table.weights();
  EXPECT_GT(*std::min_element(weights.begin(), weights.end()), 0.0);
  EXPECT_NEAR(std::accumulate(weights.begin(), weights.end(), 0.0), 1.0, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(OrdersAndRays, ProjectionTableOfOrder,
                         ::testing::Combine(::testing::Values(1, 2, 5, 6, 8),
                                            ::testing::Values(128, 512, 2048)));

TEST(CosineTable, HasWholePacketsOfUnitVectorsAboveTheHorizon) {
  for (const std::size_t rays : {1u, 128u, 500u, 2048u}) {
    const DirectionTable table = cosineTable(rays);
    EXPECT_EQ(table.size() % kPacketWidth, 0u);
    EXPECT_GE(table.size(), rays);
    for (std::size_t r = 0; r < table.size(); ++r) {
      EXPECT_GE(table.z[r], 0.0f);
      EXPECT_NEAR(table.x[r] * table.x[r] + table.y[r] * table.y[r] + table.z[r] * table.z[r], 1.0f, 1e-6f);
    }
  }
}

}  // namespace
}  // namespace lambent::baker
