// Compares key_light.glsl with itself as C++ on random lights, places and normals over blocks on a floor, and
// the pyramid over shadow maps with the minimum and maximum of all texels.
#include <bit>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "lambent_shadows_embedded.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/gpu/program.hpp"
#include "test_key_shadows_embedded.hpp"
#include "tests/runtime/shadows/random.hpp"
#include "tests/runtime/shadows/shadow_shaders.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::frame {
namespace {

constexpr gpu::FindText kShaders[] = {&embedded::test_key_shadows::find, &embedded::lambent_shadows::find};

// Joins maps side by side in a row of tiles, as in KeyShadows.
struct Textures {
  gpu::Texture depths, blockers;
  Textures(int width, int height, const std::vector<float>& texels)
      : depths("depths", {.format = GL_DEPTH_COMPONENT32F,
                          .width = static_cast<std::uint32_t>(width),
                          .height = static_cast<std::uint32_t>(height)}),
        blockers("blockers", {.format = GL_RG32F,
                              .width = static_cast<std::uint32_t>(width) / kBlockerTexels,
                              .height = static_cast<std::uint32_t>(height) / kBlockerTexels,
                              .levels = static_cast<std::uint32_t>(
                                  std::bit_width(static_cast<std::uint32_t>(width) / kBlockerTexels))}) {
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTextureSubImage2D(depths.id(), 0, 0, 0, width, height, GL_DEPTH_COMPONENT, GL_FLOAT, texels.data());
  }
};

// Builds the pyramid of a tile at (x, y) by key_blockers.comp, level by level.
void makePyramid(const gpu::Program& program, const Textures& textures, int x, int y, int size) {
  program.use();
  textures.depths.bind(0);
  textures.blockers.bind(1);
  glBindSampler(0, 0);
  glBindSampler(1, 0);
  for (std::uint32_t level = 0; level < textures.blockers.desc().levels; ++level) {
    const int texels = static_cast<int>(kBlockerTexels) << level;
    if (size / texels == 0) continue;
    glBindImageTexture(0, textures.blockers.id(), static_cast<GLint>(level), GL_FALSE, 0, GL_WRITE_ONLY,
                       GL_RG32F);
    glUniform2i(0, x / texels, y / texels);
    glUniform1i(1, size / texels);
    glUniform1i(2, static_cast<GLint>(level));
    const auto groups = (static_cast<std::uint32_t>(size / texels) + kBlockerGroup - 1) / kBlockerGroup;
    glDispatchCompute(groups, groups, 1);
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
  }
}

Result<gpu::Program> pyramidProgram() {
  return gpu::Program::create("key blockers", {{GL_COMPUTE_SHADER, "key_blockers.comp"}}, kShaders);
}

struct Case {
  KeyRecord key;
  glm::vec4 position;  // w: a reach in texels, to look up blockerBounds
  glm::vec4 normal;
  glm::vec4 shading_normal;
};
static_assert(sizeof(Case) == 160);

constexpr int kSize = 256;

// The world has a floor at z = 0 with holes, and blocks of 16 texels at several heights over a part of it.
float depthAt(const KeyRecord& key, glm::ivec2 texel) {
  const int block = (texel.x / 16 * 7 + texel.y / 16 * 13) % 11;
  const float height = block < 3 ? 0.2f + 0.4f * static_cast<float>(block) : 0.0f;
  return block == 10 ? 1.0f : (key.towards.w - height) / key.scale.z;
}

std::vector<Case> someCases(const KeyRecord& plain) {
  testing::Random<float> random(5);
  std::vector<Case> cases;
  for (int i = 0; i < 4096; ++i) {
    Case c{};
    // Lights of all sizes, by one map.
    const float radius = i % 4 == 0 ? 0.005f : random.number(0.01f, 0.25f);
    c.key = plain;
    c.key.radiance.w = std::sin(radius);
    c.key.scale.w = std::tan(radius);
    c.key.rays = i % 3 == 0 ? 6 : 32;
    const bool on_floor = i % 8 < 5;
    c.position =
        glm::vec4(random.number(-2, 2), random.number(-2, 2), on_floor ? 0.0f : random.number(-0.5f, 1.5f),
                  std::exp2(random.number(-2.0f, 8.0f)));
    const glm::vec3 normal = on_floor ? glm::vec3(0, 0, 1) : random.direction();
    c.normal = glm::vec4(normal, 0.0f);
    c.shading_normal = glm::vec4(glm::normalize(normal + 0.3f * random.direction()), 0.0f);
    cases.push_back(c);
  }
  return cases;
}

}  // namespace

using KeyShader = testing::GpuTest;

