// Tests baking in the editor's window: options, edits that need a rebake, and what is said of them.
#include <algorithm>

#include "assets/glb.hpp"
#include "assets/shapes.hpp"
#include "baker/bake/options.hpp"
#include "tests/editor/program/editor_program.hpp"

namespace lambent {
namespace {

TEST_F(EditorProgram, BakesTheScenesOfAWorldWithTheOptionsThatItWasSavedWith) {
  const Played first =
      play(fmt::format("open {0}\nbake-option rays 300\nbake-option bounces 1\nbake\nwait baked 240\n"
                       "save {1}\nstate\n",
                       path("hello.glb"), path("world.json")));
  const Played second = play(fmt::format("open {}\nwait baked 240\nstate\n", path("world.json")));
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
  const std::string marks = played.answer("marks").dump();
  for (const baker::OptionRow& row : baker::optionRows())
    EXPECT_NE(marks.find(fmt::format("\"bake-option.{}\"", row.name)), std::string::npos) << row.name;
  const json& options = played.answer("state")["scenes"][0]["bakeOptions"];
  EXPECT_EQ(options["volumeGrid"], "16x8x4");
  EXPECT_EQ(options["neighborhoodGrid"], "12x12x12");
  EXPECT_EQ(options["fit"], "on");
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

TEST_F(EditorProgram, EditsAMaterialByItsWidgetAndBakesItWithOneButton) {
  const Played played = play(fmt::format(R"(
open {0}
wait baked 240
tree type:material
)",
                                         path("hello.glb")));
  const json& materials = played.answer("tree");
  ASSERT_GT(materials.size(), 0u);
  const std::string name = materials[0]["name"];
  play(fmt::format(R"(
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

}  // namespace
}  // namespace lambent
