// Runs long: bundles, lights and settings come and go, and nothing of them may stay. LAMBENT_LONG_RUN=100000
// sets the number of frames; docs/robustness.md has what that gave.
#include <cstdlib>
#include <map>
#include <string>

#include <epoxy/gl.h>

#include "runtime/base/process.hpp"
#include "runtime/scene/components.hpp"
#include "tests/support/frame/world_stage.hpp"

namespace lambent::frame {
namespace {

using testing::WorldStage;
using WorldTest = testing::WorldTest;

// Counts the objects of one kind. `create` makes one, of which the name is above all others: some drivers
// give no name twice.
template <class Create, class Is, class Delete>
int objects(Create create, Is is, Delete destroy) {
  GLuint last = 0;
  create(&last);
  destroy(&last);
  int count = 0;
  for (GLuint name = 1; name < last; ++name) count += is(name) == GL_TRUE;
  return count;
}

std::map<std::string, int> objectsOfTheDriver() {
  return {
      {"buffers", objects([](GLuint* name) { glCreateBuffers(1, name); }, glIsBuffer,
                          [](GLuint* name) { glDeleteBuffers(1, name); })},
      {"textures", objects([](GLuint* name) { glCreateTextures(GL_TEXTURE_2D, 1, name); }, glIsTexture,
                           [](GLuint* name) { glDeleteTextures(1, name); })},
      {"framebuffers", objects([](GLuint* name) { glCreateFramebuffers(1, name); }, glIsFramebuffer,
                               [](GLuint* name) { glDeleteFramebuffers(1, name); })},
      {"vertex arrays", objects([](GLuint* name) { glCreateVertexArrays(1, name); }, glIsVertexArray,
                                [](GLuint* name) { glDeleteVertexArrays(1, name); })},
      {"queries", objects([](GLuint* name) { glCreateQueries(GL_TIMESTAMP, 1, name); }, glIsQuery,
                          [](GLuint* name) { glDeleteQueries(1, name); })},
      {"programs", objects([](GLuint* name) { *name = glCreateProgram(); }, glIsProgram,
                           [](GLuint* name) { glDeleteProgram(*name); })},
  };
}

}  // namespace

TEST_F(WorldTest, InALongRunNeitherMemoryNorObjectsOfTheDriverGrow) {
  constexpr int kFramesOfARound = 25;
  const char* asked = std::getenv("LAMBENT_LONG_RUN");
  const int rounds = std::max(9, asked ? std::atoi(asked) / kFramesOfARound : 0);
  WorldStage stage(lights);
  stage.open(floorFile());
  stage.picture();

  const auto round = [&](int number) {
    const std::uint32_t ball = stage.open(ballFile(0.0f)), mist = stage.open(mistFile());
    const std::uint32_t quad = stage.open(quadFile({1.0f, 0.2f, 0.1f, 1.0f}));
    ecs::Registry& registry = stage.world.registry();
    const ecs::Entity lamp = registry.create();
    registry.emplace<scene::Transform>(lamp).translation.y = 2.0f;
    registry.emplace<scene::LocalLightComponent>(
        lamp, scene::LocalLightComponent{
                  .kind = scene::LocalLightComponent::Kind::Sphere, .strength = 5.0f, .radius_m = 0.2f});
    for (int frame = 0; frame < kFramesOfARound; ++frame) {
      registry.edit<scene::Transform>(lamp).translation.x = 0.1f * static_cast<float>(frame - 12);
      stage.environment.setTurn(static_cast<float>(7 * (number + frame)));
      if (frame == 8) {
        ASSERT_TRUE(stage.world.replace(ball, ballFile(0.4f)));
      }
      if (frame == 12) {
        const std::vector<spec::Light> others = {spec::ConstantLight{.radiance = glm::vec3(0.3f)}};
        ASSERT_TRUE(stage.environment.setLights(number % 2 == 0 ? others : lights));
      }
      if (frame == 16) stage.world.close(mist);
      stage.render();
    }
    stage.world.close(quad);
    stage.world.close(ball);
    registry.destroy(lamp);
    stage.render();
  };

  int number = 0;
  for (; number < 6; ++number) round(number);
  const auto before = objectsOfTheDriver();
  const std::uint64_t bytes = residentBytes();
  const std::size_t entities = stage.world.registry().entities().size();
  for (; number < rounds && !HasFailure(); ++number) round(number);
  EXPECT_EQ(objectsOfTheDriver(), before);
  EXPECT_EQ(stage.world.registry().entities().size(), entities);
  // The C library and the driver keep some of what was freed, whatever the number of rounds.
  constexpr std::uint64_t kSlack = std::uint64_t{16} << 20;
  EXPECT_LT(residentBytes(), bytes + kSlack);
  RecordProperty("frames", number * kFramesOfARound);
  RecordProperty("bytes before", std::to_string(bytes));
  RecordProperty("bytes after", std::to_string(residentBytes()));
}

}  // namespace lambent::frame
