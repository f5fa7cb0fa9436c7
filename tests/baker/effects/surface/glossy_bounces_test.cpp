// Compares interreflection over glossy surfaces, and between glossy and diffuse ones, with closed forms.
#include "baker/effects/surface/bounces.hpp"
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
using testing::relativeDifference;
using testing::sceneOf;
using testing::shadowMatrix;
using testing::transformed;
using testing::Transport;
using testing::turned;
using testing::uniformRadiance;

// Makes a floor and a wall at a right angle, either of which may be glossy.
Scene corner(bool glossy_floor, bool glossy_wall, glm::vec3 floor_color = glm::vec3(0.8f)) {
  Scene scene =
      sceneOf({grid({0, 0, 0}, 1.0f, 12), transformed(turned(grid({0, 0, 0}, 1.0f, 12), -90.0f, {0, 0, 1}),
                                                      glm::translate(glm::mat4(1.0f), {-0.5f, 0.5f, 0}))});
  testing::ownMaterial(scene, 1).base_color = {0.6f, 0.6f, 0.6f, 1.0f};
  scene.materials[0].base_color = glm::vec4(floor_color, 1.0f);
  scene.materials[0].metallic = glossy_floor ? 1.0f : 0.0f;
  scene.materials[1].metallic = glossy_wall ? 1.0f : 0.0f;
  return scene;
}

// Returns the relative RMS difference over samples of the wall, or of the floor, that have the same place and
// normal in both scenes.
double difference(const Transport& a, const TransferField& of_a, const Transport& b,
                  const TransferField& of_b, bool wall) {
  double sum = 0.0, all = 0.0;
  for (std::size_t s = 0; s < a.samples.size(); ++s) {
    if ((std::abs(a.samples.normals[s].x) > 0.5f) != wall) continue;
    for (std::size_t q = 0; q < b.samples.size(); ++q) {
      if (a.samples.positions[s] != b.samples.positions[q] || a.samples.normals[s] != b.samples.normals[q])
        continue;
      for (std::size_t i = 0; i < of_a.at(s).size(); ++i) {
        sum += std::pow(double{of_a.at(s)[i]} - double{of_b.at(q)[i]}, 2);
        all += std::pow(double{of_b.at(q)[i]}, 2);
      }
    }
  }
  EXPECT_GT(all, 0.0);
  return std::sqrt(sum / all);
}

TEST(GlossyBounces, InAWhiteFurnaceLeaveUniformLightAsItIs) {
  // Nothing is lost, so uniform light arrives everywhere as uniform light: the first column is (1, 0, 0,
  // ...).
  const Transport t(glossyScene({testing::cup({2, 1, 2}, 6), icosphere({0.3f, -0.1f, 0.1f}, 0.3f, 3)}), true);
  const auto baked =
      bakeGlossy(t, lambertKernels(t), {.order = 4, .order_out = 5, .rays = 512, .bounces = kMostBounces});
  const GlossyField& field = baked.direct.glossy;
  ASSERT_EQ(field.bounced.size(), field.size() * 25 * 16);
  for (std::size_t s = 0; s < field.size(); ++s) {
    if (t.samples.originsOf(s).empty()) continue;
    const auto shadow = shadowMatrix(field, s);
    // The first two passes are exact but for the corner of the triangle that each pair of rays picks. All
    // later ones arrive as the second does, and leave alike in all directions.
    for (std::size_t i = 0; i < 25; ++i)
      EXPECT_NEAR(shadow[i * 16] + field.bounced[(s * 25 + i) * 16], i == 0 ? 1.0f : 0.0f, 1.6e-2f) << i;
    EXPECT_NEAR(uniformRadiance(baked.direct.field.at(s)) + uniformRadiance(baked.bounced.field.at(s)), 1.0f,
                1.6e-2f);
  }
}

TEST(GlossyBounces, OfALambertKernelAreThoseOfAMatteSurfaceInBothDirections) {
  // Light bounces between floor and wall, of which the floor, the wall or both are nominally glossy. The only
  // difference is the receiver's or sender's cosine, of which a glossy one has five bands.
  const Transport matte(corner(false, false));
  const auto truth = matte.bake(5, 1024, 2);
  for (const auto& [floor, wall] : {std::pair{true, false}, {false, true}, {true, true}}) {
    const Transport t(corner(floor, wall), true);
    const auto baked = bakeGlossy(t, lambertKernels(t), {.rays = 1024, .bounces = 2});
    EXPECT_LT(difference(t, baked.bounced.field, matte, truth.bounced.field, /*wall=*/true), 0.03)
        << floor << wall;
    EXPECT_LT(difference(t, baked.bounced.field, matte, truth.bounced.field, /*wall=*/false), 0.03)
        << floor << wall;
  }
}

