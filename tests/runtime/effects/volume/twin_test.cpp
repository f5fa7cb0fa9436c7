// Compares rays through media, by the shaders as C++, with closed forms.
#include <numbers>

#include <glm/gtc/quaternion.hpp>
#include <gtest/gtest.h>

#include "tests/runtime/effects/volume/media.hpp"

namespace lambent::effects::volume {
namespace {

using namespace testing;

constexpr float kPi = std::numbers::pi_v<float>;

BuiltVolume homogeneous(float extinction) {
  BuiltVolume built;
  built.density_max = extinction;
  built.density = [extinction](const glm::vec3&) { return extinction; };
  return built;
}

// Makes clumps of so many voxels, from -1 to 1 m along each axis.
BuiltVolume clumped(unsigned seed, const glm::uvec3& size, float density_max) {
  BuiltVolume built;
  built.size = size;
  built.group_from_grid =
      glm::scale(glm::translate(glm::mat4(1.0f), glm::vec3(-1.0f)), 2.0f / glm::vec3(size));
  built.density_max = density_max;
  built.density = [=, shape = clumps(seed, static_cast<float>(size.x))](const glm::vec3& at) {
    return density_max * shape(at);
  };
  return built;
}

// Makes rays from outside or inside, in all directions, some of them along axes and faces of blocks.
struct Aim {
  glm::vec3 origin, direction;
};
std::vector<Aim> someAims(int count) {
  std::mt19937 engine(7);
  const auto number = [&](float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(engine);
  };
  std::vector<Aim> aims;
  for (int i = 0; i < count; ++i) {
    const glm::vec3 origin(number(-2, 2), number(-2, 2), number(-2, 2));
    const glm::vec3 target(number(-0.9f, 0.9f), number(-0.9f, 0.9f), number(-0.9f, 0.9f));
    aims.push_back({origin, glm::normalize(target - origin)});
  }
  for (const float place : {-0.75f, -0.5f, 0.0f, 0.25f, 0.5f})
    for (int axis = 0; axis < 3; ++axis)
      for (const float side : {-1.0f, 1.0f}) {
        glm::vec3 origin(place), direction(0.0f);
        origin[axis] = -2.0f * side;
        direction[axis] = side;
        aims.push_back({origin, direction});
        direction[(axis + 1) % 3] = 1e-7f;
        aims.push_back({origin, direction});
        direction[(axis + 1) % 3] = -3e-6f;
        aims.push_back({origin, glm::normalize(direction)});
      }
  return aims;
}

// Returns the length of a ray in a box of 2 m about the origin.
float chord(const Aim& aim) {
  float enter = 0.0f, leave = 1e30f;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(aim.direction[axis]) < 1e-9f) {
      if (std::abs(aim.origin[axis]) > 1.0f) return 0.0f;
      continue;
    }
    const float a = (-1.0f - aim.origin[axis]) / aim.direction[axis];
    const float b = (1.0f - aim.origin[axis]) / aim.direction[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return std::max(leave - enter, 0.0f);
}

}  // namespace

TEST(VolumeMarch, AHomogeneousBoxTransmitsTheExponentialOfItsChord) {
  for (const float extinction : {1e-6f, 0.1f, 1.0f, 2.5f}) {
    BuiltVolume built = homogeneous(extinction);
    built.size = glm::uvec3(32);
    built.group_from_grid =
        glm::scale(glm::translate(glm::mat4(1.0f), glm::vec3(-1.0f)), glm::vec3(1.0f / 16.0f));
    const Medium medium = mediumOf(built, whiteLight);
    for (const Aim& aim : someAims(300)) {
      const glm::vec4 found = march(medium, {aim.origin, aim.direction});
      EXPECT_NEAR(found.a, extinction * chord(aim), 2e-5f * extinction)
          << extinction << " " << aim.origin.x << " " << aim.origin.y << " " << aim.origin.z << " along "
          << aim.direction.x << " " << aim.direction.y << " " << aim.direction.z;
      EXPECT_NEAR(found.r, -std::expm1(-double{extinction} * chord(aim)), 2e-4f * std::min(extinction, 1.0f));
    }
  }
}

TEST(VolumeMarch, AtAnyDensityScattersNoMoreThanItTakesAway) {
  // The medium is white, with light 1 in it and behind it: the result is 1 everywhere, up to the 1e-4 at
  // which rays end.
  for (const float density_max : {0.0f, 1e-6f, 0.3f, 10.0f, 300.0f, 1e6f}) {
    const Medium medium = mediumOf(clumped(3, {24, 20, 28}, density_max), whiteLight);
    for (const Aim& aim : someAims(300)) {
      const glm::vec4 found = march(medium, {aim.origin, aim.direction});
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c] + std::exp(-found.a), 1.0f, 1e-3f) << density_max;
      ASSERT_TRUE(std::isfinite(found.a));
      if (density_max == 0.0f) {
        EXPECT_EQ(found, glm::vec4(0.0f));
      }
    }
  }
}

