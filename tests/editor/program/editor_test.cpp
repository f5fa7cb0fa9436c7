// Tests the editor as a user sees it, driven by scripts through the same widgets, under Xvfb.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "assets/glb.hpp"
#include "assets/shapes.hpp"
#include "baker/bake/option_rows.hpp"
#include "baker/pipeline/journal.hpp"
#include "tests/editor/program/editor_program.hpp"

namespace lambent {
namespace {

using nlohmann::json;
using testing::EditorProgram;
using testing::Played;
using testing::told;

TEST_F(EditorProgram, OpensBakesSelectsDragsEditsUndoesSavesAndReloads) {
  const Played first = play(fmt::format(R"(
open {0}
wait baked 240
wait rest 60
state
expect /scenes/0/bake/phase done
expect /errors 0
create-sphere 0 1.5 0
set Light.radius 0.2
set Light.strength 20
frame
wait frames 20
get Transform.translation
expect /1 1.5
drag gizmo.y 0 -60
get Transform.translation
undo
get Transform.translation
expect /1 1.5
redo
state
save {1}
state
expect /modified false
screenshot {2}
)",
                                        path("hello.glb"), path("world.json"), path("shot.png")));
  ASSERT_EQ(first.outcome.exit_code, 0) << told(first.outcome);
  EXPECT_TRUE(std::filesystem::exists(folder / "hello.lmb.glb"));
  EXPECT_GT(std::filesystem::file_size(folder / "shot.png"), 20000u);
  EXPECT_TRUE(first.answer("state")["undo"].get<std::string>().find("move") != std::string::npos)
      << first.answer("state").dump();

  const Played second =
      play(fmt::format("open {}\nwait loaded\nselect \"sphere 2\"\nget Transform.translation\n"
                       "get Light.radius\nstate\n",
                       path("world.json")));
  ASSERT_EQ(second.outcome.exit_code, 0) << told(second.outcome);
  // The handle was dragged up by a noticeable distance.
  EXPECT_GT(second.answer("get Transform")[1].get<double>(), 1.55);
  EXPECT_NEAR(second.answer("get Light.radius").get<double>(), 0.2, 1e-6);
  EXPECT_EQ(second.answer("state")["scenes"][0]["bake"]["upToDate"], true);
}

TEST_F(EditorProgram, BakesTheScenesOfAWorldWithTheOptionsThatItWasSavedWith) {
  const Played first =
      play(fmt::format("open {0}\nbake-option rays 300\nbake-option bounces 1\nbake\nwait baked 240\n"
                       "save {1}\nstate\n",
                       path("hello.glb"), path("world.json")));
  ASSERT_EQ(first.outcome.exit_code, 0) << told(first.outcome);
  const Played second = play(fmt::format("open {}\nwait baked 240\nstate\n", path("world.json")));
  ASSERT_EQ(second.outcome.exit_code, 0) << told(second.outcome);
  const json& before = first.answer("state")["scenes"][0];
  const json& scene = second.answer("state")["scenes"][0];
  EXPECT_EQ(scene["bakeOptions"]["rays"], "300") << scene.dump();
  EXPECT_EQ(scene["bakeOptions"], before["bakeOptions"]);
  EXPECT_EQ(scene["bake"]["upToDate"], true) << "or it was baked with other options than the bundle has";
}

TEST_F(EditorProgram, SetsEveryOptionOfABakeInItsPanel) {
  const Played played = play(fmt::format(R"(
open {0}
wait loaded
panel Bakes
wait frames 3
click bakes.hello.options
wait frames 3
marks
click bake-option.volume-grid
type 16x8x4
key Enter
wait frames 3
click bake-option.neighborhood-grid
type 12
key Enter
wait frames 3
click bake-option.fit
wait frames 3
click bake-option.fit.on
wait frames 3
state
)",
                                         path("hello.glb")),
                             {"--no-bake"});
  ASSERT_EQ(played.outcome.exit_code, 0) << told(played.outcome);
  const std::string marks = played.answer("marks").dump();
  for (const baker::OptionRow& row : baker::optionRows())
    EXPECT_NE(marks.find(fmt::format("\"bake-option.{}\"", row.name)), std::string::npos) << row.name;
  const json& options = played.answer("state")["scenes"][0]["bakeOptions"];
  EXPECT_EQ(options["volumeGrid"], "16x8x4");
  EXPECT_EQ(options["neighborhoodGrid"], "12x12x12");
  EXPECT_EQ(options["fit"], "on");
}