TEST(GlossyBounces, ReachNormalMappedSurfacesAsThoseOfAMatteSurfaceDo) {
  const auto mapped_wall = [](bool glossy_floor) {
    Scene scene = corner(glossy_floor, false);
    scene.textures.push_back({-1, {}});
    scene.materials[1].normal_texture.texture = 0;
    return scene;
  };
  const Transport matte(mapped_wall(false)), t(mapped_wall(true), true);
  ASSERT_GT(t.samples.glossy.begin, t.samples.normal_mapped.begin);
  ASSERT_GT(t.samples.size(), t.samples.glossy.begin);
  const auto truth = matte.bake(5, 1024, 1);
  const auto baked = bakeGlossy(t, lambertKernels(t), {.rays = 1024, .bounces = 1});
  EXPECT_EQ(baked.direct.mapped.vectors, truth.direct.mapped.vectors);
  EXPECT_LT(relativeDifference(baked.bounced.mapped.vectors, truth.bounced.mapped.vectors), 0.03);
}

TEST(GlossyBounces, AskForTheDirectionThatLightLeavesIn) {
  // A large floor sends cos(theta) of what it gets from everywhere; a small diffuse plate that looks down on
  // it gets (1/pi) ∫ cos² = 2/3.
  const auto plate =
      transformed(flipped(grid({0, 0, 0}, 0.02f, 2)), glm::translate(glm::mat4(1.0f), {0, 1, 0}));
  Scene scene = sceneOf({grid({0, 0, 0}, 200.0f, 100), plate});
  testing::ownMaterial(scene, 1);
  scene.materials[0].metallic = 1.0f;
  const Transport t(scene, true);
  const ExitKernels kernels{true, [](std::uint32_t, float, float, const glm::vec3& to, std::span<float> out) {
                              std::fill(out.begin(), out.end(), 0.0f);
                              for (std::size_t c = 0; c < 3; ++c) out[c * out.size() / 3] = to.y;
                            }};
  const auto baked = bakeGlossy(t, kernels, {.rays = 2048, .bounces = 1});
  const std::size_t s = t.sampleAt({0, 1, 0});
  ASSERT_LT(s, t.samples.glossy.begin);
  EXPECT_NEAR(baked.bounced.field.at(s)[0], 2.0f / 3.0f, 5e-3f);
  for (std::size_t i = 1; i < 25; ++i) EXPECT_NEAR(baked.bounced.field.at(s)[i], 0.0f, 5e-3f);
}

TEST(GlossyBounces, InASphereSpreadALampEvenly) {
  // A lamp of 1 cd is in the centre of a closed sphere of radius 2 and albedo 1/2. The wall emits albedo
  // E/pi, and all bounces together albedo / (1 - albedo) E/pi, the same everywhere. The lamp is on every
  // normal, so of its E/pi = 1 / (pi r²) five bands of the cosine and the mirror image see 2 (1 + 5/4 - 9/24)
  // / 4 instead of 1 (the odd bands cancel).
  Scene scene = glossyScene({flipped(icosphere({0, 0, 0}, 2.0f, 4))});
  scene.materials[0].base_color = glm::vec4(glm::vec3(0.5f), 1.0f);
  testing::addPointLight(scene, {0, 0, 0});
  const Transport t(scene, true);
  const auto baked = bakeGlossy(t, lambertKernels(t), {.rays = 256, .bounces = -1, .tail_error = 1e-4});
  const GlossyField& field = baked.direct.glossy;
  const float seen = 0.5f * (1.0f + 1.25f - 0.375f);
  const float uniform =
      std::sqrt(4.0f * std::numbers::pi_v<float>) * seen / (std::numbers::pi_v<float> * 4.0f);
  for (std::size_t s = 0; s < field.size(); ++s)
    for (std::size_t i = 0; i < 25; ++i) {
      const float added = field.lights_full[s * 25 + i] - field.lights_shadowed[s * 25 + i];
      EXPECT_NEAR(added, i == 0 ? uniform : 0.0f, 0.01f * uniform) << i;
    }
}

