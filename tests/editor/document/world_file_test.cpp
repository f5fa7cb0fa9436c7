#include "editor/document/world_file.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "editor/document/history.hpp"
#include "runtime/base/atomic_file.hpp"
#include "runtime/scene/instantiate.hpp"
#include "small_world.hpp"

namespace lambent::editor {
namespace {

namespace fs = std::filesystem;

glm::vec3 place(const glm::mat4& matrix) {
  return glm::vec3(matrix[3]);
}

std::string quoted(std::string_view word) {
  std::string text(1, '"');
  text += word;
  return text += '"';
}

Baseline baselineOf(const testing::SmallWorld& world) {
  const BaselineBundle bundle{&world.description, "small.lmb.glb", 0};
  return std::move(*Baseline::create({&bundle, 1}));
}

class WorldFiles : public ::testing::Test {
 protected:
  WorldFiles() {
    WorldState state;
    state.bundles.push_back({"small.lmb.glb", "small.lmb.glb", 0, "../small.gltf", {{"samples", "64"}}});
    state.lights = {"constant:0.1,0.2,0.3", "sun:35,45,6,100"};
    state.key_edits = {"key:10,20,30,40,0.5", "fade-key:0,0,0,90,1,0.5,0.25"};
    state.exposure_ev = -1.5f;
    state.settings = {{"window", "auto"}, {"specular-environment", "off"}};
    document.setWorld(state);
  }
  ~WorldFiles() override { fs::remove_all(folder); }

  // Edits the lamp, adds two lights (one below the table), and moves the table below a new entity.
  void edit() {
    ASSERT_TRUE(history.setField(world.node("lamp"), "Light", "strength", 0.1f));
    ASSERT_TRUE(history.setField(world.node("lamp"), "Transform", "rotation",
                                 glm::normalize(glm::quat(0.3f, 0.1f, -0.7f, 0.2f))));
    EntitySnapshot bulb = lightEntity("disc", "bulb \"7\"\n");
    bulb.parent = document.idOf(world.node("table"));
    const ecs::Entity made = *history.create(bulb);
    ASSERT_TRUE(history.setField(made, "Light", "color", glm::vec3(1.0f, 0.1f, 1e-7f)));
    stand = document.idOf(*history.create(emptyEntity("stand")));
    ASSERT_TRUE(history.reparent(world.instance.root, document.find(stand), true));
  }
  std::string text() {
    const WorldFile file = captureWorld(document, baselineOf(world));
    const Result<std::string> written = worldText(file);
    EXPECT_TRUE(written) << written.error().line();
    return *written;
  }
  std::string errorOf(const std::string& json) {
    const Result<WorldFile> read = parseWorld(json, "w.json");
    return read ? "no error" : read.error().line();
  }
  // Returns the text with one part replaced, which must be there.
  std::string damaged(const std::string& what, const std::string& by) {
    std::string json = text();
    const auto at = json.find(what);
    EXPECT_NE(at, std::string::npos) << what << " in " << json;
    return at == std::string::npos ? json : json.replace(at, what.size(), by);
  }