TEST_F(EditorProgram, ReachesEachOfSeveralMarksWithOneName) {
  const Played played =
      play(fmt::format("open {}\nwait loaded\ncreate-sphere 1 2 0\nrename lamp\ncreate-sphere -1 2 0\n"
                       "rename lamp\nwait frames 3\nmarks\nclick scene.lamp\nget Transform.translation\n"
                       "click scene.lamp#2\nget Transform.translation\n",
                       path("hello.glb")),
           {"--no-bake"});
  ASSERT_EQ(played.outcome.exit_code, 0) << told(played.outcome);
  const auto places = played.all("get Transform.translation");
  ASSERT_EQ(places.size(), 2u);
  EXPECT_NEAR(std::abs(places[0][0].get<double>()), 1.0, 1e-6);
  EXPECT_NEAR(places[0][0].get<double>(), -places[1][0].get<double>(), 1e-6) << "not the same twice";
}

TEST_F(EditorProgram, TakesADroppedSceneAndShowsItBeforeItIsBaked) {
  const Played played =
      play(fmt::format("drop {0}\nwait frames 3\nwait loaded 60\nstate\nwait baked 240\nstate\n"
                       "tree type:light\nplan\nwait seconds 2\nplan\n",
                       path("hello.glb")));
  ASSERT_EQ(played.outcome.exit_code, 0) << told(played.outcome);
  EXPECT_EQ(played.answer("state")["scenes"][0]["bake"]["reached"], "final");
  EXPECT_EQ(played.answer("state")["errors"], 0);
  EXPECT_EQ(played.answer("plan")["ready"], true);
}

// What another scene's bake left behind must not stand in the scene that is opened.
TEST_F(EditorProgram, ShowsTheOpenedSceneAloneAndOffersUnfinishedBakes) {
  std::filesystem::copy(path("hello.glb"), path("other.glb"));
  baker::Journal(folder / "cache" / baker::kJournalFolder)
      .begin({.scene = path("other.glb"), .output = path("other.lmb.glb")});
  const Played played = play(R"(
wait baked 240
state
tree type:bundle
click bakes.other.glb.go-on
wait frames 3
wait baked 240
state
tree type:bundle
)",
                             {path("hello.glb"), "--fresh"});
  ASSERT_EQ(played.outcome.exit_code, 0) << told(played.outcome);
  const std::vector<json> states = played.all("state"), trees = played.all("tree");
  ASSERT_EQ(trees.size(), 2u);
  for (const json& tree : trees) EXPECT_EQ(tree.size(), 1u) << tree.dump();
  EXPECT_EQ(states[0]["unfinished"], json::array({path("other.glb")}));
  EXPECT_EQ(states[1]["unfinished"], json::array());
  EXPECT_EQ(states[1]["unseen"][0]["phase"], "done") << states[1].dump();
  EXPECT_TRUE(std::filesystem::exists(path("other.lmb.glb")));
}

// The tree, the status bar and the Bakes panel tell the same, and go on to tell it without a selection.
TEST_F(EditorProgram, TellsEverywhereThatThePictureNeedsARebake) {
  const Played played = play(fmt::format(R"(
open {0}
wait baked 240
wait frames 3
marks
select "has:Transform sphere"
set Transform.translation 0.1 0.6 0.2
select-none
wait frames 5
marks
state
)",
                                         path("hello.glb")));
  ASSERT_EQ(played.outcome.exit_code, 0) << told(played.outcome);
  const std::vector<json> marks = played.all("marks");
  ASSERT_EQ(marks.size(), 2u);
  const auto has = [](const json& names, const char* name) {
    return std::ranges::find(names, name) != names.end();
  };
  for (const char* name : {"status.scenes", "scene.hello.state"}) {
    EXPECT_FALSE(has(marks[0], name)) << name;
    EXPECT_TRUE(has(marks[1], name)) << name;
  }
  EXPECT_EQ(played.answer("state")["scenes"][0]["status"], "needs a rebake");
}