TEST(VolumeMarch, AStepIsExactWhereDensityIsConstantAndLightLinear) {
  // The light is x, on a ray along x: the result is int s exp(-s u) (x0 + u) du for any step, thick or thin.
  for (const float extinction : {1e-3f, 1.0f, 50.0f, 1e4f}) {
    BuiltVolume built = homogeneous(extinction);
    built.transfer_size = glm::uvec3(8);
    const Medium medium = mediumOf(built, [](const glm::uvec3& texel) {
      return glm::vec4(glm::vec3(static_cast<float>(texel.x)), 1.0f);
    });
    // Texel x has its centre at -1 + (x + 0.5) / 4 m; the outermost half voxel is left out.
    const float begin = 3.0f - 0.875f, length = 1.75f;
    for (const float step : {0.25f, 0.5f, 8.0f}) {
      const glm::vec4 found =
          march(medium, {glm::vec3(-3.0f, 0.1f, 0.2f), glm::vec3(1, 0, 0), begin, begin + length}, step);
      const double s = extinction, d = length;
      const double expected = 4.0 * (-std::expm1(-s * d) / s - d * std::exp(-s * d));
      EXPECT_NEAR(found.r, expected, 2e-3 * expected) << extinction << " step " << step;
    }
  }
}

TEST(VolumeMarch, HalfTheStepChangesThePictureByLessThanHalfAPercent) {
  for (const float density_max : {2.0f, 20.0f, 200.0f}) {
    BuiltVolume built = clumped(5, glm::uvec3(48), density_max);
    built.transfer_size = glm::uvec3(16);
    const Medium medium = mediumOf(built, [](const glm::uvec3& texel) {
      const glm::vec3 t(texel);
      return glm::vec4(0.6f + 0.4f * glm::sin(0.9f * t), 1.0f);
    });
    double change = 0.0, power = 0.0;
    const float default_step = MarchOptions{}.step_voxels;
    for (const Aim& aim : someAims(1500)) {
      const auto seen = [&](float step) {
        const glm::vec4 found = march(medium, {aim.origin, aim.direction, 0.0f, kInfinity}, step);
        return glm::dvec3(found) + std::exp(-double{found.a}) * glm::dvec3(0.2, 0.5, 1.0);
      };
      const glm::dvec3 whole = seen(default_step), half = seen(0.5f * default_step);
      change += glm::dot(whole - half, whole - half);
      power += glm::dot(half, half);
    }
    EXPECT_LT(std::sqrt(change / power), 0.005) << density_max;
  }
}

TEST(VolumeMarch, JitterChangesNothingThatCanBeSeen) {
  const Medium medium = mediumOf(clumped(5, glm::uvec3(48), 20.0f), whiteLight);
  double change = 0.0, power = 0.0;
  int number = 0;
  for (const Aim& aim : someAims(1000)) {
    const float jitter = static_cast<float>(++number % 16 + 1) / 16.0f;
    const float plain = std::exp(-march(medium, {aim.origin, aim.direction}).a);
    const float jittered =
        std::exp(-march(medium, {aim.origin, aim.direction, 0.0f, kInfinity}, 1.0f, jitter).a);
    change += std::pow(plain - jittered, 2.0);
    power += std::pow(plain, 2.0);
  }
  EXPECT_LT(std::sqrt(change / power), 0.005);
}