  testing::SmallWorld world;
  Document document{world.registry, 1};
  History history{document};
  StableId stand;
  fs::path folder = fs::temp_directory_path() / ("lambent_world_" + std::to_string(::getpid()));
};

TEST_F(WorldFiles, RoundTripBringsBackEveryEditInAnotherSession) {
  edit();
  const std::string first = text();
  const Result<WorldFile> read = parseWorld(first, "w.json");
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_TRUE(read->notices.empty());

  testing::SmallWorld other;
  Document again(other.registry, 2);
  const ApplyReport report = applyWorld(again, *read);
  EXPECT_TRUE(report.missing.empty());
  EXPECT_EQ(again.world(), document.world());
  EXPECT_EQ(other.registry.get<scene::LocalLightComponent>(other.node("lamp")).strength, 0.1f);
  EXPECT_EQ(parentOf(other.registry, other.instance.root), again.find(stand));
  EXPECT_EQ(worldFromNode(other.registry, other.node("ball")),
            worldFromNode(world.registry, world.node("ball")));
  EXPECT_EQ(*worldText(captureWorld(again, baselineOf(other))), first) << "the same file, byte by byte";
}

TEST_F(WorldFiles, LightsOfTheCommandLineAndTheEnvironmentAreSavedWithoutBeingMadeByHand) {
  const std::vector<spec::Light> lights{*spec::parseLight("sphere:1,2,3,0.5,10")};
  scene::addLights(world.registry, lights);
  const ecs::Entity sky = scene::addEnvironment(world.registry, {2.0f, 45.0f, 0.25f});
  const Result<WorldFile> read = parseWorld(text(), "w.json");
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_EQ(document.idOf(sky), environmentId());
  ASSERT_EQ(read->entities.size(), 1u) << "the light; the environment has a place of its own";
  testing::SmallWorld other;
  Document again(other.registry, 2);
  applyWorld(again, *read);
  ASSERT_TRUE(again.find(environmentId()));
  const auto& there = other.registry.get<scene::EnvironmentComponent>(again.find(environmentId()));
  EXPECT_EQ(there.rotation_deg, 45.0f);
  EXPECT_EQ(there.fade, 0.25f);
  EXPECT_EQ(place(worldFromNode(other.registry, again.find(read->entities[0].id))),
            glm::vec3(1.0f, 2.0f, 3.0f));
}

TEST_F(WorldFiles, OnlyWhatDiffersFromTheBundleIsWritten) {
  EXPECT_EQ(captureWorld(document, baselineOf(world)).entities.size(), 0u);
  ASSERT_TRUE(history.setField(world.node("lamp"), "Light", "strength", 0.1f));
  const WorldFile file = captureWorld(document, baselineOf(world));
  ASSERT_EQ(file.entities.size(), 1u);
  ASSERT_EQ(file.entities[0].fields.size(), 1u);
  EXPECT_NE(worldText(file)->find("\"strength\": 0.1\n"), std::string::npos) << "0.1, not 0.10000000149";
  history.undo();
  EXPECT_EQ(captureWorld(document, baselineOf(world)).entities.size(), 0u);
}

TEST_F(WorldFiles, WhatAnAnimationMovesIsNoEdit) {
  world.registry.edit<scene::Transform>(world.node("ball")).translation.x = 9.0f;  // as playAnimations does
  world.registry.edit<scene::AnimationComponent>(world.instance.animations[0]).time_s = 0.5f;
  EXPECT_EQ(captureWorld(document, baselineOf(world)).entities.size(), 0u);
  world.registry.edit<scene::AnimationComponent>(world.instance.animations[0]).playing = false;
  EXPECT_EQ(captureWorld(document, baselineOf(world)).entities.size(), 1u) << "stopped there: a choice";
}

TEST_F(WorldFiles, WhatThisVersionDoesNotKnowIsTold) {
  ASSERT_TRUE(history.setField(world.node("lamp"), "Light", "strength", 2.0f));
  std::string json = damaged("\"strength\": 2.0", "\"strength\": 2, \"flicker\": [1, {\"a\": null}]");
  json.replace(json.find("\"environment\": {"), 16, "\"future\": {\"x\": 1}, \"environment\": {\"fog\": 3,");
  const Result<WorldFile> read = parseWorld(json, "w.json");
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_EQ(read->notices.size(), 3u);
  EXPECT_EQ(*worldText(*read), text());
}

TEST_F(WorldFiles, TheExampleOfTheDocumentIsAWorldFileAndEveryFieldStandsInIt) {
  const std::string page = *readTextFile(fs::path(LAMBENT_SOURCE_DIR) / "docs/world-file.md");
  const auto from = page.find("```json\n") + 8, to = page.find("```", from);
  const Result<WorldFile> read = parseWorld(page.substr(from, to - from), "docs/world-file.md");
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_TRUE(read->notices.empty());
  EXPECT_EQ(read->entities.size(), 2u);
  const std::string schema = *readTextFile(fs::path(LAMBENT_SOURCE_DIR) / "docs/schema/world.schema.json");
  for (const scene::ComponentInfo& component : scene::components()) {
    for (const scene::FieldInfo& field : component.fields) {
      const std::string name = std::string(component.name) + "." + std::string(field.name);
      EXPECT_NE(page.find('`' + name + '`'), std::string::npos) << name;
      EXPECT_NE(schema.find(quoted(field.name)), std::string::npos) << name;
      for (const std::string_view word : field.words)
        EXPECT_NE(schema.find(quoted(word)), std::string::npos) << word;
    }
  }
}

TEST_F(WorldFiles, EditsOfWhatABundleCameWithoutWaitForItsReturn) {
  ASSERT_TRUE(history.setField(world.node("lamp"), "Light", "strength", 2.0f));
  const Result<WorldFile> read = parseWorld(text(), "w.json");
  testing::SmallWorld other;
  other.registry.destroy(other.node("lamp"));
  Document again(other.registry, 2);
  const ApplyReport report = applyWorld(again, *read);
  ASSERT_EQ(report.missing.size(), 1u);
  EXPECT_EQ(report.missing[0].substr(0, 4), "lamp");
  EXPECT_EQ(*worldText(captureWorld(again, baselineOf(other), read->entities)), text());
}

TEST_F(WorldFiles, EveryKindOfDamageIsNamedWithItsPlace) {
  edit();
  const std::string lamp = "entities." + idText(document.idOf(world.node("lamp"))) + ".components.";
  // Each case has what is replaced, by what, and what the error must say.
  const std::vector<std::tuple<std::string, std::string, std::string>> damages = {
      {"\"lambent_world\": 1", "\"lambent_world\": 2",
       "lambent_world is version 2; this program reads up to 1"},
      {"\"lambent_world\": 1", "\"lambent_world\": \"1\"", "lambent_world is not a whole number"},
      {"\"lambent_world\": 1", "\"world\": 1", "lambent_world is missing"},
      {"\"path\": \"small.lmb.glb\"", "\"path\": 3", "bundles[0].path is not a text"},
      {"\"path\": \"small.lmb.glb\",", "", "bundles[0].path is missing"},
      {"\"instance\": 0", "\"instance\": -1", "bundles[0].instance is not a whole number"},
      {"\"samples\": \"64\"", "\"samples\": 64", "bundles[0].bake_options.samples is not a text"},
      {"\"sun:35,45,6,100\"", "\"sun:35,45\"", "environment.lights[1]"},
      {"\"sun:35,45,6,100\"", "\"sphere:0,0,0,1,1\"",
       "environment.lights[1] is a light that stands in the scene"},
      {"\"key:10,20,30,40,0.5\"", "\"key:10,20,30,95,0.5\"",
       "environment.key_edits[0] has an elevation outside"},
      {"\"fade\": 0.0", "\"fade\": 2", "environment.fade 2 lies outside 0..1"},
      {"\"exposure\": -1.5", "\"exposure\": true", "environment.exposure is not a number"},
      {"\"window\": \"auto\"", "\"window\": {}", "settings.window is not a text"},
      {"\"strength\": 0.1", "\"strength\": -1", lamp + "Light.strength -1 lies outside 0..1000000000"},
      {"\"strength\": 0.1", "\"strength\": \"0.1\"", lamp + "Light.strength is not a number"},
      {"\"strength\": 0.1", "\"strength\": 1e39", lamp + "Light.strength is too large"},
      {"\"rotation\": [", "\"rotation\": [3, ", lamp + "Transform.rotation is not a list of 4 numbers"},
      {"\"kind\": \"disc\"", "\"kind\": \"dics\"", "Light.kind knows no \"dics\"; use point, spot"},
      {"\"enabled\": true", "\"enabled\": 1", "Light.enabled is not true or false"},
      {"\"Light\": {\n          \"kind\"", "\"Lamp\": {}, \"Light\": {\n          \"kind\"",
       "Lamp cannot be made by hand"},
      {"\"created\": true", "\"created\": \"yes\"", "created is not true or false"},
      {"\"parent\": \"", "\"parent\": \"x", "parent is not 16 hexadecimal digits"},
      {"\"" + idText(stand) + "\": {", "\"stand\": {", "entities.stand has a name that is not 16"},
      {"\"entities\": {", "\"entities\": [], \"old\": {", "entities is not an object"},
  };
  for (const auto& [what, by, says] : damages) {
    const std::string error = errorOf(damaged(what, by));
    EXPECT_NE(error.find(says), std::string::npos) << by << "\n  says: " << error << "\n  not:  " << says;
  }
  EXPECT_NE(errorOf(std::string(500, '[') + std::string(500, ']')).find("nested too deeply"),
            std::string::npos);
  EXPECT_NE(errorOf("[]").find("no world file"), std::string::npos);
}

TEST_F(WorldFiles, TextsCutOffAnywhereAreErrorsAndNothingElse) {
  edit();
  const std::string whole = text();
  for (std::size_t length = 0; length + 2 < whole.size(); length += 7)
    EXPECT_FALSE(parseWorld(whole.substr(0, length), "w.json")) << length;
}

TEST_F(WorldFiles, AreReadWithoutTheirBundlesAndPathsAreTheFilesOwn) {
  fs::create_directories(folder / "sub");
  const fs::path path = folder / "world.json";
  ASSERT_TRUE(saveWorldFile(path, captureWorld(document, baselineOf(world))));
  const Result<WorldFile> read = loadWorldFile(path);
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_EQ(read->state.bundles.front().path, "small.lmb.glb");
}

TEST_F(WorldFiles, AnUnfitValueLeavesTheOldFileAlone) {
  fs::create_directories(folder);
  const fs::path path = folder / "world.json";
  ASSERT_TRUE(saveWorldFile(path, captureWorld(document, baselineOf(world))));
  const std::string before = *readTextFile(path);
  world.registry.edit<scene::LocalLightComponent>(world.node("lamp")).strength =
      std::numeric_limits<float>::infinity();
  const Result<void> saved = saveWorldFile(path, captureWorld(document, baselineOf(world)));
  ASSERT_FALSE(saved);
  EXPECT_NE(saved.error().line().find("Light.strength of lamp"), std::string::npos) << saved.error().line();
  EXPECT_EQ(*readTextFile(path), before);
}

TEST_F(WorldFiles, AReloadedBundleGetsItsEditsAndItsChildrenBack) {
  edit();
  const std::string before = text();
  const glm::mat4 ball = worldFromNode(world.registry, world.node("ball"));
  const Overrides kept = captureOverrides(document, baselineOf(world));
  scene::destroyInstance(world.registry, world.instance);
  world.add(0);
  EXPECT_TRUE(applyOverrides(document, kept).missing.empty());
  EXPECT_EQ(text(), before);
  EXPECT_EQ(worldFromNode(world.registry, world.node("ball")), ball);
  while (history.canUndo()) EXPECT_TRUE(history.undo().missing.empty());
  EXPECT_TRUE(captureWorld(document, baselineOf(world)).entities.empty()) << "undo reaches behind the reload";
}

}  // namespace
}  // namespace lambent::editor