TEST_F(KeyShader, DoesAsItsTextDoesInCpp) {
  const KeyRecord key = madeKey({0, 0, 1}, 0.1f, 2.0f, kSize);
  const MadeMap map(kSize, [&](glm::ivec2 texel) { return depthAt(key, texel); });
  glsl::KeyShader shader{&map};
  const std::vector<Case> cases = someCases(key);
  const Textures textures(kSize, kSize, map.depths);
  const Result<gpu::Program> pyramid = pyramidProgram();
  ASSERT_TRUE(pyramid) << pyramid.error().line();
  makePyramid(*pyramid, textures, 0, 0, kSize);
  const Result<gpu::Program> program =
      gpu::Program::create("key environment map", {{GL_COMPUTE_SHADER, "key_probe.comp"}}, kShaders);
  ASSERT_TRUE(program) << program.error().line();
  gpu::Table input("cases"), output("results");
  input.assign(std::span<const Case>(cases));
  output.reserve(2 * cases.size() * sizeof(glm::vec4));
  program->use();
  glUniform1ui(0, static_cast<GLuint>(cases.size()));
  input.bindStorage(0);
  output.bindStorage(1);
  glDispatchCompute(static_cast<GLuint>(cases.size() / 64), 1, 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  std::vector<glm::vec4> results(2 * cases.size());
  output.buffer().read(0, std::span<glm::vec4>(results));
  std::size_t apart = 0, partly = 0, unsure = 0, bounds_apart = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Case& c = cases[i];
    const glm::vec3 position(c.position), normal(c.normal), shading_normal(c.shading_normal);
    const float share = shader.keyShare(c.key, shading_normal), whole = c.key.radiance.w * c.key.radiance.w;
    const glm::vec2 seen(results[2 * i]), found_bounds(results[2 * i + 1]);
    // Arc functions of GPUs are good to 1e-4.
    EXPECT_NEAR(results[2 * i].z, share, 2e-4f * whole + 1e-3f * share) << "case " << i;
    const glm::vec2 bounds = shader.blockerBounds(c.key, shader.keyReceiver(c.key, position, normal).place,
                                                  glm::vec2(c.position.w));
    // Both counts are of what is not within a bound, so that NaN counts.
    if (!(glm::distance(bounds, found_bounds) <= 1e-5f)) ++bounds_apart;
    const glm::vec2 visible = shader.keyVisible(c.key, position, normal, shading_normal);
    if (visible.x > 0.02f && visible.x < 0.98f) ++partly;
    if (visible.y > 0.02f) ++unsure;
    // A ray on the border of two texels may fall to either side by rounding: one or two of all, rarely.
    if (!(glm::distance(seen, visible) <= 0.01f)) ++apart;
    EXPECT_TRUE(seen.x >= 0.0f && seen.y >= 0.0f && seen.x + seen.y <= 1.00001f) << seen.x << ' ' << seen.y;
  }
  EXPECT_LT(apart, cases.size() / 100);
  EXPECT_LT(bounds_apart, cases.size() / 200) << "only where a level or a texel is chosen by rounding";
  EXPECT_GT(partly, cases.size() / 20) << "the world must have penumbras to tell anything";
  EXPECT_GT(unsure, cases.size() / 100) << "and roofs";
}

TEST_F(KeyShader, PyramidsHaveTheLeastAndGreatestDepthsOfTheirTile) {
  // Tiles of two sizes in one texture, and one that was left alone.
  constexpr int kWidth = 256, kHeight = 128;
  testing::Random<float> random(9);
  std::vector<float> texels;
  for (int i = 0; i < kWidth * kHeight; ++i) texels.push_back(random.number(0, 1));
  const Textures textures(kWidth, kHeight, texels);
  constexpr float kAlone[] = {-7.0f, -7.0f};
  for (std::uint32_t level = 0; level < textures.blockers.desc().levels; ++level)
    glClearTexImage(textures.blockers.id(), static_cast<GLint>(level), GL_RG, GL_FLOAT, kAlone);
  const Result<gpu::Program> program = pyramidProgram();
  ASSERT_TRUE(program) << program.error().line();
  struct Tile {
    int x, y, size;
  };
  const std::vector<Tile> tiles = {{0, 0, 128}, {128, 0, 64}, {128, 64, 64}};
  for (const Tile& tile : tiles) makePyramid(*program, textures, tile.x, tile.y, tile.size);
  for (std::uint32_t level = 0; level < textures.blockers.desc().levels; ++level) {
    const int edge = static_cast<int>(kBlockerTexels) << level, width = std::max(kWidth / edge, 1),
              height = std::max(kHeight / edge, 1);
    std::vector<glm::vec2> found(static_cast<std::size_t>(width * height));
    glGetTextureImage(textures.blockers.id(), static_cast<GLint>(level), GL_RG, GL_FLOAT,
                      static_cast<GLsizei>(found.size() * sizeof(glm::vec2)), found.data());
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const bool made = std::ranges::any_of(tiles, [&](const Tile& tile) {
          return edge <= tile.size && x * edge >= tile.x && x * edge < tile.x + tile.size &&
                 y * edge >= tile.y && y * edge < tile.y + tile.size;
        });
        glm::vec2 expected(-7.0f);
        if (made) {
          expected = {1.0f, 0.0f};
          for (int j = y * edge; j < (y + 1) * edge; ++j)
            for (int i = x * edge; i < (x + 1) * edge; ++i) {
              const float depth = texels[static_cast<std::size_t>(j * kWidth + i)];
              expected = {std::min(expected.x, depth), std::max(expected.y, depth)};
            }
        }
        ASSERT_EQ(found[static_cast<std::size_t>(y * width + x)], expected) << level << ": " << x << " " << y;
      }
  }
}

}  // namespace lambent::frame
