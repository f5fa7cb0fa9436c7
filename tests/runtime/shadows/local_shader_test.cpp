// Compares shadowed_light.glsl and local_shadow.glsl with their CPU twins, on random lights, places and
// normals in a world of blocks and a floor.
#include <random>

#include <gtest/gtest.h>

#include "lambent_shadows_embedded.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/shadows/local_shadow_ref.hpp"
#include "test_local_shadows_embedded.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::frame {
namespace {

constexpr gpu::FindText kShaders[] = {&embedded::test_local_shadows::find, &embedded::lambent_shadows::find};
constexpr int kMapSize = 64;

struct Case {
  ShadowedLightRecord light;
  glm::vec3 position;
  float turns;
  glm::vec3 normal;
  float pad0;
  glm::vec3 horizon;
  float pad2;
  glm::vec3 shading_normal;
  float pad1;
};
static_assert(sizeof(Case) == 128);

// This is the same world as in local_probe.comp.
float distanceAt(int face, glm::ivec2 texel) {
  if (((texel.x / 8 + texel.y / 8 + face) & 1) == 0 && face != 3)
    return 0.5f + 0.01f * static_cast<float>(face);
  const glm::vec3 direction = ref::texelDirection(face, glm::vec2(texel) + 0.5f, kMapSize);
  return direction.y < 0.0f ? -1.0f / direction.y : ref::kNothing;
}

std::vector<Case> someCases() {
  std::mt19937 engine(5);
  const auto number = [&](float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(engine);
  };
  const auto direction = [&] {
    for (;;) {
      const glm::vec3 v(number(-1, 1), number(-1, 1), number(-1, 1));
      if (const float squared = glm::dot(v, v); squared > 0.01f && squared < 1.0f) return glm::normalize(v);
    }
  };
  std::vector<Case> cases;
  for (uint i = 0; i < 4096; ++i) {
    Case c{};
    c.light = {.position = {number(-1, 1), number(-1, 1), number(-1, 1)},
               .reach = 1.0f,
               .direction = direction(),
               .kind = i % 4,
               .power = {number(0, 2), number(0, 100), 1.0f},
               .radius = number(0.01f, 0.5f),
               .cos_outer = number(0.2f, 0.8f),
               .cone_scale = number(1.0f, 10.0f),
               .range = i % 3 == 0 ? number(1.0f, 4.0f) : 0.0f,
               .pad = 0.0f};
    c.turns = number(0, 1);
    // Half of the places are on the floor below the light.
    const bool on_floor = i % 8 < 4;
    c.normal = on_floor ? glm::vec3(0, 1, 0) : direction();
    c.position = c.light.position + (on_floor ? glm::vec3(number(-2, 2), -1.0f, number(-2, 2))
                                              : number(0.01f, 3.0f) * direction());
    c.horizon = glm::normalize(c.normal + 0.1f * direction());
    c.shading_normal = glm::normalize(c.normal + 0.3f * direction());
    cases.push_back(c);
  }
  return cases;
}

}  // namespace

using LocalShader = testing::GpuTest;

TEST_F(LocalShader, DoesWhatItsTwinDoes) {
  const std::vector<Case> cases = someCases();
  const Result<gpu::Program> program =
      gpu::Program::create("local probe", {{GL_COMPUTE_SHADER, "local_probe.comp"}}, kShaders);
  ASSERT_TRUE(program) << program.error().line();
  gpu::Table input("cases"), output("results");
  input.assign(std::span<const Case>(cases));
  output.reserve(cases.size() * sizeof(glm::vec4));
  program->use();
  glUniform1ui(0, static_cast<GLuint>(cases.size()));
  input.bindStorage(0);
  output.bindStorage(1);
  glDispatchCompute(static_cast<GLuint>(cases.size() / 64), 1, 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  std::vector<glm::vec4> results(cases.size());
  output.buffer().read(0, std::span<glm::vec4>(results));
  std::size_t apart = 0, partly = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Case& c = cases[i];
    const float share = ref::localShare(c.light, c.shading_normal, c.light.position - c.position);
    // Arc functions of GPUs are good to 1e-4.
    EXPECT_NEAR(results[i].z, share, 1e-3f * share + 2e-4f) << "case " << i << " kind " << c.light.kind;
    const glm::vec3 radiance = ref::localRadiance(
        distanceAt, c.light, {c.position, c.normal, c.horizon, c.shading_normal}, {kMapSize, 16, c.turns});
    const float whole = share * c.light.power.y;
    if (radiance.y > 0.02f * whole && radiance.y < 0.98f * whole) ++partly;
    // A tap on the border of two texels may fall to either side by rounding: one or two taps of sixteen,
    // rarely.
    if (!(std::abs(results[i].y - radiance.y) <= 0.01f * whole + 0.02f)) ++apart;  // so that NaN counts
    EXPECT_NEAR(results[i].y, radiance.y, 2.5f / 16.0f * whole + 0.02f)
        << "case " << i << " kind " << c.light.kind;
  }
  EXPECT_LT(apart, cases.size() / 100);
  EXPECT_GT(partly, cases.size() / 20) << "the world must have penumbras to tell anything";
}

}  // namespace lambent::frame