TEST(VolumeMarch, OverlappingVolumesAddTheirExtinctions) {
  // There are two boxes, one of them rotated and moved; only the first one's light is 1.
  BuiltVolume first = homogeneous(0.7f), second = homogeneous(1.3f);
  second.size = {5, 9, 16};
  second.group_from_grid =
      glm::scale(glm::translate(glm::mat4(1.0f), glm::vec3(-1.0f)), 2.0f / glm::vec3(5, 9, 16));
  const glm::mat4 place = glm::translate(glm::mat4(1.0f), glm::vec3(0.6f, 0.3f, -0.2f)) *
                          glm::mat4_cast(glm::angleAxis(0.7f, glm::normalize(glm::vec3(1, 2, 3))));
  const std::vector<Medium> media = {mediumOf(first, whiteLight), mediumOf(second, whiteLight, place)};
  const std::vector<Medium> lit = {
      media[0], mediumOf(
                    second, [](const glm::uvec3&) { return glm::vec4(0, 0, 0, 1); }, place)};
  for (const Aim& aim : someAims(500)) {
    const glm::mat4 back = glm::inverse(place);
    const Aim turned{glm::vec3(back * glm::vec4(aim.origin, 1.0f)),
                     glm::vec3(back * glm::vec4(aim.direction, 0.0f))};
    const glm::vec4 found = march(media, {aim.origin, aim.direction});
    EXPECT_NEAR(found.a, 0.7f * chord(aim) + 1.3f * chord(turned), 1e-4f);
    EXPECT_NEAR(found.r + std::exp(-found.a), 1.0f, 1e-4f);
  }
  // The ray starts and ends where both are: light is shared in proportion to extinction.
  const glm::vec3 origin(0.3f, 0.2f, 0.0f), along = glm::normalize(glm::vec3(1, 0.2f, 0.1f));
  const glm::vec4 found = march(lit, {origin, along, 0.0f, 0.3f});
  EXPECT_NEAR(found.r, 0.35f * (1.0f - std::exp(-2.0f * 0.3f)), 1e-5f);
}

TEST(VolumeMarch, RaysEndAtTheSurfaceAndMayStartInside) {
  const Medium medium = mediumOf(homogeneous(2.0f), whiteLight);
  const auto depth = [&](float begin, float end) {
    return march(medium, {glm::vec3(-1.5f, 0.1f, 0.1f), glm::vec3(1, 0, 0), begin, end}).a;
  };
  EXPECT_EQ(depth(0.0f, 0.4f), 0.0f) << "a wall before it";
  EXPECT_NEAR(depth(0.0f, 1.1f), 1.2f, 1e-5f);
  EXPECT_NEAR(depth(1.0f, 1.1f), 0.2f, 1e-5f);
  EXPECT_NEAR(depth(2.0f, kInfinity), 1.0f, 1e-5f);
  EXPECT_EQ(depth(2.6f, kInfinity), 0.0f) << "behind the eye";
}

TEST(VolumeMarch, SeveralStopsAreWhatSeveralRaysWouldSee) {
  const Medium medium = mediumOf(clumped(9, glm::uvec3(24), 5.0f), whiteLight);
  for (const Aim& aim : someAims(200)) {
    const auto both = marchTo<2>({1.9f, 2.4f}, medium, {aim.origin, aim.direction}, 0.1f, 1.0f);
    EXPECT_LT(glm::distance(both[0], march(medium, {aim.origin, aim.direction, 0.0f, 1.9f}, 0.1f)), 2e-3f);
    EXPECT_LT(glm::distance(both[1], march(medium, {aim.origin, aim.direction, 0.0f, 2.4f}, 0.1f)), 2e-3f);
  }
}