TEST(GlossyBounces, CarryColourAndLoseEnergyFromPassToPass) {
  const Transport t(corner(true, true, {0.9f, 0.1f, 0.1f}), true);
  const auto baked = bakeGlossy(t, lambertKernels(t), {.rays = 256, .bounces = 4});
  const GlossyField& field = baked.direct.glossy;
  ASSERT_EQ(field.channels, 3u);
  std::size_t wall = 0;
  for (std::size_t s = 0; s < field.size(); ++s)
    if (t.samples.normals[s].x > 0.5f && t.samples.positions[s].y < 0.3f && t.samples.positions[s].y > 0.1f)
      wall = s;
  const auto at = [&](std::size_t channel) { return field.bounced[(wall * 3 + channel) * 625]; };
  EXPECT_GT(at(0), 3.0f * at(1));
  EXPECT_EQ(at(1), at(2));
  ASSERT_EQ(baked.bounced.energy.size(), 5u);
  for (std::size_t b = 1; b < 5; ++b)
    EXPECT_LT(baked.bounced.energy[b], 0.5 * baked.bounced.energy[b - 1]) << b;
}

TEST(GlossyBounces, HaveThreeChannelsWhereKernelsAreColoured) {
  const Transport t(corner(true, false), true);
  ASSERT_TRUE(t.colors.grey());
  ExitKernels kernels = lambertKernels(t);
  kernels.grey = false;
  const auto of_lambert = kernels.at;
  kernels.at = [&](std::uint32_t triangle, float u, float v, const glm::vec3& to, std::span<float> out) {
    of_lambert(triangle, u, v, to, out);
    for (float& blue : out.last(out.size() / 3)) blue = 0.0f;
  };
  const auto baked = bakeGlossy(t, kernels, {.rays = 128, .bounces = 1});
  EXPECT_EQ(baked.direct.glossy.channels, 3u);
  const std::size_t s = t.sampleAt({-0.5f, 0.25f, 0.0f});
  ASSERT_LT(s, t.samples.glossy.begin);
  const auto transfer = baked.bounced.field.at(s);
  EXPECT_GT(transfer[0], 0.01f);
  EXPECT_EQ(transfer[0], transfer[25]);
  EXPECT_EQ(transfer[50], 0.0f);
}

// Every point reflects by `kernel`, for every direction.
ExitKernels everywhere(std::span<const float> kernel) {
  return {.grey = true, .at = [kernel](std::uint32_t, float, float, const glm::vec3&, std::span<float> out) {
            for (std::size_t c = 0; c < 3; ++c)
              std::copy_n(kernel.begin(), out.size() / 3,
                          out.begin() + static_cast<std::ptrdiff_t>(c * out.size() / 3));
          }};
}

// Makes kernels with nothing in the bands that are kept: a second pass has light only if the first one stored
// it in the bands above.
TEST(GlossyBounces, LightLeavesByAllBandsOfTheKernelInEveryPass) {
  constexpr int kExit = 7;
  const Transport t(corner(true, true), true);
  std::array<float, kExit * kExit> lobe{};
  sh::evaluate(kExit, glm::normalize(glm::vec3(1.0f, 2.0f, 0.5f)), lobe);
  std::fill_n(lobe.begin(), 25, 0.0f);
  const ExitKernels kernels = everywhere(lobe);
  const auto once = bakeGlossy(t, kernels, {.exit_order = kExit, .rays = 512, .bounces = 1});
  const auto twice = bakeGlossy(t, kernels, {.exit_order = kExit, .rays = 512, .bounces = 2});
  ASSERT_EQ(twice.bounced.energy.size(), 3u);
  EXPECT_GT(twice.bounced.energy[1], 0.05);
  double first = 0.0, second = 0.0;
  for (std::size_t i = 0; i < once.bounced.field.vectors.size(); ++i) {
    const double a = double{once.bounced.field.vectors[i]}, b = double{twice.bounced.field.vectors[i]};
    first += a * a, second += (b - a) * (b - a);
  }
  EXPECT_GT(std::sqrt(second / first), 0.03);
}

TEST(GlossyBounces, WithMoreBandsForWhatLeavesHaveAsManyAsWereAskedFor) {
  // Lambert surfaces have almost nothing in the bands above.
  const Transport t(corner(true, false), true);
  const auto few = bakeGlossy(t, lambertKernels(t), {.rays = 512, .bounces = 3});
  for (const int exit : {7, 9}) {
    const auto more = bakeGlossy(t, lambertKernels(t), {.exit_order = exit, .rays = 512, .bounces = 3});
    EXPECT_EQ(more.direct.glossy.order_out, 5);
    EXPECT_LT(relativeDifference(more.direct.glossy.visibility, few.direct.glossy.visibility), 0.01) << exit;
    EXPECT_LT(relativeDifference(more.direct.glossy.bounced, few.direct.glossy.bounced), 0.02) << exit;
    EXPECT_LT(relativeDifference(more.bounced.field.vectors, few.bounced.field.vectors), 0.02) << exit;
    for (std::size_t b = 0; b < few.bounced.energy.size(); ++b)
      EXPECT_NEAR(more.bounced.energy[b], few.bounced.energy[b], 0.01) << exit;
  }
}