TEST_F(EditorProgram, CommitsAnOpenFieldBeforeUndoAndSaysWhatItUndoes) {
  const Played played = play(R"(
create-empty
panel Inspector
wait frames 3
click inspector.Name.name
key Ctrl+A
type "lamp"
wait frames 3
get Name.name
key Ctrl+Z
wait frames 3
get Name.name
state
key Ctrl+Shift+Z
wait frames 3
get Name.name
click menu.Edit
wait frames 3
click menu.undo@0.05,0.5
wait frames 3
get Name.name
state
)");
  ASSERT_EQ(played.outcome.exit_code, 0) << told(played.outcome);
  const std::vector<json> names = played.all("get Name.name");
  EXPECT_EQ(names, (std::vector<json>{"lamp", "empty", "lamp", "empty"}));
  EXPECT_EQ(played.answer("state")["undo"], "Undo creation of empty");
  EXPECT_EQ(played.answer("state")["redo"], "Redo Name of empty");
}

TEST_F(EditorProgram, ChoosesAUnitAndRunsACommandOfThePalette) {
  const Played played = play(R"(
create-point
set Light.strength 10
panel Inspector
wait frames 3
marks
click inspector.Light.unit
wait frames 3
click inspector.Light.unit.lm
wait frames 3
get Light.strength
key Ctrl+P
wait frames 3
type "camera"
wait frames 3
click palette.create-camera
wait frames 3
state
right-click scene.camera
wait frames 3
click context.delete
wait frames 3
state
)");
  ASSERT_EQ(played.outcome.exit_code, 0) << told(played.outcome);
  const std::string marks = played.answer("marks").dump();
  EXPECT_NE(marks.find("inspector.Light.range"), std::string::npos);
  EXPECT_EQ(marks.find("inspector.Light.radius"), std::string::npos) << "a point has none";
  EXPECT_EQ(played.answer("get Light.strength"), 10.0) << "a unit changes no light";
  EXPECT_EQ(played.all("state")[0]["selected"], json::array({"camera"}));
  EXPECT_EQ(played.all("state")[1]["undo"], "Undo removal of camera");
}

TEST_F(EditorProgram, EditsAMaterialByItsWidgetAndBakesItWithOneButton) {
  const Played played = play(fmt::format(R"(
open {0}
wait baked 240
tree type:material
)",
                                         path("hello.glb")));
  ASSERT_EQ(played.outcome.exit_code, 0) << told(played.outcome);
  const json& materials = played.answer("tree");
  ASSERT_GT(materials.size(), 0u);
  const std::string name = materials[0]["name"];
  const Played edited = play(fmt::format(R"(
open {0}
wait baked 240
tree ""
select "type:material {1}"
panel Inspector
wait frames 3
set Material.base_color 0.9 0.1 0.1
state
click inspector.rebake
wait baked 240
state
expect /scenes/0/needsRebake []
expect /errors 0
)",
                                         path("hello.glb"), name));
  ASSERT_EQ(edited.outcome.exit_code, 0) << told(edited.outcome);
}

