// The editor as a user meets it, driven by scripts through the same widgets, under Xvfb.
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.hpp"

namespace lambent {
namespace {

using nlohmann::json;
using testing::Outcome;

struct Played {
  Outcome outcome;
  std::vector<json> answers;  // a line each

  // Of the last line with this command.
  const json& answer(const std::string& command) const {
    for (auto line = answers.rbegin(); line != answers.rend(); ++line)
      if ((*line)["command"].get<std::string>().starts_with(command)) return (*line)["answer"];
    static const json kNone;
    return kNone;
  }
};

class EditorProgram : public testing::ProgramTest {
 protected:
  void SetUp() override {
    ProgramTest::SetUp();
    ::setenv("XDG_CONFIG_HOME", (folder / "config").c_str(), 1);
    const bool display = std::getenv("DISPLAY") && *std::getenv("DISPLAY");
    if (!display && std::string(LAMBENT_XVFB_RUN).empty())
      GTEST_SKIP() << "there is no display and no xvfb-run (Debian: xvfb)";
    std::filesystem::copy(LAMBENT_BINARY_DIR "/assets/hello.glb", folder / "hello.glb");
  }

  Played play(const std::string& script, std::vector<std::string> arguments = {}) {
    testing::writeBytes(folder / "test.script", script);
    std::vector<std::string> words = {"--script",
                                      (folder / "test.script").string(),
                                      "--json",
                                      "--cache",
                                      (folder / "cache").string(),
                                      "--size",
                                      "1280x800",
                                      "--quality",
                                      "draft"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::filesystem::path program = LAMBENT_EDITOR;
    if (!std::string(LAMBENT_XVFB_RUN).empty()) {
      words.insert(words.begin(), {"-a", "-s", "-screen 0 1600x1000x24", LAMBENT_EDITOR});
      program = LAMBENT_XVFB_RUN;
    }
    Played played{run(program, words), {}};
    std::istringstream lines(played.outcome.out);
    for (std::string line; std::getline(lines, line);)
      if (line.starts_with('{')) played.answers.push_back(json::parse(line));
    return played;
  }
  std::string path(const char* name) const { return (folder / name).string(); }
};

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
  ASSERT_EQ(first.outcome.exit_code, 0) << first.outcome.err << first.outcome.out;
  EXPECT_TRUE(std::filesystem::exists(folder / "hello.lmb.glb"));
  EXPECT_GT(std::filesystem::file_size(folder / "shot.png"), 20000u);
  EXPECT_TRUE(first.answer("state")["undo"].get<std::string>().find("move") != std::string::npos)
      << first.answer("state").dump();

  const Played second =
      play(fmt::format("open {}\nwait loaded\nselect \"sphere 2\"\nget Transform.translation\n"
                       "get Light.radius\nstate\n",
                       path("world.json")));
  ASSERT_EQ(second.outcome.exit_code, 0) << second.outcome.err << second.outcome.out;
  // Dragged up, by more than a trifle.
  EXPECT_GT(second.answer("get Transform")[1].get<double>(), 1.55);
  EXPECT_NEAR(second.answer("get Light.radius").get<double>(), 0.2, 1e-6);
  EXPECT_EQ(second.answer("state")["scenes"][0]["bake"]["upToDate"], true);
}

TEST_F(EditorProgram, TakesADroppedSceneAndShowsItBeforeItIsBaked) {
  const Played played =
      play(fmt::format("drop {0}\nwait frames 3\nwait loaded 60\nstate\nwait baked 240\nstate\n"
                       "tree type:light\nplan\nwait seconds 2\nplan\n",
                       path("hello.glb")));
  ASSERT_EQ(played.outcome.exit_code, 0) << played.outcome.err << played.outcome.out;
  EXPECT_EQ(played.answer("state")["scenes"][0]["bake"]["reached"], "final");
  EXPECT_EQ(played.answer("state")["errors"], 0);
  EXPECT_EQ(played.answer("plan")["ready"], true);
}

TEST_F(EditorProgram, EditsAMaterialByItsWidgetAndBakesItWithOneButton) {
  const Played played = play(fmt::format(R"(
open {0}
wait baked 240
tree type:material
)",
                                         path("hello.glb")));
  ASSERT_EQ(played.outcome.exit_code, 0) << played.outcome.err << played.outcome.out;
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
  ASSERT_EQ(edited.outcome.exit_code, 0) << edited.outcome.err << edited.outcome.out;
}

TEST_F(EditorProgram, HoldsItsPictureAgainstTheReference) {
  const Played played = play(fmt::format(R"(
lights constant:0.4,0.5,0.6
open {0}
wait baked 240
bottom-panels
reference-samples 32
reference-bands 5
split
wait rest 60
wait reference 240
wait frames 5
reference
heat
heat
)",
                                         path("hello.glb")));
  ASSERT_EQ(played.outcome.exit_code, 0) << played.outcome.err << played.outcome.out;
  const json& figures = played.answer("reference");
  ASSERT_TRUE(figures.contains("relativeRms")) << figures.dump();
  // A draft bake of a small scene against 32 samples a pixel: whether both show the same thing.
  EXPECT_LT(figures["relativeRms"].get<double>(), 0.1);
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
  ASSERT_EQ(played.outcome.exit_code, 0) << played.outcome.err << played.outcome.out;
  std::size_t failed = 0;
  for (const json& line : played.answers) failed += line["ok"] == false;
  EXPECT_GE(failed, 6u) << played.outcome.out;
}

TEST_F(EditorProgram, EndsAFailedScriptWithItsLineAndExitCodeOne) {
  const Played played = play("undo\n");
  EXPECT_EQ(played.outcome.exit_code, 1);
  EXPECT_NE(played.outcome.err.find("test.script:1"), std::string::npos) << played.outcome.err;
}

}  // namespace
}  // namespace lambent
