// Tests light that polished bodies focus, by quantities that mirrors conserve by symmetry.
#include "baker/effects/neighborhood/bodies.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/glossy_transport.hpp"
#include "tests/support/neighborhood.hpp"

namespace lambent::baker {
namespace {

using testing::ChangeMatrix;
using testing::glossyScene;
using testing::matrixOf;
using testing::ring;
using testing::Transport;

// Bakes a metal body with bounces.
struct Metal {
  Metal(const bundle::MeshData& mesh, float roughness, const glm::vec3& color, bool double_sided)
      : scene([&] {
          Scene made = glossyScene({mesh});
          made.materials[0].roughness = roughness;
          made.materials[0].base_color = glm::vec4(color, 1.0f);
          made.materials[0].double_sided = double_sided;
          return made;
        }()),
        transport(scene, true),
        surfaces(transport),
        baked(testing::bakeGlossy(transport, surfaces.kernels(), {.rays = 256, .bounces = 1})),
        body(transport.diffuse(), {.direct = baked.direct.field,
                                   .bounced = &baked.bounced.field,
                                   .sends = true,
                                   .brdfs = &surfaces.brdfs,
                                   .glossy = &baked.direct.glossy}) {}
  Scene scene;
  Transport transport;
  testing::TransportBrdfs surfaces;
  testing::GlossyBake baked;
  SurfaceBody body;
};

TEST(Caustics, OfAPerfectMirrorRingLeaveLightAboutItsAxisAsItIs) {
  // Vertical mirrors keep the z component of every direction, and lose nothing: light that depends on z alone
  // arrives as if there were no ring, from each direction. What depends on the azimuth does not.
  const Metal metal(ring(1.0f, 96), 0.0f, glm::vec3(1.0f), true);
  const CapDirections directions(4096);
  const ChangeShape shape{.order = 5, .order_out = 5, .channels = metal.body.channels()};
  PointChange point(metal.body, directions, shape);
  double others = 0.0;
  for (const float r : {0.0f, 0.4f, 0.8f, 1.7f}) {
    point.look({r, 0.1f * r, 0.02f});
    const ChangeMatrix matrix = matrixOf(shape, point.visibility(), point.bounced());
    for (int l = 0; l < 5; ++l)
      for (std::size_t i = 0; i < 25; ++i)
        EXPECT_NEAR(matrix[i * 25 + static_cast<std::size_t>(sh::coefficientIndex(l, 0))], 0.0f, 0.02f)
            << "r " << r << " l " << l << " output " << i;
    for (std::size_t at = 0; at < matrix.size(); ++at)
      others = testing::larger(others, std::abs(double{matrix[at]}));
  }
  EXPECT_GT(others, 0.3);
}

TEST(Caustics, TakeTheColourOfTheMetal) {
  const glm::vec3 gold(1.0f, 0.7f, 0.3f);
  const Metal white(ring(1.0f, 48), 0.0f, glm::vec3(1.0f), true), colored(ring(1.0f, 48), 0.0f, gold, true);
  ASSERT_EQ(white.body.channels(), 1u);
  ASSERT_EQ(colored.body.channels(), 3u);
  const CapDirections directions(1024);
  PointChange of_white(white.body, directions, {.order = 5, .order_out = 3, .channels = 1});
  PointChange of_colored(colored.body, directions, {.order = 5, .order_out = 3, .channels = 3});
  // The point sees the ring's outer side: one reflection, at angles where Fresnel's rise towards white is
  // small.
  of_white.look({3.0f, 0.0f, 0.5f}), of_colored.look({3.0f, 0.0f, 0.5f});
  const auto uniform = [](const PointChange& point, std::size_t c) {
    return double{point.bounced()[c * 225]};
  };
  const double all = uniform(of_white, 0);
  EXPECT_GT(all, 0.0);
  for (std::size_t c = 0; c < 3; ++c) {
    const double share = uniform(of_colored, c) / all, f0 = double{gold[static_cast<int>(c)]};
    EXPECT_GT(share, f0 - 0.01);
    EXPECT_LT(share, f0 + 0.25 * (1.0 - f0) + 0.01);
  }
}

TEST(Caustics, OfRoughMetalGoOverFromPathsToKernelsWithoutAStep) {
  // The roughness is just below, and just above, the one from which kernels are used.
  const auto ball = testing::icosphere({0, 0, 0}, 1.0f, 3);
  const Metal path(ball, 0.49f, glm::vec3(0.8f), false), kernel(ball, 0.51f, glm::vec3(0.8f), false);
  const CapDirections directions(2048);
  const ChangeShape shape{.order = 5, .order_out = 3, .channels = 1};
  PointChange a(path.body, directions, shape), b(kernel.body, directions, shape);
  for (const glm::vec3 p : {glm::vec3(1.5f, 0, 0), {0, 2.0f, 1.0f}, {-2, -2, 2}}) {
    a.look(p), b.look(p);
    EXPECT_LT(testing::relativeDifference(a.bounced(), b.bounced()), 0.08);
  }
}

TEST(HighlightSamples, OfAMirrorGoTheOtherWayWithItsReflectance) {
  PointReflection at;
  at.alpha_t = at.alpha_b = 1e-3f;
  at.f0 = glm::vec3(1.0f, 0.5f, 0.2f);
  at.f90 = 1.0f;
  for (const glm::vec3 to : {glm::vec3(0, 0, 1), glm::normalize(glm::vec3(1, 0.5f, 1))})
    for (std::uint32_t n = 0; n < 16; ++n) {
      const HighlightSample next = sampleHighlight(at, to, choices(n, 0));
      const glm::vec3 mirrored(-to.x, -to.y, to.z);
      EXPECT_LT(glm::distance(next.direction, mirrored), 0.1f);
      EXPECT_NEAR(next.weight.r, 1.0f, 1e-2f);
      const float past = 1.0f - to.z;
      EXPECT_NEAR(next.weight.g, 0.5f + 0.5f * std::pow(past, 5.0f), 2e-2f);
    }
}

TEST(HighlightSamples, OfALeaningNormalLookAtTheMirrorImageOfWhatTheTriangleHides) {
  PointReflection at;
  at.alpha_t = at.alpha_b = 1e-3f;
  at.f0 = glm::vec3(1.0f);
  at.f90 = 1.0f;
  const float lean = glm::radians(20.0f), low = glm::radians(15.0f);
  at.geometric = {-std::sin(lean), 0, std::cos(lean)};
  // Leaves the mirror 5 degrees below the triangle, and is seen 5 degrees above it.
  const HighlightSample next = sampleHighlight(at, {-std::cos(low), 0, std::sin(low)}, choices(0, 0));
  EXPECT_LT(glm::distance(next.direction, glm::vec3(std::cos(low), 0, std::sin(low))), 0.02f);
  EXPECT_NEAR(glm::dot(next.ray, at.geometric), std::sin(glm::radians(5.0f)), 0.01f);
  EXPECT_NEAR(next.weight.r, 1.0f, 1e-2f);
}

TEST(HighlightSamples, AddUpToTheDirectionalAlbedoOfTheTable) {
  // Compares ∫ f cos by these samples with Brdf::value over a fine grid of directions.
  const auto ggx = makeGgx(false);
  for (const float roughness : {0.3f, 0.6f, 1.0f}) {
    PointReflection at;
    at.alpha_t = at.alpha_b = roughness * roughness;
    at.f0 = glm::vec3(0.5f);
    at.f90 = 1.0f;
    const glm::vec3 to = glm::normalize(glm::vec3(0.8f, 0.0f, 0.6f));
    double sampled = 0.0;
    constexpr std::uint32_t kSamples = 4096;
    for (std::uint32_t n = 0; n < kSamples; ++n)
      sampled += double{sampleHighlight(at, to, choices(n, 0)).weight.r} / kSamples;
    double integral = 0.0;
    constexpr int kGrid = 400;
    for (int i = 0; i < kGrid; ++i)
      for (int j = 0; j < kGrid; ++j) {
        const double z = (i + 0.5) / kGrid, phi = 2.0 * std::numbers::pi * (j + 0.5) / kGrid;
        const double r = std::sqrt(1.0 - z * z);
        std::array<double, 2> f;
        ggx->value({roughness, 0.0f}, glm::dvec3(to), {r * std::cos(phi), r * std::sin(phi), z}, f);
        integral += (0.5 * f[0] + f[1]) * z * 2.0 * std::numbers::pi / (kGrid * kGrid);
      }
    EXPECT_NEAR(sampled, integral, 0.01 * integral) << roughness;
  }
}

}  // namespace
}  // namespace lambent::baker
