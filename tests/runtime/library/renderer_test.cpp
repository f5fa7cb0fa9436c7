// Tests the renderer of the library in a context of the test's own: its pictures against those of a frame,
// and what it does to the context.
#include "lambent/renderer.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <filesystem>
#include <optional>
#include <vector>

#include <epoxy/gl.h>
#include <fmt/format.h>
#include <glm/gtc/type_ptr.hpp>
#include <unistd.h>

#include "lambent/bundle.hpp"
#include "runtime/frame/frame.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/frame/bundle_builder.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent {
namespace {

namespace fs = std::filesystem;
constexpr int kSide = 64;
const std::vector<std::string> kLight = {"sun:30,40,25,3,2,1", "constant:0.2,0.3,0.5"};

Matrix4 matrixOf(const glm::mat4& m) {
  Matrix4 result;
  std::copy_n(glm::value_ptr(m), 16, result.begin());
  return result;
}

// Holds what a program would draw into.
struct Textures {
  GLuint color = 0, depth = 0, framebuffer = 0;

  explicit Textures(GLenum color_format = GL_RGBA32F, GLenum depth_format = GL_DEPTH_COMPONENT32F) {
    glCreateTextures(GL_TEXTURE_2D, 1, &color);
    glTextureStorage2D(color, 1, color_format, kSide, kSide);
    glCreateTextures(GL_TEXTURE_2D, 1, &depth);
    glTextureStorage2D(depth, 1, depth_format, kSide, kSide);
    glCreateFramebuffers(1, &framebuffer);
    glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, color, 0);
    glNamedFramebufferTexture(framebuffer, GL_DEPTH_ATTACHMENT, depth, 0);
  }
  ~Textures() {
    glDeleteFramebuffers(1, &framebuffer);
    glDeleteTextures(1, &color);
    glDeleteTextures(1, &depth);
  }
  void clear(std::array<float, 4> to, float to_depth) {
    glClearNamedFramebufferfv(framebuffer, GL_COLOR, 0, to.data());
    glClearNamedFramebufferfv(framebuffer, GL_DEPTH, 0, &to_depth);
  }
  std::vector<float> read() const {
    std::vector<float> texels(4 * kSide * kSide);
    glGetTextureImage(color, 0, GL_RGBA, GL_FLOAT, static_cast<GLsizei>(4 * texels.size()), texels.data());
    return texels;
  }
  Target target() const { return {.color = color, .depth = depth}; }
};

// Holds the picture that a frame draws without the library; without a frame if something failed.
struct DrawnByFrame {
  frame::World world;
  lighting::Environment environment;
  std::optional<frame::Frame> frame;

  DrawnByFrame(const fs::path& bundle, const spec::View& view, std::uint32_t most_keys)
      : environment(*lighting::Environment::create(lights())) {
    environment.setMostKeys(most_keys);
    gpu::Counters counters;
    EXPECT_TRUE(world.open(bundle));
    EXPECT_TRUE(world.uploadAll(counters));
    auto made = frame::Frame::create({.size = {kSide, kSide}, .output = frame::Output::Linear}, environment);
    EXPECT_TRUE(made && made->render(world, environment, view));
    if (made) frame.emplace(std::move(*made));
  }
  static std::vector<spec::Light> lights() { return *spec::parseLights(kLight); }
};

TEST(LibraryRendererWithoutContext, SaysSo) {
  const Expected<Renderer> renderer = Renderer::create();
  ASSERT_FALSE(renderer);
  EXPECT_NE(renderer.failure().line().find("no context is current"), std::string::npos)
      << renderer.failure().line();
  EXPECT_FALSE(Scene::create());
}

