// Tests the editor as a user sees it, driven by scripts through the same widgets, under Xvfb.
#include <algorithm>
#include <cmath>

#include "tests/editor/program/editor_program.hpp"

namespace lambent {
namespace {

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
  EXPECT_TRUE(std::filesystem::exists(folder / "hello.lmb.glb"));
  EXPECT_GT(std::filesystem::file_size(folder / "shot.png"), 20000u);
  EXPECT_TRUE(first.answer("state")["undo"].get<std::string>().find("move") != std::string::npos)
      << first.answer("state").dump();

  const Played second =
      play(fmt::format("open {}\nwait loaded\nselect \"sphere 2\"\nget Transform.translation\n"
                       "get Light.radius\nstate\n",
                       path("world.json")));
  // The handle was dragged up by a noticeable distance.
  EXPECT_GT(second.answer("get Transform")[1].get<double>(), 1.55);
  EXPECT_NEAR(second.answer("get Light.radius").get<double>(), 0.2, 1e-6);
  EXPECT_EQ(second.answer("state")["scenes"][0]["bake"]["upToDate"], true);
}

TEST_F(EditorProgram, ReachesEachOfSeveralMarksWithOneName) {
  const Played played =
      play(fmt::format("open {}\nwait loaded\ncreate-sphere 1 2 0\nrename lamp\ncreate-sphere -1 2 0\n"
                       "rename lamp\nwait frames 3\nmarks\nclick scene.lamp\nget Transform.translation\n"
                       "click scene.lamp#2\nget Transform.translation\n",
                       path("hello.glb")),
           {"--no-bake"});
  const auto places = played.all("get Transform.translation");
  ASSERT_EQ(places.size(), 2u);
  EXPECT_NEAR(std::abs(places[0][0].get<double>()), 1.0, 1e-6);
  EXPECT_NEAR(places[0][0].get<double>(), -places[1][0].get<double>(), 1e-6) << "not the same twice";
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
  const std::vector<json> names = played.all("get Name.name");
  EXPECT_EQ(names, (std::vector<json>{"lamp", "empty", "lamp", "empty"}));
  EXPECT_EQ(played.answer("state")["undo"], "Undo creation of empty");
  EXPECT_EQ(played.answer("state")["redo"], "Redo Name of empty");
}

TEST_F(EditorProgram, ChoosesAUnitAndRunsACommandOfTheMenuOfATreeRow) {
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
create-camera
wait frames 3
state
right-click scene.camera
wait frames 3
click context.delete
wait frames 3
state
)");
  const std::string marks = played.answer("marks").dump();
  EXPECT_NE(marks.find("inspector.Light.range"), std::string::npos);
  EXPECT_EQ(marks.find("inspector.Light.radius"), std::string::npos) << "a point has none";
  EXPECT_EQ(played.answer("get Light.strength"), 10.0) << "a unit changes no light";
  EXPECT_EQ(played.all("state")[0]["selected"], json::array({"camera"}));
  EXPECT_EQ(played.all("state")[1]["undo"], "Undo removal of camera");
}

TEST_F(EditorProgram, ChoosesAQualityAsOneStep) {
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
try quality best
)",
                                         path("hello.glb")),
                             {"--no-bake"});
  const std::vector<json> states = played.all("state");
  ASSERT_EQ(states.size(), 4u);
  EXPECT_EQ(states[0]["settings"]["keys"], "4");
  EXPECT_EQ(states[0]["settings"]["key-size"], "2048");
  EXPECT_EQ(states[0]["undo"], "Undo quality low");
  EXPECT_EQ(states[1]["settings"]["keys"], "auto") << "one step";
  EXPECT_EQ(states[2]["settings"], states[1]["settings"]) << "nothing of high is left";
  EXPECT_EQ(states[3]["settings"]["key-samples"], "17");
  std::size_t failed = 0;
  for (const json& line : played.answers) failed += line["ok"] == false;
  EXPECT_EQ(failed, 1u);
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
  fails = true;
  const Played played = play("undo\n");
  EXPECT_NE(played.outcome.err.find("test.script:1"), std::string::npos) << told(played.outcome);
}

}  // namespace
}  // namespace lambent
