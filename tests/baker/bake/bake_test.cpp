// Tests the whole bake: it writes the same bytes for any number of threads, loses nothing when it fails, and
// what is read back is what was meant.
#include "baker/bake/bake.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>

#include <gtest/gtest.h>

#include "baker/import/gltf.hpp"
#include "baker/import/scene_digest.hpp"
#include "runtime/bundle/container.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lambent::baker {
namespace {

namespace fs = std::filesystem;
using testing::box;
using testing::grid;
using testing::icosphere;
using testing::sceneOf;

class Bake : public ::testing::Test {
 protected:
  Result<BakeReport> bakeTo(const std::string& name, const Scene& scene, const BakeOptions& options) const {
    Progress progress;
    return bake(scene, options, folder_ / name, {progress});
  }
  std::string bytes(const std::string& name) const {
    std::ifstream in(folder_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  std::ptrdiff_t files() const {
    return std::distance(fs::directory_iterator(folder_), fs::directory_iterator());
  }

  const testing::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
};

// Makes a static floor and box, and a movable ball: two groups.
Scene twoGroups() {
  Scene scene = sceneOf(
      {grid({0, 0, 0}, 4.0f, 24), box({-0.8f, 0.5f, 0}, {1, 1, 1}, 6), icosphere({0, 0, 0}, 0.5f, 3)});
  scene.nodes[2].movable = true;
  scene.nodes[2].name = "ball";
  scene.nodes[2].parent_from_node = glm::translate(glm::mat4(1.0f), {0.8f, 0.6f, 0});
  return scene;
}

BakeOptions unrefinedDraft() {
  BakeOptions options;
  options.quality = Quality::Draft;
  options.refine_bound = 0.0f;  // meshes as they come
  return options;
}

TEST_F(Bake, GivesTheSameBytesWithOneAndTwoThreads) {
  const Scene scene = twoGroups();
  BakeOptions one = unrefinedDraft(), two = unrefinedDraft();
  one.threads = 1;
  two.threads = 2;
  ASSERT_TRUE(bakeTo("one.lmb.glb", scene, one));
  ASSERT_TRUE(bakeTo("two.lmb.glb", scene, two));
  EXPECT_FALSE(bytes("one.lmb.glb").empty());
  EXPECT_TRUE(bytes("one.lmb.glb") == bytes("two.lmb.glb"));
}

TEST_F(Bake, WritesABundleThatIsWhole) {
  const auto report = bakeTo("stage.lmb.glb", twoGroups(), unrefinedDraft());
  ASSERT_TRUE(report) << report.error().line();
  auto reader = bundle::Reader::open(folder_ / "stage.lmb.glb");
  ASSERT_TRUE(reader) << reader.error().line();
  const auto checked = reader->checkAll();
  EXPECT_TRUE(checked) << checked.error().line();
  const bundle::Description& d = reader->description();
  ASSERT_EQ(d.groups.size(), 2u);
  EXPECT_EQ(d.groups[1].name, "ball");
  EXPECT_EQ(d.groups[1].rest_translation, glm::vec3(0.8f, 0.6f, 0));
  EXPECT_EQ(d.draws.size(), 3u);
  EXPECT_EQ(d.generator.settings.at("rays"), "256");
  EXPECT_LE(report->worst_error, 0.01);
  // The parts are in the order in which the loader wants them.
  for (std::size_t p = 1; p < d.payloads.size(); ++p)
    EXPECT_LE(d.payloads[p - 1].priority, d.payloads[p].priority);
  for (std::size_t v = 1; v < d.views.size(); ++v) EXPECT_LT(d.views[v - 1].offset, d.views[v].offset);
}

TEST_F(Bake, StoresTransferThatDecodesToTheScene) {
  ASSERT_TRUE(bakeTo("stage.lmb.glb", twoGroups(), unrefinedDraft()));
  const auto reader = bundle::Reader::open(folder_ / "stage.lmb.glb");
  ASSERT_TRUE(reader);
  const bundle::Description& d = reader->description();
  const bundle::Cell& cell = d.groups[0].cells.at(0);
  const bundle::CellTransfer& transfer = cell.transfers.at(0);
  const auto found = reader->readCodebook({}, {}, {});
  ASSERT_TRUE(found) << found.error().line();
  std::vector<std::vector<std::uint32_t>> codes;
  for (std::uint32_t j = 0; j < transfer.planes.size(); ++j)
    codes.push_back(*reader->readPlane({}, {}, {}, bundle::PlaneIndex{j}));
  const auto vectors = transfer::decodeTransfer(transfer.shape, found->codebook, found->cluster_of, codes);

  const auto mesh = reader->readMesh(d.draws[0].mesh, 0);
  ASSERT_TRUE(mesh) << mesh.error().line();
  const auto rows = reader->readRows(0);
  ASSERT_TRUE(rows) << rows.error().line();
  const float to_uniform = std::sqrt(4.0f * 3.14159265f);
  for (std::size_t v = 0; v < mesh->positions.size(); ++v) {
    const float radiance = to_uniform * vectors[rows->samples[v] * transfer.shape.size()];
    EXPECT_LE(radiance, 1.05f);  // coded to 1 % RMS
    // The floor's far corner is open; beside the box it is not.
    if (glm::distance(mesh->positions[v], glm::vec3(2, 0, 2)) < 0.1f) {
      EXPECT_GT(radiance, 0.95f);
    }
    if (glm::distance(mesh->positions[v], glm::vec3(-0.17f, 0, 0)) < 0.1f) {
      EXPECT_LT(radiance, 0.9f);
    }
  }
}

TEST_F(Bake, StoresLightProbesAndProxiesInTheGroupsFrame) {
  Scene scene = twoGroups();
  scene.nodes[2].parent_from_node = glm::translate(glm::mat4(1.0f), {100, 0.6f, 0});
  const auto open = [&] { return bundle::Reader::open(folder_ / "stage.lmb.glb"); };
  ASSERT_TRUE(bakeTo("stage.lmb.glb", scene, unrefinedDraft()));
  auto reader = open();
  ASSERT_TRUE(reader) << reader.error().line();
  for (const bundle::Group& group : reader->description().groups)
    EXPECT_EQ(group.light_probes, std::vector{0.5f * (group.bounds_min + group.bounds_max)});

  BakeOptions options = unrefinedDraft();
  options.light_probes = 8;
  options.effects = "diffuse";  // no grid, which has cells of its own
  const auto report = bakeTo("stage.lmb.glb", scene, options);
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_FALSE(isUpToDate(scene, unrefinedDraft(), folder_ / "stage.lmb.glb"));
  reader = open();
  ASSERT_TRUE(reader->checkAll());
  for (std::uint32_t g = 0; g < 2; ++g) {
    const bundle::Group& group = reader->description().groups[g];
    EXPECT_EQ(group.light_probes.size(), 8u);
    EXPECT_EQ(report->groups.at(g).light_probes, 8u);
    for (const glm::vec3& point : group.light_probes)
      EXPECT_TRUE(glm::all(glm::lessThanEqual(glm::abs(point), glm::vec3(2.0f))))
          << "not in the world's frame";
    ASSERT_EQ(group.cells.size(), 1u);
    EXPECT_EQ(reader->readLightWeights(bundle::GroupIndex{g}, {})->size(), group.sample_count);
    const auto proxy = reader->readProxy(bundle::GroupIndex{g});
    ASSERT_TRUE(proxy) << proxy.error().line();
    ASSERT_FALSE(proxy->levels.empty());
    EXPECT_LE(proxy->levels[0].triangle_count, bundle::kMaxProxyTriangles);
    for (const glm::vec3& p : proxy->positions)
      EXPECT_TRUE(glm::all(glm::lessThanEqual(p, 1.1f * group.bounds_max + 0.1f)));
  }
}

// Our own importer reads a bundle as any glTF reader does, and finds what was in the scene.
TEST_F(Bake, WritesAnOrdinaryScene) {
  Scene scene = twoGroups();
  scene.lights = {{.name = "lamp", .type = gltf::Light::Type::Spot, .color = {1, 0.5f, 0}, .intensity = 9}};
  scene.nodes[1].light = 0;
  scene.nodes[2].trs = gltf::Trs{.translation = {0.8f, 0.6f, 0}, .scale = {1, -1, 1}};
  scene.nodes[2].parent_from_node = scene.nodes[2].trs->matrix();
  scene.nodes[2].animated = true;
  scene.animations = {{"roll", {{.node = 2, .times_s = {0, 1}, .values = {0, 0, 0, 1, 0, 0}}}}};
  // One flat texel.
  constexpr std::string_view kPng(
      "\211\120\116\107\015\012\032\012\000\000\000\015\111\110\104\122\000\000\000\001\000\000\000\001\010"
      "\002\000\000\000\220\167\123\336\000\000\000\014\111\104\101\124\170\234\143\150\150\370\017\000\003"
      "\203\002\000\000\245\373\211\000\000\000\000\111\105\116\104\256\102\140\202",
      69);
  scene.images = {{"bumps", "image/png", {}}};
  for (const char byte : kPng) scene.images[0].file_bytes.push_back(static_cast<std::byte>(byte));
  scene.textures = {{0, {}}};
  scene.materials[0].emissive = {4, 2, 1};
  scene.materials[0].normal_texture = {.texture = 0, .offset = {0.5f, 0.25f}, .rotation_rad = 1.0f};
  bundle::MeshData& floor = scene.meshes[0].primitives[0].mesh;
  floor.tangents.assign(floor.positions.size(), {1, 0, 0, -1});
  const auto baked = bakeTo("stage.lmb.glb", scene, unrefinedDraft());
  ASSERT_TRUE(baked) << baked.error().line();

  // Bundles are no scenes to bake. Other readers pass over the extension, whose name they do not know.
  std::string file = bytes("stage.lmb.glb");
  const std::string name = "LAMBENT_radiance_transfer";
  for (std::size_t at = file.find(name); at != std::string::npos; at = file.find(name, at))
    file.replace(at, 7, "UNKNOWN");
  std::ofstream(folder_ / "stage.glb", std::ios::binary) << file;
  const auto again = importScene(folder_ / "stage.glb");
  ASSERT_TRUE(again) << again.error().line();
  ASSERT_EQ(again->lights.size(), 1u);
  EXPECT_EQ(again->lights[0].color, scene.lights[0].color);
  EXPECT_EQ(again->nodes.at(1).light, 0);
  EXPECT_EQ(again->nodes.at(2).trs, scene.nodes[2].trs);
  EXPECT_TRUE(again->nodes[2].movable);
  ASSERT_EQ(again->animations.size(), 1u);
  EXPECT_EQ(again->animations[0].channels.at(0).values, scene.animations[0].channels[0].values);
  EXPECT_EQ(again->materials.at(0).emissive, scene.materials[0].emissive);
  EXPECT_EQ(again->materials[0].normal_texture, scene.materials[0].normal_texture);
  const bundle::MeshData& mesh = again->meshes.at(0).primitives.at(0).mesh;
  EXPECT_EQ(mesh.positions.size(), floor.positions.size());
  ASSERT_EQ(mesh.tangents.size(), mesh.positions.size());
  for (const glm::vec4& tangent : mesh.tangents) EXPECT_EQ(tangent, glm::vec4(1, 0, 0, -1));
}

TEST_F(Bake, SplitsEdgesWhereAShadowFallsUnlessToldNotTo) {
  const Scene scene = sceneOf({grid({0, 0, 0}, 4.0f, 1), icosphere({0, 0.8f, 0}, 0.6f, 2)});
  BakeOptions options = unrefinedDraft();
  options.refine_bound = -1.0f;
  const auto report = bakeTo("refined.lmb.glb", scene, options);
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_EQ(report->refinement.vertices_before, 4u + 162u);
  EXPECT_GT(report->vertices, 4u + 162u);
  EXPECT_EQ(report->vertices, report->refinement.vertices_after);
  EXPECT_LT(report->refinement.error_after, options.effectiveRefineBound());
}

// The mean over all surfaces knows more of the outside, which is bright and from which nothing bounces.
TEST_F(Bake, AHouseWithOutsideFacesHasAsManyBouncesAsItsRoom) {
  bundle::MeshData room = testing::flipped(box({0, 0, 0}, {4.0f, 3.0f, 4.0f}, 4)),
                   shell = box({0, 0, 0}, {4.4f, 3.4f, 4.4f}, 4);
  // A window: one quad of 16 is taken out of the wall towards +x, inside and outside.
  for (bundle::MeshData* mesh : {&room, &shell}) {
    std::vector<std::uint32_t> kept;
    for (std::size_t t = 0; t + 2 < mesh->indices.size(); t += 3) {
      const glm::vec3 middle = (mesh->positions[mesh->indices[t]] + mesh->positions[mesh->indices[t + 1]] +
                                mesh->positions[mesh->indices[t + 2]]) /
                               3.0f;
      const bool window = std::abs(middle.x) > 1.9f && middle.x > 0.0f && middle.y > 0.0f &&
                          middle.y < 0.85f && middle.z > 0.0f && middle.z < 1.1f;
      if (!window) kept.insert(kept.end(), {mesh->indices[t], mesh->indices[t + 1], mesh->indices[t + 2]});
    }
    mesh->indices = kept;
  }
  BakeOptions options = unrefinedDraft();
  options.bounces = -1;
  const auto report = bakeTo("house.lmb.glb", sceneOf({room, shell}), options);
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_GT(report->pass_energy.size(), 8u) << "half of the light is left by each bounce";
}

TEST_F(Bake, IsOutOfDateWhenLightsMotionOrMeshesChange) {
  Scene scene = twoGroups();
  scene.lights = {gltf::Light{}};
  scene.nodes[2].trs = gltf::Trs{};
  scene.animations = {{"roll", {{.node = 2, .times_s = {0, 1}, .values = {0, 0, 0, 1, 0, 0}}}}};
  const std::uint64_t before = sceneDigest(scene);
  const auto changes = [&](auto change) {
    Scene other = scene;
    change(other);
    return sceneDigest(other) != before;
  };
  EXPECT_FALSE(changes([](Scene&) {}));
  EXPECT_TRUE(changes([](Scene& s) { s.lights[0].intensity = 2.0f; }));
  EXPECT_TRUE(changes([](Scene& s) { s.lights[0].outer_cone_rad = 0.5f; }));
  EXPECT_TRUE(changes([](Scene& s) { s.nodes[0].light = 0; }));
  EXPECT_TRUE(changes([](Scene& s) { s.nodes[2].trs->scale.y = 3.0f; }));
  EXPECT_TRUE(changes([](Scene& s) { s.animations[0].channels[0].values[5] = 1.0f; }));
  EXPECT_TRUE(changes([](Scene& s) { s.animations[0].channels[0].node = 1; }));
  EXPECT_TRUE(changes([](Scene& s) {
    bundle::MeshData& mesh = s.meshes[0].primitives[0].mesh;
    mesh.tangents.assign(mesh.positions.size(), {1, 0, 0, 1});
  }));
}

TEST_F(Bake, ThatIsStoppedOrFailsLeavesTheOldBundle) {
  ASSERT_TRUE(bakeTo("stage.lmb.glb", twoGroups(), unrefinedDraft()));
  const std::string before = bytes("stage.lmb.glb");
  std::stop_source stop;
  stop.request_stop();
  Progress progress;
  const auto stopped =
      bake(twoGroups(), unrefinedDraft(), folder_ / "stage.lmb.glb", {progress, stop.get_token()});
  ASSERT_FALSE(stopped);
  EXPECT_NE(stopped.error().problem.find("stopped"), std::string::npos);
  BakeOptions wrong = unrefinedDraft();
  wrong.order = 9;
  EXPECT_FALSE(bakeTo("stage.lmb.glb", twoGroups(), wrong));
  EXPECT_TRUE(bytes("stage.lmb.glb") == before);
  EXPECT_EQ(files(), 1);
}

}  // namespace
}  // namespace lambent::baker
