// Tests repeated bakes: the bundle is the same whatever the cache holds, and only what changed is computed.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <thread>

#include <gtest/gtest.h>

#include "baker/bake/bake.hpp"
#include "baker/bake/group_scene.hpp"
#include "baker/cache/cache.hpp"
#include "baker/import/scene_digest.hpp"
#include "runtime/base/process.hpp"
#include "tests/support/material_values.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lambent::baker {

namespace {

namespace fs = std::filesystem;
using testing::box;
using testing::grid;
using testing::icosphere;
using testing::sceneOf;
using testing::TemporaryFolder;

constexpr std::size_t kFloor = 0, kPolished = 1, kLamp = 2, kBrushed = 3;  // materials

// Makes a floor with a box that hides a part of it from the sky, a lamp above, a polished body, and a movable
// ball on a movable brushed plate. Everything is grey.
Scene stage() {
  Scene scene = sceneOf({grid({0, 0, 0}, 4.0f, 12), box({-0.8f, 0.45f, 0}, {1, 1, 1}, 4),
                         grid({0, 0, 0}, 0.5f, 2), icosphere({0.9f, 0.3f, 0.9f}, 0.4f, 2),
                         icosphere({0, 0.5f, 0}, 0.4f, 2), box({0, 0, 0}, {1.2f, 0.1f, 1.2f}, 3)});
  scene.materials.resize(4, scene.materials[0]);
  scene.materials[kFloor].base_color = glm::vec4(0.6f, 0.6f, 0.6f, 1.0f);
  scene.materials[kPolished].metallic = 1.0f;
  scene.materials[kPolished].roughness = 0.4f;
  scene.materials[kLamp].emissive = glm::vec3(3.0f);
  scene.materials[kLamp].double_sided = true;
  scene.materials[kBrushed].metallic = 1.0f;
  scene.materials[kBrushed].roughness = 0.5f;
  scene.meshes[2].primitives[0].material = kLamp;
  scene.meshes[3].primitives[0].material = kPolished;
  scene.meshes[5].primitives[0].material = kBrushed;
  scene.nodes[2].parent_from_node = glm::translate(glm::mat4(1.0f), {0.5f, 2.0f, 0});
  scene.nodes[5].movable = true;
  scene.nodes[5].name = "plate";
  scene.nodes[5].parent_from_node = glm::translate(glm::mat4(1.0f), {5.0f, 0.6f, 0});
  scene.nodes[5].children = {4};
  scene.nodes[4].parent = 5;
  std::erase(scene.roots, 4);
  return scene;
}

BakeOptions draft() {
  BakeOptions options;
  options.quality = Quality::Draft;
  options.rays = 128;
  options.glossy_order = 4;
  options.bounces = 2;
  options.fit = true;
  options.effects = "diffuse,glossy";  // neighborhoods look at what others do
  return options;
}

class BakeAgain : public ::testing::Test {
 protected:
  struct Baked {
    std::string bytes;
    BakeReport report;
    std::uint64_t rays() const { return report.rays + report.refinement.rays; }
    // Returns the counts of one effect on one group.
    Reuse of(const std::string& group, const std::string& effect) const {
      for (const BakeReport::Group& g : report.groups)
        for (const auto& e : g.effects)
          if (g.name == group && e.name == effect) return e.reuse;
      ADD_FAILURE() << group << " has no " << effect;
      return Reuse::Baked;
    }
  };
  Cache openCache(const std::string& name = "cache") const {
    auto cache = Cache::open(folder_.path() / name);
    EXPECT_TRUE(cache);
    return std::move(*cache);
  }
  Baked bakeWith(Cache* cache, const Scene& scene, const BakeOptions& options = draft()) const {
    Progress progress;
    const fs::path out = folder_.path() / "out.lmb.glb";
    auto report = bake(scene, options, out, {progress, {}, cache});
    EXPECT_TRUE(report) << report.error().line();
    std::ifstream in(out, std::ios::binary);
    return {{std::istreambuf_iterator<char>(in), {}}, std::move(*report)};
  }
  // Bakes with the cache and again without; the bundles must be equal.
  Baked bakeBoth(Cache& cache, const Scene& scene, const BakeOptions& options = draft()) const {
    Baked with = bakeWith(&cache, scene, options);
    EXPECT_TRUE(with.bytes == bakeWith(nullptr, scene, options).bytes);
    return with;
  }