TEST(VolumeMarch, SkippingEmptyBlocksLosesNothing) {
  std::mt19937 engine(11);
  BuiltVolume built;
  built.size = {33, 17, 40};
  built.group_from_grid =
      glm::scale(glm::translate(glm::mat4(1.0f), glm::vec3(-1.0f)), 2.0f / glm::vec3(33, 17, 40));
  std::vector<float> sparse(33 * 17 * 40, 0.0f);
  for (int i = 0; i < 60; ++i) sparse[engine() % sparse.size()] = 1.0f;
  built.density = [&](const glm::vec3& at) {
    const glm::uvec3 voxel(at);
    return sparse[voxel.x + 33 * (voxel.y + 17 * voxel.z)];
  };
  built.density_max = 1.0f;
  const Medium medium = mediumOf(built, whiteLight);
  EXPECT_GT(std::count(medium.block_maxima.begin(), medium.block_maxima.end(), 0.0f), 10);
  Medium filled = medium;
  filled.block_maxima.assign(medium.block_maxima.size(), 1.0f);
  for (const Aim& aim : someAims(1000)) {
    const float expected = march(filled, {aim.origin, aim.direction}).a;
    EXPECT_NEAR(march(medium, {aim.origin, aim.direction}).a, expected, 1e-5f + 1e-4f * expected);
  }
}

TEST(VolumeMarch, AVolumeThatIsScaledKeepsItsOpticalDepth) {
  // Transfer is of the volume as baked: grown to twice its size it looks the same.
  const BuiltVolume built = homogeneous(2.0f);
  const Medium small = mediumOf(built, whiteLight),
               large = mediumOf(built, whiteLight, glm::scale(glm::mat4(1.0f), glm::vec3(2.0f)));
  for (const Aim& aim : someAims(100))
    EXPECT_NEAR(march(small, {aim.origin, aim.direction}).a,
                march(large, {2.0f * aim.origin, aim.direction}).a, 1e-4f);
}

TEST(VolumeMarch, ForwardScatteringIsBrightTowardsTheLight) {
  // For a beam from s0 in n bands, S(d) = sum_l g^l (2l + 1)/4pi P_l(s0 . d).
  const glm::vec3 towards_light = glm::normalize(glm::vec3(0.3f, 0.8f, -0.5f));
  for (const float g : {-0.6f, 0.0f, 0.5f, 0.8f})
    for (const uint outputs : {9u, 16u, 25u, 36u}) {
      BuiltVolume built = homogeneous(1e5f);  // S alone: nothing shines through
      built.g = g;
      built.shape.outputs = outputs;
      std::vector<float> y(outputs);
      sh::evaluate(static_cast<int>(transfer::bandsOf(outputs)), towards_light, y);
      const glm::mat4 place = glm::mat4_cast(glm::angleAxis(0.9f, glm::normalize(glm::vec3(-1, 2, 1))));
      Medium medium = mediumOf(built, whiteLight, place);
      const SlabLayout layout = slabLayoutOf(built.transfer_size, outputs);
      std::vector<glm::vec4> samples;
      std::vector<uint> voxels = built.voxels();
      for (std::size_t v = 0; v < voxels.size(); ++v)
        for (const float value : y) samples.emplace_back(glm::vec3(value), 1.0f);
      const ScatterRecord record{.first_output = 0,
                                 .first_voxel = 0,
                                 .sample_count = static_cast<uint>(voxels.size()),
                                 .outputs = outputs,
                                 .size = {4, 4, 4},
                                 .slabs_z = layout.slabs_z,
                                 .open = 0,
                                 .light = 0,
                                 .g = g,
                                 .pad = 0};
      scatter(record, voxels, samples, {}, medium.light);
      const auto seen = [&](const glm::vec3& along) { return march(medium, {-3.0f * along, along}).r; };
      const glm::vec3 light_ws = glm::vec3(place * glm::vec4(towards_light, 0.0f));
      for (const Aim& aim : someAims(50)) {
        const double x = glm::dot(aim.direction, light_ws);
        double before = 1.0, legendre = x, expected = 1.0 / (4 * kPi), power = g;
        for (uint l = 1; l * l < outputs; ++l, power *= g) {
          expected += power * (2 * l + 1) / (4 * kPi) * legendre;
          const double next = ((2 * l + 1) * x * legendre - l * before) / (l + 1);
          before = legendre;
          legendre = next;
        }
        EXPECT_NEAR(seen(aim.direction), expected, 2e-4) << g << " " << outputs;
      }
      if (g > 0.0f) {
        EXPECT_GT(seen(light_ws), 2.0f * std::abs(seen(-light_ws)));
      }
      if (g < 0.0f) {
        EXPECT_LT(2.0f * std::abs(seen(light_ws)), seen(-light_ws));
      }
    }
}