TEST(GlossyBounces, OfNoneLeaveTheFieldWithoutThem) {
  const Transport t(corner(true, false), true);
  const auto baked = bakeGlossy(t, lambertKernels(t), {.rays = 128});
  EXPECT_TRUE(baked.direct.glossy.bounced.empty());
  EXPECT_FALSE(baked.direct.glossy.visibility.empty());
}

TEST(GlossyBounces, OfRealMetalsNeverAddUpToMoreThanTheLightThatCame) {
  for (const float roughness : {0.2f, 0.5f, 0.9f}) {
    Scene scene = glossyScene({testing::cup({2, 1, 2}, 6), icosphere({0.3f, -0.1f, 0.1f}, 0.3f, 2)});
    scene.materials[0].roughness = roughness;
    const Transport t(scene, true);
    const testing::TransportBrdfs surfaces(t);
    const auto baked = bakeGlossy(t, surfaces.kernels(), {.rays = 512, .bounces = 12});
    const GlossyField& field = baked.direct.glossy;
    double largest = 0.0, most = 0.0;
    for (std::size_t s = 0; s < field.size(); ++s) {
      if (t.samples.originsOf(s).empty()) continue;
      // l' of uniform light is a function whose mean over the sphere is checked, and its E/pi on the sample's
      // own plane.
      const double mean = double{shadowMatrix(field, s)[0]} + double{field.bounced[s * 625]};
      largest = testing::larger(largest, mean);
      most = testing::larger(most, double{uniformRadiance(baked.direct.field.at(s)) +
                                          uniformRadiance(baked.bounced.field.at(s))});
      EXPECT_GT(field.bounced[s * 625], -1e-6f);
    }
    // The tolerance is 2 % for what five bands lose of narrow lobes and sharp edges, and 5 % of light that is
    // passed on between patches, which reflect alike in all directions (bounces.cpp, kMostOff).
    EXPECT_LT(largest, 1.05) << roughness;
    EXPECT_LT(most, 1.07) << roughness;
    for (std::size_t b = 1; b < baked.bounced.energy.size(); ++b)
      EXPECT_LT(baked.bounced.energy[b], baked.bounced.energy[b - 1]) << roughness << " pass " << b;
  }
}

TEST(GlossyBounces, OfFewBandsOfLightAreTheFirstColumnsOfThoseOfMany) {
  // Passes leave columns where they are, so fewer bands of light give the same matrices, cut: but for the
  // weights of rays, which are exact for other bands of visibility.
  const Transport t(glossyScene({testing::cup({2, 1, 2}, 6)}), true);
  for (const int order_out : {4, 6}) {
    const auto kernels = lambertKernels(t);
    const auto outputs = static_cast<std::size_t>(order_out * order_out);
    const auto whole =
        bakeGlossy(t, kernels, {.order = 6, .order_out = order_out, .rays = 512, .bounces = 2});
    for (const int order : {1, 2, 3}) {
      const auto columns = static_cast<std::size_t>(order * order);
      const auto cut =
          bakeGlossy(t, kernels, {.order = order, .order_out = order_out, .rays = 512, .bounces = 2});
      ASSERT_EQ(cut.direct.glossy.bounced.size(), whole.direct.glossy.bounced.size() / 36 * columns);
      double wrong = 0.0, all = 0.0;
      for (std::size_t s = 0; s < cut.direct.glossy.size(); ++s) {
        const auto a = shadowMatrix(cut.direct.glossy, s), b = shadowMatrix(whole.direct.glossy, s);
        for (std::size_t k = 0; k < outputs; ++k)
          for (std::size_t i = 0; i < columns; ++i) {
            const double is = double{a[k * columns + i]} +
                              double{cut.direct.glossy.bounced[(s * outputs + k) * columns + i]},
                         should = double{b[k * 36 + i]} +
                                  double{whole.direct.glossy.bounced[(s * outputs + k) * 36 + i]};
            wrong += (is - should) * (is - should);
            all += should * should;
          }
      }
      EXPECT_LT(std::sqrt(wrong / all), 6e-3) << order << " to " << order_out;
    }
  }
}

}  // namespace
}  // namespace lambent::baker