class LibraryRenderer : public testing::GpuTest {
 protected:
  void SetUp() override {
    GpuTest::SetUp();
    if (!context) return;
    path = fs::path(::testing::TempDir()) /
           fmt::format("{}-{}.lmb.glb", getpid(),
                       ::testing::UnitTest::GetInstance()->current_test_info()->name());
    testing::BundleBuilder builder(5);
    builder.add(
        {.data = testing::sphereMesh(24, 48), .material = testing::colored({0.8f, 0.5f, 0.3f, 1.0f})});
    builder.write(path);
    view = spec::orbitView({.azimuth_deg = 20.0f, .elevation_deg = 10.0f}, glm::vec3(-1.0f), glm::vec3(1.0f),
                           1.0f);
    camera = {.view_from_world = matrixOf(view.view_from_world),
              .clip_from_view = matrixOf(view.clip_from_view)};
  }
  void TearDown() override {
    fs::remove(path);
    GpuTest::TearDown();
  }
  Scene sceneWithBundle() const {
    Expected<Scene> scene = Scene::create();
    EXPECT_TRUE(scene) << scene.failure().line();
    const Expected<BundleId> opened = scene->open(path.string());
    EXPECT_TRUE(opened) << opened.failure().line();
    const Expected<void> lit = scene->setEnvironment(kLight), loaded = scene->finishLoading();
    EXPECT_TRUE(lit && loaded);
    return std::move(*scene);
  }
  static Renderer made() {
    Expected<Renderer> renderer = Renderer::create();
    EXPECT_TRUE(renderer) << renderer.failure().line();
    return std::move(*renderer);
  }

  fs::path path;
  spec::View view;
  Camera camera;
};

TEST_F(LibraryRenderer, DrawsWhatAFrameDraws) {
  DrawnByFrame drawn_by_frame(path, view, frame::FrameSettings{}.mostKeys());
  ASSERT_TRUE(drawn_by_frame.frame);
  std::vector<float> expected(4 * kSide * kSide);
  glGetTextureImage(drawn_by_frame.frame->picture().id(), 0, GL_RGBA, GL_FLOAT,
                    static_cast<GLsizei>(4 * expected.size()), expected.data());

  Scene scene = sceneWithBundle();
  Renderer renderer = made();
  Textures textures;
  textures.clear({0, 0, 0, 0}, 1.0f);
  const Expected<void> drawn = renderer.draw(scene, camera, textures.target());
  ASSERT_TRUE(drawn) << drawn.failure().line();
  EXPECT_LT(testing::largestDifference(textures.read(), expected), 1e-5);
  EXPECT_GT(*std::ranges::max_element(expected), 0.3f);
}

TEST_F(LibraryRenderer, IsHiddenByWhatTheProgramDrewInFront) {
  Scene scene = sceneWithBundle();
  Renderer renderer = made();
  Textures textures;
  constexpr float kNear = 0.0f;
  textures.clear({7, 8, 9, 1}, kNear);
  ASSERT_TRUE(renderer.draw(scene, camera, textures.target()));
  const std::vector<float> texels = textures.read();
  for (std::size_t i = 0; i < texels.size(); i += 4) ASSERT_EQ(texels[i], 7.0f) << i;
}

TEST_F(LibraryRenderer, WithoutSkyDrawsSurfacesAlone) {
  Scene scene = sceneWithBundle();
  Renderer renderer = made();
  renderer.showSky(false);
  Textures textures;
  textures.clear({7, 8, 9, 0}, 1.0f);
  ASSERT_TRUE(renderer.draw(scene, camera, textures.target()));
  const std::vector<float> texels = textures.read();
  const std::size_t middle = 4 * (kSide / 2 * kSide + kSide / 2);
  EXPECT_EQ(texels[0], 7.0f);
  EXPECT_LT(texels[middle], 3.0f);
  EXPECT_EQ(texels[middle + 3], 1.0f);
}

