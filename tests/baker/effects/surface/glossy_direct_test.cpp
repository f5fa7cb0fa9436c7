// Compares visibility and matrices of glossy samples with closed forms (literature 1.9, 7.2, 7.3).
#include <Eigen/Eigenvalues>

#include "baker/effects/surface/direct.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/glossy_transport.hpp"

namespace lambent::baker {
namespace {

using testing::bakeGlossy;
using testing::box;
using testing::flipped;
using testing::glossyScene;
using testing::grid;
using testing::icosphere;
using testing::lambertKernels;
using testing::largestDifference;
using testing::shadowMatrix;
using testing::soup;
using testing::transformed;
using testing::Transport;
using testing::turned;

const float kUniform = std::sqrt(4.0f * std::numbers::pi_v<float>);  // the coefficient of the function 1

// Returns the SH of a cone of half angle `a` about `axis`, in this many bands.
std::vector<float> cone(int bands, glm::vec3 axis, double a) {
  std::vector<float> out(static_cast<std::size_t>(sh::coefficientCount(bands)));
  sh::evaluate(bands, axis, out);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const int l = sh::bandOf(static_cast<int>(i));
    out[i] *= static_cast<float>(sh::discZonal(l, a) * std::sqrt(4.0 * std::numbers::pi / (2 * l + 1)));
  }
  return out;
}

void expectIdentity(std::span<const float> matrix, std::size_t columns, float tolerance) {
  for (std::size_t i = 0; i < matrix.size(); ++i)
    EXPECT_NEAR(matrix[i], i / columns == i % columns ? 1.0f : 0.0f, tolerance) << i;
}

TEST(GlossyDirect, IsTheIdentityOnAnOpenPlaneAtEveryOrder) {
  const Transport t(
      glossyScene({turned(grid({0, 0, 0}, 1.0f, 4), 37.0f, glm::normalize(glm::vec3(1, 2, -1)))}), true);
  ASSERT_EQ(t.samples.glossy.begin, 0u);
  for (const auto& [in, out] : {std::pair{5, 5}, {6, 6}, {4, 5}, {5, 4}})
    for (const std::size_t rays : {std::size_t{128}, std::size_t{512}}) {
      const auto baked = bakeGlossy(t, lambertKernels(t), {.order = in, .order_out = out, .rays = rays});
      const GlossyField& field = baked.direct.glossy;
      ASSERT_EQ(field.size(), t.samples.size());
      for (std::size_t s = 0; s < field.size(); ++s) {
        const auto v = field.visibilityOf(s);
        EXPECT_NEAR(v[0], kUniform, 1e-6f);
        for (std::size_t k = 1; k < v.size(); ++k) EXPECT_NEAR(v[k], 0.0f, 1e-6f);
        expectIdentity(shadowMatrix(field, s), static_cast<std::size_t>(in * in), 1e-6f);
      }
    }
}

TEST(GlossyDirect, IsTheIdentityWhereNormalsLeanAwayFromOpenFaces) {
  // What the normal's hemisphere has below the face is mirrored in the face, not lost: below the facets of a
  // convex body, or in the middle of a large face with smooth normals.
  auto face = grid({0, 0, 0}, 1.0f, 4);
  for (glm::vec3& n : face.normals) n = glm::normalize(glm::vec3(0.6f, 1.0f, -0.2f));
  std::vector<float> open(25);
  for (const bundle::MeshData& mesh : {icosphere({0, 0, 0}, 2.0f, 3), face}) {
    const Transport t(glossyScene({mesh}), true);
    const auto baked = bakeGlossy(t, lambertKernels(t), {});
    for (std::size_t s = 0; s < t.samples.size(); ++s) {
      expectIdentity(shadowMatrix(baked.direct.glossy, s), 25, 1e-4f);
      sh::unoccludedTransfer(5, t.samples.normals[s], std::span<float>(open));
      EXPECT_LT(largestDifference(open, baked.direct.field.at(s)), 1e-4f);
    }
  }
}

TEST(GlossyDirect, BesideAnInfiniteWallMatchesTheHalfSpace) {
  // The wall blocks x < 0; what it leaves of the hemisphere above z = 0 and its mirror image are the half
  // space x > 0.
  const auto wall = turned(grid({0, 0, 0}, 2000.0f, 2), 90.0f, {0, 0, 1});
  const auto point = transformed(turned(grid({0, 0, 0}, 1e-3f, 2), 90.0f, {1, 0, 0}),
                                 glm::translate(glm::mat4(1.0f), {1e-2f, 0, 0}));
  const Transport t(glossyScene({wall, point}), true);
  const auto baked = bakeGlossy(t, lambertKernels(t), {.rays = 4096});
  const std::size_t s = t.sampleAt({1e-2f, 0, 0});
  ASSERT_NEAR(t.samples.normals[s].z, 1.0f, 1e-6f);
  EXPECT_LT(
      largestDifference(baked.direct.glossy.visibilityOf(s), cone(9, {1, 0, 0}, 0.5 * std::numbers::pi)),
      5e-3f);
}

TEST(GlossyDirect, UnderASphereLosesItsDiscAndTheMirrorImageOfIt) {
  for (const float degrees : {0.0f, 40.0f}) {
    const float a = glm::radians(degrees);
    const glm::vec3 towards(std::sin(a), std::cos(a), 0.0f);
    const Transport t(glossyScene({grid({0, 0, 0}, 0.01f, 2), icosphere(10.0f * towards, 4.0f, 4)}), true);
    const auto baked = bakeGlossy(t, lambertKernels(t), {.rays = 4096});
    const double radius = std::asin(0.4);
    std::vector<float> expected = cone(9, towards, radius),
                       mirrored = cone(9, towards * glm::vec3(1, -1, 1), radius);
    for (std::size_t k = 0; k < expected.size(); ++k)
      expected[k] = (k == 0 ? kUniform : 0.0f) - expected[k] - mirrored[k];
    EXPECT_LT(largestDifference(baked.direct.glossy.visibilityOf(t.sampleAt({0, 0, 0})), expected), 8e-3f)
        << degrees;
  }
}

TEST(GlossyDirect, InAClosedBoxIsNothing) {
  const Transport t(glossyScene({flipped(box({0, 0, 0}, {2, 3, 5}, 3))}), true);
  const auto baked = bakeGlossy(t, lambertKernels(t), {});
  for (const float value : baked.direct.glossy.visibility) EXPECT_EQ(value, 0.0f);
  for (const float value : baked.direct.field.vectors) EXPECT_EQ(value, 0.0f);
}

TEST(GlossyDirect, GivesShadowMatricesTheirStructureWhateverIsInTheWay) {
  const Transport t(glossyScene({soup(11, 0.4f, 0.6f)}), true);
  for (const int order : {5, 6}) {
    const auto baked = bakeGlossy(t, lambertKernels(t), {.order = order, .order_out = order, .rays = 256});
    const GlossyField& field = baked.direct.glossy;
    const Eigen::Index n2 = order * order;
    int shadowed = 0;
    for (std::size_t s = 0; s < field.size(); s += 4) {
      const auto matrix = shadowMatrix(field, s);
      const Eigen::Map<const Eigen::MatrixXf> m(matrix.data(), n2, n2);
      EXPECT_LT((m - m.transpose()).cwiseAbs().maxCoeff(), 1e-6f);
      const auto values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXf>(m).eigenvalues();
      EXPECT_GT(values.minCoeff(), -1e-5f);
      EXPECT_LT(values.maxCoeff(), 1.0f + 1e-5f);
      const auto v = field.visibilityOf(s);
      EXPECT_NEAR(m.trace(), static_cast<float>(n2) * v[0] / kUniform, 1e-4f);
      for (Eigen::Index i = 0; i < n2; ++i)
        EXPECT_NEAR(m(i, 0), v[static_cast<std::size_t>(i)] / kUniform, 1e-6f);
      EXPECT_LE(m.cwiseAbs().maxCoeff(), 1.0f + 1e-6f);
      shadowed += v[0] < 0.9f * kUniform && v[0] > 0.1f * kUniform;
    }
    EXPECT_GT(shadowed, 50);
  }
}

TEST(GlossyDirect, FillsWhatStandsUnderABodyFromItsNeighbours) {
  const Transport t(glossyScene({grid({0, 0, 0}, 4.0f, 20), box({0, 0.45f, 0}, {1, 1, 1}, 1)}), true);
  const auto baked = bakeGlossy(t, lambertKernels(t), {});
  EXPECT_GT(baked.direct.of(SurfacePart::Glossy).filled_samples, 0u);
  for (std::size_t s = 0; s < t.samples.size(); ++s) {
    if (std::abs(t.samples.positions[s].y) > 1e-4f) continue;
    // Beside the body at least half of the sky is visible; samples under it get the mean of such ones.
    EXPECT_GT(baked.direct.glossy.visibilityOf(s)[0], 0.4f * kUniform);
    EXPECT_GT(baked.direct.field.at(s)[0], 0.4f * 0.282095f);
  }
}

TEST(GlossyDirect, LeavesMatteSamplesAsTheyAre) {
  const std::vector<bundle::MeshData> meshes = {grid({0, 0, 0}, 2.0f, 10), icosphere({0, 0.6f, 0}, 0.5f, 3)};
  Scene scene = testing::sceneOf(meshes);
  const Transport matte(scene);
  testing::ownMaterial(scene, 1).metallic = 1.0f;
  const Transport mixed(scene, true);
  ASSERT_EQ(mixed.samples.glossy.begin, 121u);
  const auto baked = bakeGlossy(mixed, lambertKernels(mixed), {});
  const auto alone = matte.direct();
  for (std::size_t s = 0; s < mixed.samples.glossy.begin; ++s)
    EXPECT_EQ(largestDifference(baked.direct.field.at(s), alone.at(s)), 0.0f);
  // Unoccluded samples see the light through 5 bands of the cosine instead of the whole cosine.
  for (std::size_t s = mixed.samples.glossy.begin; s < mixed.samples.size(); ++s)
    EXPECT_LT(largestDifference(baked.direct.field.at(s), alone.at(s)), 0.02f);
  EXPECT_EQ(baked.direct.glossy.size(), mixed.samples.size() - 121u);
}

Scene withPointLight(Scene scene, glm::vec3 position) {
  testing::addPointLight(scene, position);
  return scene;
}

TEST(GlossyDirect, ReceivesAPointLightAndItsMirrorImage) {
  const glm::vec3 lamp(0.4f, 1.5f, -0.3f);
  const Transport open(withPointLight(glossyScene({grid({0, 0, 0}, 0.01f, 2)}), lamp), true);
  ASSERT_EQ(open.lights.size(), 1u);
  const auto baked = bakeGlossy(open, lambertKernels(open), {});
  const std::size_t s = open.sampleAt({0, 0, 0});
  std::vector<float> direct(25), mirrored(25);
  sh::evaluate(5, glm::normalize(lamp), direct);
  sh::evaluate(5, glm::normalize(lamp * glm::vec3(1, -1, 1)), mirrored);
  const float irradiance = 1.0f / glm::dot(lamp, lamp);
  for (std::size_t i = 0; i < 25; ++i)
    EXPECT_NEAR(baked.direct.glossy.lights_shadowed[s * 25 + i], irradiance * (direct[i] + mirrored[i]),
                1e-3f);
  const Transport hidden(
      withPointLight(glossyScene({grid({0, 0, 0}, 0.01f, 2), box({0.2f, 0.7f, -0.15f}, {1, 0.1f, 1}, 1)}),
                     lamp),
      true);
  const std::size_t h = hidden.sampleAt({0, 0, 0});
  const auto dark = bakeGlossy(hidden, lambertKernels(hidden), {});
  for (std::size_t i = 0; i < 25; ++i) EXPECT_EQ(dark.direct.glossy.lights_shadowed[h * 25 + i], 0.0f);
}

TEST(GlossyDirect, ReceivesASphereOfLightAsItsDisc) {
  Scene scene = glossyScene({grid({0, 0, 0}, 0.01f, 2), icosphere({0.5f, 1.0f, 0.0f}, 0.4f, 4)});
  testing::ownMaterial(scene, 1).emissive = glm::vec3(1.0f);
  const Transport t(scene, true);
  const auto baked = bakeGlossy(t, lambertKernels(t), {.rays = 2048});
  const std::size_t s = t.sampleAt({0, 0, 0});
  const glm::vec3 to(0.5f, 1.0f, 0.0f);
  const double radius = std::asin(0.4 / double{glm::length(to)});
  const auto disc = cone(5, glm::normalize(to), radius),
             mirrored = cone(5, glm::normalize(to * glm::vec3(1, -1, 1)), radius);
  for (std::size_t i = 0; i < 25; ++i)
    EXPECT_NEAR(baked.direct.glossy.lights_shadowed[s * 25 + i], disc[i] + mirrored[i], 0.01f) << i;
}

}  // namespace
}  // namespace lambent::baker
