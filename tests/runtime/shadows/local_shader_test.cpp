// Compares shadowed_light.glsl and local_shadow.glsl with themselves as C++, on random lights, places and
// normals in the world of blocks and a floor that local_probe.comp has.

#include <gtest/gtest.h>

#include "lambent_shadows_embedded.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/shadows/local_shared.h"
#include "test_local_shadows_embedded.hpp"
#include "tests/runtime/shadows/random.hpp"
#include "tests/support/glsl/glsl.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::frame::glsl {
namespace {

using namespace lambent::glsl;
struct Probe : Invocation {
  uvec3 gl_GlobalInvocationID{0};
#include "as_cpp/local_probe.comp"
};

}  // namespace
}  // namespace lambent::frame::glsl

namespace lambent::frame {
namespace {

constexpr gpu::FindText kShaders[] = {&embedded::test_local_shadows::find, &embedded::lambent_shadows::find};

using Case = glsl::Probe::Case;
static_assert(sizeof(Case) == 128, "as in the shader's buffer");

std::vector<Case> someCases() {
  testing::Random<float> random(5);
  const auto number = [&](float low, float high) { return random.number(low, high); };
  const auto direction = [&] { return random.direction(); };
  std::vector<Case> cases;
  for (uint i = 0; i < 4096; ++i) {
    Case c{};
    c.light = {.position = {number(-1, 1), number(-1, 1), number(-1, 1)},
               .reach = 1.0f,
               .direction = direction(),
               .kind = std::array{kLocalPoint, kLocalSpot, kLocalSphere, kLocalDisc}[i % 4],
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

TEST_F(LocalShader, DoesAsItsTextDoesInCpp) {
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
  glsl::Probe probe;
  std::vector<glm::vec4> expected(cases.size());
  probe.cases = cases;
  probe.results = expected;
  probe.count = static_cast<uint>(cases.size());
  for (uint& i = probe.gl_GlobalInvocationID.x; i < probe.count; ++i) probe.main();
  std::size_t apart = 0, partly = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const uint kind = cases[i].light.kind;
    const float share = expected[i].z, radiance = expected[i].y, whole = share * cases[i].light.power.y;
    // Arc functions of GPUs are good to 1e-4.
    EXPECT_NEAR(results[i].z, share, 1e-3f * share + 2e-4f) << "case " << i << " kind " << kind;
    if (radiance > 0.02f * whole && radiance < 0.98f * whole) ++partly;
    // A tap on the border of two texels may fall to either side by rounding: one or two taps of sixteen,
    // rarely.
    if (!(std::abs(results[i].y - radiance) <= 0.01f * whole + 0.02f)) ++apart;  // so that NaN counts
    EXPECT_NEAR(results[i].y, radiance, 2.5f / 16.0f * whole + 0.02f) << "case " << i << " kind " << kind;
  }
  EXPECT_LT(apart, cases.size() / 100);
  EXPECT_GT(partly, cases.size() / 20) << "the world must have penumbras to tell anything";
}

}  // namespace lambent::frame