TEST_F(LibraryRenderer, LeavesTheStateOfTheProgramAsItWas) {
  Scene scene = sceneWithBundle();
  Renderer renderer = made();
  Textures textures;
  textures.clear({0, 0, 0, 0}, 1.0f);
  ASSERT_TRUE(renderer.draw(scene, camera, textures.target()));
  const std::vector<float> expected = textures.read();

  GLuint own_array = 0, own_buffer = 0;
  glCreateVertexArrays(1, &own_array);
  glCreateBuffers(1, &own_buffer);
  glBindVertexArray(own_array);
  glBindFramebuffer(GL_FRAMEBUFFER, textures.framebuffer);
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, own_buffer);
  glViewport(3, 4, 5, 6);
  glEnable(GL_SCISSOR_TEST);
  glScissor(0, 0, 2, 2);
  glEnable(GL_CULL_FACE);
  glCullFace(GL_FRONT);
  glFrontFace(GL_CW);
  glEnable(GL_BLEND);
  glBlendFuncSeparate(GL_DST_COLOR, GL_ONE, GL_ZERO, GL_SRC_ALPHA);
  glBlendEquation(GL_FUNC_SUBTRACT);
  glDepthFunc(GL_GEQUAL);
  glDepthMask(GL_FALSE);
  glDepthRange(0.25, 0.5);
  glColorMask(GL_TRUE, GL_FALSE, GL_TRUE, GL_FALSE);
  glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
  glClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE);
  glPixelStorei(GL_UNPACK_ROW_LENGTH, 17);
  glActiveTexture(GL_TEXTURE5);
  const auto state = [] {
    std::vector<GLint> values;
    constexpr GLenum kNumbers[] = {GL_VERTEX_ARRAY_BINDING,
                                   GL_DRAW_FRAMEBUFFER_BINDING,
                                   GL_PIXEL_UNPACK_BUFFER_BINDING,
                                   GL_SCISSOR_TEST,
                                   GL_CULL_FACE,
                                   GL_CULL_FACE_MODE,
                                   GL_FRONT_FACE,
                                   GL_BLEND,
                                   GL_BLEND_SRC_RGB,
                                   GL_BLEND_DST_ALPHA,
                                   GL_BLEND_EQUATION_RGB,
                                   GL_DEPTH_FUNC,
                                   GL_DEPTH_WRITEMASK,
                                   GL_CLIP_ORIGIN,
                                   GL_CLIP_DEPTH_MODE,
                                   GL_UNPACK_ROW_LENGTH,
                                   GL_ACTIVE_TEXTURE,
                                   GL_CURRENT_PROGRAM,
                                   GL_DEPTH_TEST,
                                   GL_TEXTURE_CUBE_MAP_SEAMLESS};
    for (const GLenum name : kNumbers) glGetIntegerv(name, &values.emplace_back());
    std::array<GLint, 4> four{};
    constexpr GLenum kFours[] = {GL_VIEWPORT, GL_SCISSOR_BOX, GL_COLOR_WRITEMASK};
    for (const GLenum name : kFours) {
      glGetIntegerv(name, four.data());
      values.insert(values.end(), four.begin(), four.end());
    }
    GLint polygon_mode[2] = {};
    glGetIntegerv(GL_POLYGON_MODE, polygon_mode);
    values.push_back(polygon_mode[0]);
    return values;
  };
  const std::vector<GLint> before = state();
  scene.turnEnvironment(0.0f);
  // The picture is drawn as before, whatever the state would spoil.
  glDisable(GL_SCISSOR_TEST);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthMask(GL_TRUE);
  textures.clear({0, 0, 0, 0}, 1.0f);
  glEnable(GL_SCISSOR_TEST);
  glColorMask(GL_TRUE, GL_FALSE, GL_TRUE, GL_FALSE);
  glDepthMask(GL_FALSE);
  ASSERT_TRUE(renderer.draw(scene, camera, textures.target()));
  EXPECT_EQ(state(), before);
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
  EXPECT_LT(testing::largestDifference(textures.read(), expected), 1e-6);
  glDeleteVertexArrays(1, &own_array);
  glDeleteBuffers(1, &own_buffer);
}