  TemporaryFolder folder_;
};

TEST_F(BakeAgain, WritesTheSameBundleWithoutAColdAndAWarmCache) {
  Cache cache = openCache();
  const Baked cold = bakeBoth(cache, stage());
  EXPECT_GT(cold.rays(), 0u);
  EXPECT_EQ(cold.report.rays_kept, 0u);
  EXPECT_EQ(cold.of("static", "glossy"), Reuse::Baked);
  const Baked warm = bakeWith(&cache, stage());
  EXPECT_TRUE(warm.bytes == cold.bytes);
  EXPECT_EQ(warm.rays(), 0u);
  EXPECT_EQ(warm.report.rays_kept, cold.report.rays);
  EXPECT_EQ(warm.report.refinement.rays_kept, cold.report.refinement.rays);
  EXPECT_EQ(warm.of("static", "diffuse"), Reuse::Found);
  // The report describes the bundle, whether its parts were computed or found in the cache.
  EXPECT_EQ(warm.report.worst_error, cold.report.worst_error);
  EXPECT_EQ(warm.report.worst_glossy_error, cold.report.worst_glossy_error);
  EXPECT_EQ(warm.report.pass_energy, cold.report.pass_energy);
  EXPECT_EQ(warm.report.filled_samples, cold.report.filled_samples);
  EXPECT_EQ(warm.report.refinement.vertices_after, cold.report.refinement.vertices_after);
}

TEST_F(BakeAgain, TracesNoRayForAnAlbedo) {
  Cache cache = openCache();
  bakeWith(&cache, stage());
  Scene scene = stage();
  scene.materials[kFloor].base_color = glm::vec4(0.7f, 0.5f, 0.3f, 1.0f);  // of grey light becomes coloured
  const Baked floor = bakeBoth(cache, scene);
  EXPECT_EQ(floor.rays(), 0u);
  EXPECT_EQ(floor.of("static", "diffuse"), Reuse::Regathered);
  EXPECT_EQ(floor.of("static", "glossy"), Reuse::Regathered);

  scene.materials[kFloor].base_color = glm::vec4(0.0f, 0.0f, 0.0f, 1.0f);  // reflects nothing
  EXPECT_EQ(bakeBoth(cache, scene).rays(), 0u);

  scene = stage();
  scene.materials[kBrushed].base_color = glm::vec4(0.9f, 0.7f, 0.2f, 1.0f);
  scene.materials[kBrushed].roughness = 0.6f;
  const Baked brushed = bakeBoth(cache, scene);
  EXPECT_EQ(brushed.rays(), 0u);
  EXPECT_EQ(brushed.of("static", "glossy"), Reuse::Found);
  EXPECT_EQ(brushed.of("plate", "glossy"), Reuse::Regathered);

  // The strength of a lamp is not baked, but the error of pictures is that of lamps as they are.
  scene = stage();
  scene.materials[kLamp].emissive = glm::vec3(5.0f, 1.0f, 0.5f);
  const Baked dimmed = bakeBoth(cache, scene);
  EXPECT_EQ(dimmed.rays(), 0u);
  EXPECT_EQ(dimmed.of("static", "diffuse"), Reuse::Regathered);

  // Names are not baked.
  scene = stage();
  scene.materials[kFloor].name = "a floor";
  scene.nodes[0].name = "below";
  const Baked renamed = bakeBoth(cache, scene);
  EXPECT_EQ(renamed.rays(), 0u);
  EXPECT_EQ(renamed.of("static", "diffuse"), Reuse::Found);
}

TEST_F(BakeAgain, TracesOnlyTheGroupInWhichANodeMoved) {
  Cache cache = openCache();
  const Baked first = bakeWith(&cache, stage());
  Scene scene = stage();
  scene.nodes[1].parent_from_node = glm::translate(glm::mat4(1.0f), {0.1f, 0.0f, 0.2f});
  const Baked moved = bakeBoth(cache, scene);
  EXPECT_EQ(moved.of("static", "diffuse"), Reuse::Baked);
  EXPECT_EQ(moved.of("plate", "diffuse"), Reuse::Found);
  EXPECT_EQ(moved.of("plate", "glossy"), Reuse::Found);

  scene = stage();
  scene.nodes[4].parent_from_node = glm::translate(glm::mat4(1.0f), {0.05f, 0.0f, 0.0f});
  const Baked ball = bakeBoth(cache, scene);
  EXPECT_EQ(ball.of("static", "diffuse"), Reuse::Found);
  EXPECT_EQ(ball.of("plate", "diffuse"), Reuse::Baked);

  // A group that moves as a whole only changes its transform.
  scene = stage();
  scene.nodes[5].parent_from_node =
      glm::rotate(glm::translate(glm::mat4(1.0f), {5.3f, 0.7f, 0.1f}), 0.3f, {0.0f, 1.0f, 0.0f});
  const Baked carried = bakeBoth(cache, scene);
  EXPECT_EQ(carried.rays(), 0u);
  EXPECT_EQ(carried.of("plate", "diffuse"), Reuse::Found);
  EXPECT_FALSE(carried.bytes == first.bytes);
}

// Runs a bake and requests a stop after this many units of work.
bool stopsAfter(std::uint64_t units, const Scene& scene, const fs::path& out, Cache& cache) {
  Progress progress;
  std::stop_source stop;
  const std::jthread watch([&](const std::stop_token& ended) {
    while (!ended.stop_requested()) {
      std::uint64_t done = progress.now().done;
      for (const Progress::Stage& stage : progress.finished()) done += stage.done;
      if (done >= units) return void(stop.request_stop());
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
  });
  return !bake(scene, draft(), out, {progress, stop.get_token(), &cache}).has_value();
}

TEST_F(BakeAgain, EndsInTheSameBundleWhereverItWasStopped) {
  const Scene scene = stage();
  const Baked whole = bakeWith(nullptr, scene);
  std::uint64_t units = 0;
  for (const Progress::Stage& stage : whole.report.stages) units += stage.done;
  std::mt19937 random(7);
  const fs::path out = folder_.path() / "stopped.lmb.glb";
  int stopped = 0;
  for (int run = 0; run < 2; ++run) {
    Cache cache = openCache("cache" + std::to_string(run));
    cache.setCheckpointEvery(run % 2 == 0 ? 0.0 : 1e9);
    const std::uint64_t after = units / 8 + random() % (units / 2);
    stopped += stopsAfter(after, scene, out, cache);
    EXPECT_TRUE(bakeWith(&cache, scene).bytes == whole.bytes) << "stopped after " << after;
  }
  EXPECT_GT(stopped, 0);

  // Each run is stopped a little later, and no work is done twice.
  Cache cache = openCache();
  cache.setCheckpointEvery(0.0);
  int runs = 0;
  while (stopsAfter(units / 3 + units / 5 * static_cast<std::uint64_t>(runs), scene, out, cache))
    ASSERT_LT(++runs, 60);
  const Baked rest = bakeWith(&cache, scene);
  EXPECT_TRUE(rest.bytes == whole.bytes);
  EXPECT_EQ(rest.rays(), 0u);
}

TEST_F(BakeAgain, TracesAgainWhatHadNoRoomInMemory) {
  BakeOptions small = draft();
  const std::string whole = bakeWith(nullptr, stage()).bytes;
  // The limit is so little above what is taken now that hits are kept at first, and given up when the bounces
  // begin.
  small.memory_bytes = residentBytes() + 3'000'000;
  EXPECT_TRUE(bakeWith(nullptr, stage(), small).bytes == whole);
  small.memory_bytes = 100'000;
  Cache cache = openCache();
  EXPECT_TRUE(bakeBoth(cache, stage(), small).bytes == whole);
  Scene scene = stage();
  scene.materials[kFloor].base_color = glm::vec4(0.2f, 0.5f, 0.3f, 1.0f);
  bakeBoth(cache, scene, small);
}

// Checks that every field of a material is part of the keys that decide whether a bundle is up to date, and
// whether a cached result is valid.

using testing::changed;

// Makes a glossy plate of the material, with everything that a field may need to have an effect.
Scene plateOf(const gltf::Material& material) {
  Scene scene = testing::sceneOf({testing::grid({0, 0, 0}, 1.0f, 2)});
  scene.materials = {material};
  scene.textures.resize(testing::kMaterialTextures);
  scene.images.resize(testing::kMaterialTextures);
  for (std::size_t i = 0; i < testing::kMaterialTextures; ++i) {
    scene.textures[i].image = static_cast<std::int32_t>(i);
    scene.images[i].file_bytes = {std::byte(i)};
  }
  scene.brdfs.resize(1);
  scene.brdfs[0].measurements.resize(1);
  return scene;
}

TEST(MaterialKeys, EveryFieldPutsABundleOutOfDate) {
  const gltf::Material plain = testing::materialWithEverything();
  const std::uint64_t before = sceneDigest(plateOf(plain));
  gltf::forEachMaterialField([&](const auto& field) {
    EXPECT_NE(sceneDigest(plateOf(changed(plain, field))), before) << field.name;
  });
}

// If rows of the table move, or values are hashed in another form, every bundle is out of date.
TEST(MaterialKeys, DigestsOfScenesStayAsTheyWere) {
  EXPECT_EQ(sceneDigest(plateOf(testing::materialWithEverything())), 0xacfbf1713277b284ull);
}

GroupKeys keysOf(const gltf::Material& material) {
  const Scene scene = plateOf(material);
  GroupGeometry geometry;
  geometry.positions.resize(3), geometry.triangles.resize(1);
  DrawGeometry draw;
  draw.material = 0, draw.kind = SampleKind::Glossy;
  geometry.draws = {draw};
  const PlannedLight lamp{.kind = PlannedLight::Kind::Material, .index = 0};
  return groupKeys(scene, geometry, {&lamp, 1}, {}, {});
}

TEST(MaterialKeys, EveryFieldThatABakeDependsOnChangesTheKeysOfItsResults) {
  using Part = gltf::MaterialPart;
  gltf::forEachMaterialField([&](const auto& field) {
    const std::string name(field.name);
    gltf::Material plain = testing::materialWithEverything();
    // Only panes have a use for these, and their rays depend on how they reflect, too.
    const bool of_panes =
        name == "transmission_texture" || name == "thickness_m" || name.starts_with("attenuation");
    plain.transmission = of_panes ? 0.5f : 0.0f;
    const GroupKeys before = keysOf(plain), keys = keysOf(changed(plain, field));
    // Strengths of lamps, names and bumps are applied at run time.
    const bool baked =
        name != "emissive" && name != "normal_scale" && name != "normal_texture" && name != "name";
    EXPECT_EQ(keys.cells != before.cells, baked) << name;
    // Rays are traced again only if other rays are blocked, or a lamp changes.
    const bool stops =
        field.part == Part::Opacity || name == "emissive_texture" || name.starts_with("base_color");
    EXPECT_EQ(keys.rays != before.rays, stops) << name;
    if (field.part == Part::Color || field.part == Part::Reflection) {
      EXPECT_NE(keys.proxy, before.proxy) << name;
    }
  });
}

}  // namespace

}  // namespace lambent::baker