TEST(VolumeMarch, VoxelsWithoutLightDoNotDarkenTheirNeighbours) {
  const BuiltVolume built = homogeneous(1e5f);
  const Medium medium = mediumOf(
      built, [](const glm::uvec3& texel) { return texel.x == 0 ? glm::vec4(0.0f) : glm::vec4(1.0f); });
  for (const float y : {-0.7f, 0.0f, 0.3f})
    for (const float x : {-0.9f, -0.7f, 0.4f}) {
      const float seen = march(medium, {glm::vec3(x, y, 3.0f), glm::vec3(0, 0, -1)}).r;
      EXPECT_NEAR(seen, x < -0.8f ? 0.0f : 1.0f, 1e-3f) << x << " " << y;
    }
}

TEST(VolumeRectangle, HoldsEveryPixelWhoseRayMeetsTheBox) {
  std::mt19937 engine(17);
  const auto number = [&](float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(engine);
  };
  const spec::Size picture{40, 24};
  int hits = 0, spared = 0;
  for (int i = 0; i < 300; ++i) {
    const BuiltVolume built = homogeneous(1.0f);
    const glm::vec3 eye(number(-4, 4), number(-4, 4), number(-4, 4));
    const glm::mat4 view_from_world =
        glm::lookAt(eye, eye + glm::vec3(number(-1, 1), number(-1, 1), number(-1, 1)), glm::vec3(0, 1, 0));
    const bool perspective = i % 3 != 0;
    const glm::mat4 clip_from_view = perspective
                                         ? glm::perspective(number(0.3f, 2.0f), 40.0f / 24.0f, 0.1f, 30.0f)
                                         : glm::ortho(-2.0f, 3.0f, -1.0f, 1.5f, 0.1f, 30.0f);
    const Medium medium = mediumOf(built, whiteLight, glm::mat4(1.0f), view_from_world);
    const Rectangle found =
        rectangleOf(clip_from_view * view_from_world * built.group_from_grid, built.size, picture);
    for (std::uint32_t y = 0; y < picture.height; ++y)
      for (std::uint32_t x = 0; x < picture.width; ++x) {
        const glm::vec2 clip = (glm::vec2(x, y) + 0.5f) / glm::vec2(40.0f, 24.0f) * 2.0f - 1.0f;
        const glm::mat4 view_from_clip = glm::inverse(clip_from_view);
        const glm::vec4 near = view_from_clip * glm::vec4(clip, -1.0f, 1.0f),
                        far = view_from_clip * glm::vec4(clip, 1.0f, 1.0f);
        const glm::vec3 begin = glm::vec3(near) / near.w, end = glm::vec3(far) / far.w;
        const glm::vec4 gathered =
            march(medium, {begin, glm::normalize(end - begin), 0.0f, glm::distance(begin, end)});
        const auto px = static_cast<std::int32_t>(x), py = static_cast<std::int32_t>(y);
        const bool inside =
            px >= found.first.x && px < found.end.x && py >= found.first.y && py < found.end.y;
        if (gathered.a > 0.0f) {
          ASSERT_TRUE(inside) << "view " << i;
          ++hits;
        }
        spared += inside ? 0 : 1;
      }
  }
  EXPECT_GT(hits, 10'000);
  EXPECT_GT(spared, 50'000);
}

TEST(VolumeRectangle, AFlatVolumeIsNotDrawn) {
  EXPECT_FALSE(describeMarch(testing::residentOf(homogeneous(1.0f)),
                             glm::scale(glm::mat4(1.0f), glm::vec3(1, 0, 1)), glm::mat4(1.0f)));
}

TEST(VolumeSlabs, FitIntoATextureOfAnyDevice) {
  for (const uint side : {1u, 4u, 32u, 128u, 256u})
    for (const uint outputs : {1u, 9u, 16u, 25u, 36u}) {
      const SlabLayout layout = slabLayoutOf(glm::uvec3(side), outputs);
      EXPECT_GE(layout.slabs_x * layout.slabs_z, outputs);
      EXPECT_LE(layout.texture_size.x, kMaxLightSide);
      EXPECT_LE(layout.texture_size.z, kMaxLightSide);
    }
}

}  // namespace lambent::effects::volume