TEST_F(LibraryRenderer, RefusesTargetsThatItCannotDrawInto) {
  Scene scene = sceneWithBundle();
  Renderer renderer = made();
  const Textures bytes(GL_RGBA8), whole;
  const auto problem = [&](const Target& target) {
    return renderer.draw(scene, camera, target).failure().line();
  };
  EXPECT_NE(problem(bytes.target()).find("make it GL_RGBA16F"), std::string::npos);
  EXPECT_NE(problem({whole.color, whole.color}).find("has no depth"), std::string::npos);
  EXPECT_NE(problem({0, whole.depth}).find("is no texture"), std::string::npos);
  EXPECT_EQ(renderer.draw(scene, {.clip_from_view = Matrix4{}}, whole.target()).failure().subject, "camera");
  EXPECT_FALSE(renderer.set("smell", "5"));
  EXPECT_FALSE(renderer.set("order", "99"));
  EXPECT_TRUE(renderer.set("order", "3"));
}

TEST_F(LibraryRenderer, MovesBodiesAndLights) {
  Scene scene = sceneWithBundle();
  ASSERT_EQ(scene.bodies().size(), 1u);
  const BodyId body = scene.bodies()[0].id;
  Matrix4 place = kIdentity;
  place[12] = 5.0f;
  ASSERT_TRUE(scene.place(body, place));
  EXPECT_NEAR(scene.bounds().min.x, 4.0f, 1e-3f);
  EXPECT_NEAR(scene.bodies()[0].world_from_body[12], 5.0f, 1e-5f);
  place[3] = 1.0f;
  EXPECT_FALSE(scene.place(body, place));
  EXPECT_FALSE(scene.place({~std::uint64_t{0}}, kIdentity));
  ASSERT_TRUE(scene.place(body, kIdentity));

  Renderer renderer = made();
  Textures textures;
  const auto middle = [&] {
    textures.clear({0, 0, 0, 0}, 1.0f);
    EXPECT_TRUE(renderer.draw(scene, camera, textures.target()));
    return textures.read()[4 * (kSide / 2 * kSide + kSide / 2)];
  };
  const float dim = middle();
  const Expected<LightId> lamp =
      scene.addLight({.position = {2.0f, 1.0f, 5.0f}, .strength = 300.0f, .radius = 0.3f});
  ASSERT_TRUE(lamp) << lamp.failure().line();
  EXPECT_GT(middle(), 1.2f * dim);
  scene.removeLight(*lamp);
  EXPECT_NEAR(middle(), dim, 1e-4f * dim);
  EXPECT_FALSE(scene.setLight(*lamp, {}));
  EXPECT_FALSE(scene.addLight({.strength = -1.0f}));
  EXPECT_FALSE(scene.addLight({.direction = {0, 0, 0}}));
}

// The numbers that the library gives are those that the GPU computes with.
TEST_F(LibraryRenderer, ShadesVerticesAsBundleShadeDoes) {
  Scene scene = sceneWithBundle();
  const Expected<Bundle> bundle = Bundle::open(path.string());
  ASSERT_TRUE(bundle) << bundle.failure().line();
  ASSERT_EQ(bundle->surfaces().size(), 1u);
  const Expected<LightVector> light = lightFrom(kLight, 5);
  ASSERT_TRUE(light);
  const Expected<std::vector<Vec3>> shaded = bundle->shade(0, *light);
  ASSERT_TRUE(shaded) << shaded.failure().line();
  const Expected<SurfaceData> surface = bundle->surface(0);
  ASSERT_TRUE(surface);
  ASSERT_EQ(shaded->size(), surface->positions.size());

  DrawnByFrame drawn(path, view, /*most_keys=*/0);
  ASSERT_TRUE(drawn.frame);
  const streaming::ResidentDraw& draw = drawn.world.residency().draws()[0];
  std::vector<std::uint32_t> words(draw.radiance.byte_count / 4);
  drawn.world.residency().radiance().page(draw.radiance.page).read(draw.radiance.offset, std::span(words));
  double largest = 0.0;
  const std::size_t stride = words.size() / shaded->size();
  for (std::size_t v = 0; v < shaded->size(); ++v)
    for (std::size_t k = 0; k < 3; ++k)
      largest = testing::larger(largest, std::abs(double{std::bit_cast<float>(words[stride * v + k])} -
                                                  double{(&(*shaded)[v].x)[k]}));
  EXPECT_LT(largest, 1e-3);
}

}  // namespace
}  // namespace lambent