TEST_F(EditorProgram, EditsRoughnessByItsWidgetLiveWhereItCanBe) {
  // The scene has a polished plate and a diffuse one.
  assets::Scene plates;
  plates.materials = {{.name = "polished", .roughness = 0.4f, .metallic = 1.0f},
                      {.name = "matte", .specular = 1.0f}};
  for (int i = 0; i < 2; ++i) {
    plates.meshes.push_back({"plate", assets::plane({-1, 0, 1}, {0.9f, 0, 0}, {0, 0, -2}, 1.0f), i});
    plates.nodes.push_back({.name = "plate", .mesh = i, .translation = {static_cast<float>(i), 0, 0}});
  }
  ASSERT_TRUE(assets::writeGlb(folder / "plates.glb", plates));
  const Played played = play(fmt::format(R"(
open {0}
wait baked 240
panel Inspector
select "type:material polished"
wait frames 3
drag inspector.Material.roughness 40 0
get Material.roughness
state
undo
get Material.roughness
redo
select "type:material matte"
wait frames 3
drag inspector.Material.roughness -40 0
get Material.roughness
state
undo
state
redo
click inspector.rebake
wait baked 240
state
expect /scenes/0/needsRebake []
expect /errors 0
)",
                                         path("plates.glb")));
  ASSERT_EQ(played.outcome.exit_code, 0) << told(played.outcome);
  const std::vector<json> roughness = played.all("get Material"), states = played.all("state");
  ASSERT_EQ(roughness.size(), 3u);
  ASSERT_EQ(states.size(), 4u);
  EXPECT_GT(roughness[0].get<double>(), 0.41);
  EXPECT_NEAR(roughness[1].get<double>(), 0.4, 1e-6) << "one step of undo for the whole drag";
  EXPECT_EQ(states[0]["scenes"][0]["needsRebake"], json::array()) << "polished surfaces show it at once";
  EXPECT_LT(roughness[2].get<double>(), 0.99);
  ASSERT_EQ(states[1]["scenes"][0]["needsRebake"].size(), 1u) << states[1].dump();
  EXPECT_NE(states[1]["scenes"][0]["needsRebake"][0].get<std::string>().find("baked as a diffuse surface"),
            std::string::npos);
  EXPECT_EQ(states[2]["scenes"][0]["needsRebake"], json::array());
}

TEST_F(EditorProgram, ChoosesAQualityAndMeasuresWhatEachCosts) {
  size = "1000x700";
  const Played played = play(fmt::format(R"(
open {0}
lights constant:0.3,0.3,0.3 sun:35,45,0.5,20000
wait loaded 60
wait rest 60
left-panels
bottom-panels
panel Settings
wait frames 3
click quality
wait frames 3
click quality.low
wait frames 3
state
undo
wait frames 3
state
quality high
quality default
wait frames 3
state
setting key-samples 17
wait frames 3
state
click quality.measure
wait measured 240
quality-costs
try quality best
)",
                                         path("hello.glb")),
                             {"--no-bake"});
  ASSERT_EQ(played.outcome.exit_code, 0) << told(played.outcome);
  const std::vector<json> states = played.all("state");
  ASSERT_EQ(states.size(), 4u);
  EXPECT_EQ(states[0]["settings"]["keys"], "4");
  EXPECT_EQ(states[0]["settings"]["key-size"], "2048");
  EXPECT_EQ(states[0]["undo"], "Undo quality low");
  EXPECT_EQ(states[1]["settings"]["keys"], "auto") << "one step";
  EXPECT_EQ(states[2]["settings"], states[1]["settings"]) << "nothing of high is left";
  EXPECT_EQ(states[3]["settings"]["key-samples"], "17");
  const json& costs = played.answer("quality-costs");
  ASSERT_EQ(costs["qualities"].size(), 3u) << costs.dump();
  const json &low = costs["qualities"][0], &high = costs["qualities"][2];
  EXPECT_EQ(low["quality"], "low");
  EXPECT_EQ(high["quality"], "high");
  EXPECT_EQ(high["error"], 0.0);
  EXPECT_GT(low["error"].get<double>(), 0.0);
  EXPECT_LT(low["error"].get<double>(), 0.1) << "the same light, more coarsely";
  EXPECT_GT(low["keyShadowsMs"].get<double>(), 0.0);
  EXPECT_LT(low["keyShadowsMs"].get<double>(), high["keyShadowsMs"].get<double>());
  std::size_t failed = 0;
  for (const json& line : played.answers) failed += line["ok"] == false;
  EXPECT_EQ(failed, 1u);
}

