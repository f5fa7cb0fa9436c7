// Bakes the glTF files of the shared scenes at draft quality as a user does, and shows them. Each gives a
// bundle and a picture of finite values, or one line that says why not. The variants of one Khronos model
// (embedded, Draco, quantized, ...) must give the same picture.
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "baker/accuracy/compare.hpp"
#include "runtime/frame/frame.hpp"
#include "runtime/gpu/context.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/spec/image.hpp"
#include "runtime/spec/light.hpp"
#include "tests/support/program.hpp"
#include "tests/support/require.hpp"
#include "tests/support/shared_data.hpp"

namespace lambent {
namespace {

using testing::Outcome;

// Lists by path why a file may be refused; the error line must say so.
const std::map<std::string, std::string> kRefused = {
    {"asset-generator/Compatibility/Compatibility_04.gltf", "needs glTF 2.1"},
    {"draco-testdata/CubeScaledInstances/glTF/cube_att.gltf", "stands twice in the scene"},
    {"draco-testdata/SphereTwoMaterials/sphere_two_materials_point_cloud.gltf", "has no triangles"},
};

// This is the longest of all tests. These take over a minute to bake: a million triangles, a cloth, and 125
// metal cubes that see each other.
const std::set<std::string> kTooLong = {
    "khronos/MetalRoughSpheresNoTextures/glTF-Binary/MetalRoughSpheresNoTextures.glb",
    "khronos/SheenCloth/glTF/SheenCloth.gltf", "khronos/SimpleInstancing/glTF-Binary/SimpleInstancing.glb"};

bool isPointsOrLines(const std::string& name) {
  for (const char* mode : {"_00", "_01", "_02", "_03", "_07", "_08", "_09", "_10"})
    if (name == std::string("asset-generator/Mesh_PrimitiveMode/Mesh_PrimitiveMode") + mode + ".gltf")
      return true;
  return false;
}

// Returns the model of a Khronos file: khronos/MODEL/VARIANT/FILE.
std::string modelOf(const std::filesystem::path& name) {
  auto part = name.begin();
  if (*part != "khronos") return {};
  return (++part)->string();
}

std::size_t coveredPixels(const spec::RgbaImage& image) {
  return static_cast<std::size_t>(
      std::count_if(image.texels.begin(), image.texels.end(), [](const glm::vec4& t) { return t.a > 0.0f; }));
}

// Shows bundles one after another in one world, as an editor does: a program each would spend more time on
// shaders than on pictures.
class SharedScenes : public testing::ProgramTest {
 protected:
  void SetUp() override {
    ProgramTest::SetUp();
    Result<gpu::Context> made = gpu::Context::createHeadless();
    if (!made) LAMBENT_LACKS("gl", "no OpenGL 4.5 here: " << made.error().line());
    context.emplace(std::move(*made));
    const auto lights = {*spec::parseLight("sun:40,50,30,4,3,2"), *spec::parseLight("constant:0.3,0.4,0.5")};
    environment.emplace(*lighting::Environment::create(lights));
    frame.emplace(*frame::Frame::create(
        {.size = {96, 96}, .output = frame::Output::Linear, .wait_for_captures = true}, *environment));
  }

  std::optional<spec::RgbaImage> show(const std::filesystem::path& bundle) {
    const Result<std::uint32_t> opened = world.open(bundle);
    EXPECT_TRUE(opened) << opened.error().line();
    if (!opened) return std::nullopt;
    gpu::Counters counters;
    const Result<void> loaded = world.uploadAll(counters);
    EXPECT_TRUE(loaded) << loaded.error().line();
    world.updateTransforms();
    const scene::Box bounds = scene::worldBounds(world.registry());
    spec::OrbitCamera camera;
    spec::RgbaImage picture;
    for (int side = 0; side < 2 && coveredPixels(picture) == 0; ++side, camera.azimuth_deg += 180.0f) {
      const spec::View view = spec::orbitView(camera, bounds.min, bounds.max, 1.0f);
      for (int turn = 0; turn < 2; ++turn) {  // the second one with all light between bodies
        EXPECT_TRUE(frame->render(world, *environment, view));
        EXPECT_TRUE(frame->rest(world, *environment));
      }
      picture = frame->readLinear();
    }
    world.close(*opened);
    return picture;
  }

  std::optional<gpu::Context> context;  // outlives what is drawn with it
  frame::World world;
  std::optional<lighting::Environment> environment;
  std::optional<frame::Frame> frame;
};

}  // namespace

TEST_F(SharedScenes, BakeAndShowOrAreRefusedInOneRightLine) {
  const std::filesystem::path scenes = testing::sharedFile("scenes");
  LAMBENT_NEEDS_SHARED(scenes);
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(scenes))
    if (entry.path().extension() == ".gltf" || entry.path().extension() == ".glb")
      files.push_back(entry.path().lexically_relative(scenes));
  std::sort(files.begin(), files.end());
  EXPECT_GT(files.size(), 90u);

  struct First {
    std::string file;
    spec::RgbaImage picture;
  };
  std::map<std::string, First> models;
  const std::filesystem::path bundle = folder / "scene.lmb.glb";
  std::size_t shown = 0;
  for (const std::filesystem::path& file : files) {
    const std::string name = file.generic_string();
    if (kTooLong.contains(name)) continue;
    // Few rays, bands and bounces, and no splits, suffice to see that scenes bake. The cache keeps tables of
    // BRDFs, and what variants of a model have in common.
    const Outcome baked =
        run(LAMBENT_PROGRAM, {"bake", (scenes / file).string(), "-o", bundle.string(), "--quality", "draft",
                              "--rays", "128", "--bounces", "1", "--order", "3", "--glossy-order", "4",
                              "--refine", "off", "--cache", (folder / "cache").string()});
    const auto refused = kRefused.find(name);
    if (refused != kRefused.end() || isPointsOrLines(name)) {
      const std::string why = refused != kRefused.end() ? refused->second : "has no triangles";
      EXPECT_EQ(baked.exit_code, 1) << name;
      EXPECT_NE(baked.err.find(why), std::string::npos) << name << "\n" << baked.err;
      continue;
    }
    EXPECT_EQ(baked.exit_code, 0) << name << "\n" << baked.err;
    if (baked.exit_code != 0) continue;
    const auto picture = show(bundle);
    if (!picture) continue;
    ++shown;
    EXPECT_GT(coveredPixels(*picture), 0u) << name;
    EXPECT_TRUE(std::all_of(picture->texels.begin(), picture->texels.end(), [](const glm::vec4& t) {
      return std::isfinite(t.r) && std::isfinite(t.g) && std::isfinite(t.b);
    })) << name;

    const std::string model = modelOf(file);
    if (model.empty()) continue;
    const auto [first, is_new] = models.try_emplace(model, First{name, *picture});
    if (is_new) continue;
    const auto error = baker::comparePictures(*picture, first->second.picture, nullptr, name);
    ASSERT_TRUE(error) << name << " beside " << first->second.file << ": " << error.error().line();
    // Quantized and Draco meshes have samples a little elsewhere, and 128 rays leave 2 % at each.
    EXPECT_LT(error->relative_rms, 0.04) << name << " beside " << first->second.file;
  }
  EXPECT_GT(shown, 80u);
}

}  // namespace lambent