TEST_F(EditorProgram, OpensAndClosesScenesAsStepsThatKeepEdits) {
  const Played played = play(fmt::format(R"(
open {0}
wait loaded 60
state
expect /modified false
select "has:Transform sphere"
set Transform.translation 0.1 0.6 0.2
state
expect /modified true
close
wait frames 3
state
expect /scenes []
undo
wait loaded 60
get Transform.translation
expect /1 0.6
undo
get Transform.translation
expect /1 0.3
undo
wait frames 3
state
expect /scenes []
redo
wait loaded 60
redo
get Transform.translation
expect /1 0.6
state
expect /redo "Redo closing of hello"
expect /errors 0
)",
                                         path("hello.glb")),
                             {"--no-bake"});
  ASSERT_EQ(played.outcome.exit_code, 0) << told(played.outcome);
}

// The reference's lights must be as strong, and as rotated and placed, as the runtime's.
TEST_F(EditorProgram, HoldsItsPictureAgainstTheReference) {
  std::filesystem::copy(path("hello.glb"), path("again.glb"));
  size = "600x400";
  const Played played =
      play(fmt::format(R"(
lights {2}
open {0}
open {1}
wait baked 240
set environment:Environment.intensity 2
set environment:Environment.rotation 100
select again
set Transform.translation 2.2 0.1 0
frame-all
left-panels
right-panels
bottom-panels
setting window off
reference-samples 16
reference-bands 5
split
wait rest 60
wait reference 240
wait frames 5
reference
heat
heat
)",
                       path("hello.glb"), path("again.glb"), LAMBENT_BINARY_DIR "/assets/studio.hdr"));
  ASSERT_EQ(played.outcome.exit_code, 0) << told(played.outcome);
  const json& figures = played.answer("reference");
  ASSERT_TRUE(figures.contains("relativeRms")) << figures.dump();
  // Draft bakes of small scenes against 16 samples a pixel (2.6 % and 0.4 %): light of another strength, turn
  // or colour would be off by far more, a scene that is missing or elsewhere by everything.
  EXPECT_LT(figures["relativeRms"].get<double>(), 0.05);
  for (const json& bias : figures["bias"]) EXPECT_NEAR(bias.get<double>(), 0.0, 0.02);
  EXPECT_GT(figures["pixels"].get<int>(), 1000);
}

TEST_F(EditorProgram, AnswersBadInputWithOneLineAndGoesOn) {
  testing::writeBytes(folder / "broken.glb", "glTF but not really");
  const Played played = play(fmt::format(R"(
try open {0}
try open {1}
try set Nothing.at_all 1
try select nobody
try view no-such-view
try add-light sun:1
try unheard-of
drop {1}
wait frames 5
state
log
)",
                                         path("missing.glb"), path("broken.glb")));
  ASSERT_EQ(played.outcome.exit_code, 0) << told(played.outcome);
  const auto failed = [&](const std::string& command) {
    return std::ranges::any_of(played.answers, [&](const json& line) {
      return line["command"].get<std::string>().starts_with(command) && line["ok"] == false;
    });
  };
  for (const std::string& command :
       {"open " + path("missing.glb"), std::string("set Nothing.at_all"), std::string("select nobody"),
        std::string("view no-such-view"), std::string("add-light sun:1"), std::string("unheard-of")})
    EXPECT_TRUE(failed(command)) << command << '\n' << played.outcome.out;
  // A scene is read while others are shown already: what is wrong with it comes into the log.
  EXPECT_NE(played.answer("log").dump().find("broken.glb"), std::string::npos) << played.outcome.out;
}

TEST_F(EditorProgram, EndsAFailedScriptWithItsLineAndExitCodeOne) {
  const Played played = play("undo\n");
  EXPECT_EQ(played.outcome.exit_code, 1) << told(played.outcome);
  EXPECT_NE(played.outcome.err.find("test.script:1"), std::string::npos) << told(played.outcome);
}

}  // namespace
}  // namespace lambent
