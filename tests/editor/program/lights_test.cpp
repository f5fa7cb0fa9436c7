// Tests lights in the editor's window: new ones, and key lights of environment maps.
#include <algorithm>

#include "tests/editor/program/editor_program.hpp"

namespace lambent {
namespace {

// With automatic exposure, a light that is seen makes the meter go down.
TEST_F(EditorProgram, ShowsANewLightOfEachKindAtOnce) {
  std::string script = fmt::format("open {}\nwait loaded 60\nwait rest 60\nstate\n", path("hello.glb"));
  for (const char* kind : {"point", "spot", "directional", "sphere", "disc"})
    script += fmt::format("create-{}\nwait rest 60\nstate\nundo\nwait rest 60\n", kind);
  const Played played = play(script, {"--no-bake"});
  const std::vector<json> states = played.all("state");
  ASSERT_EQ(states.size(), 6u);
  const double before = states[0]["exposureEv"];
  for (std::size_t i = 1; i < states.size(); ++i)
    EXPECT_LT(states[i]["exposureEv"].get<double>(), before - 0.1) << states[i]["selected"].dump();
}

// The studio's soft boxes are found as key lights in its image, and each of their discs can be moved and
// dimmed.
TEST_F(EditorProgram, MovesDimsAndResetsAKeyLightOfAnEnvironmentMap) {
  constexpr std::string_view script = R"(
open {0}
lights {2}
wait baked 240
set environment:Environment.rotation 10
wait frames 5
keys
move-key 0 35 25
keys
move-key 0 120 10
keys
state
undo
keys
redo
dim-key 0 0.5 0.25 1
keys
save {1}
reset-key 0
keys
undo
keys
try dim-key 0 -1
try dim-key 99 1
try move-key 0 0 91
try move-key x 0 0
add-light sun:10,40,0.5,20000
wait frames 3
keys
lights sun:35,45,0.5,20000
wait frames 3
keys
undo
wait frames 3
keys
expect /1/edited true
)";
  const Played played = play(
      fmt::format(script, path("hello.glb"), path("world.json"), LAMBENT_BINARY_DIR "/assets/studio.hdr"));
  const std::vector<json> keys = played.all("keys");
  ASSERT_EQ(keys.size(), 10u);
  ASSERT_GE(keys[0].size(), 2u) << "soft boxes";
  double share = 0.0;
  for (const json& key : keys[0]) {
    share += key["share"].get<double>();
    EXPECT_EQ(key["source"], "studio.hdr");
    EXPECT_EQ(key["edited"], false);
  }
  EXPECT_GT(share, 0.2);
  EXPECT_LT(share, 1.0);
  // The command takes angles in world space, which the environment's rotation does not change.
  EXPECT_NEAR(keys[1][0]["azimuth"].get<double>(), 35.0, 0.01);
  EXPECT_NEAR(keys[1][0]["elevation"].get<double>(), 25.0, 0.01);
  EXPECT_NEAR(keys[1][0]["share"].get<double>(), keys[0][0]["share"].get<double>(), 1e-3)
      << "as strong as before";
  EXPECT_EQ(keys[1][1], keys[0][1]) << "the others stay";
  EXPECT_NEAR(keys[2][0]["azimuth"].get<double>(), 120.0, 0.01);
  EXPECT_NEAR(keys[2][0]["elevation"].get<double>(), 10.0, 0.01);
  EXPECT_EQ(played.answer("state")["undo"], "Undo turn of key light");
  EXPECT_EQ(keys[3], keys[1]);
  // The factors of the channels are 1/2, 1/4 and 1.
  for (std::size_t channel = 0; const double factor : {0.5, 0.25, 1.0}) {
    const auto before = keys[0][0]["radiance"][channel].get<double>();
    EXPECT_NEAR(keys[4][0]["radiance"][channel++].get<double>(), factor * before, 1e-3 * before);
  }
  EXPECT_EQ(keys[5], keys[0]) << "as found";
  EXPECT_EQ(keys[6], keys[4]);
  std::size_t failed = 0;
  for (const json& line : played.answers) failed += line["ok"] == false;
  EXPECT_EQ(failed, 4u);
  // Another light beside keeps the edit; other lights have none.
  std::size_t edited = 0;
  for (const json& key : keys[7]) edited += key["edited"] == true;
  EXPECT_EQ(edited, 1u) << keys[7].dump();
  ASSERT_EQ(keys[8].size(), 1u);
  EXPECT_EQ(keys[8][0]["source"], "sun 0");
  EXPECT_EQ(keys[8][0]["edited"], false);

  const Played again =
      play(fmt::format("open {}\nwait loaded 60\nwait frames 5\nkeys\n", path("world.json")));
  const json& read = again.answer("keys")[0];
  EXPECT_EQ(read["edited"], true);
  EXPECT_NEAR(read["azimuth"].get<double>(), keys[4][0]["azimuth"].get<double>(), 2e-3);
  EXPECT_EQ(read["factor"], keys[4][0]["factor"]);
}

TEST_F(EditorProgram, EditsKeyLightsByTheTableOfThePanel) {
  const Played played = play(fmt::format(R"(
open {0}
lights {1} sun:120,40,0.5,60000
wait loaded 60
panel Environment
wait frames 5
keys
click key.1
wait frames 3
drag key.1.elevation 40 0
keys
drag key.1.strength -30 0
keys
undo
undo
keys
)",
                                         path("hello.glb"), LAMBENT_BINARY_DIR "/assets/sky.hdr"),
                             {"--no-bake"});
  const std::vector<json> keys = played.all("keys");
  ASSERT_EQ(keys.size(), 4u);
  ASSERT_EQ(keys[0].size(), 2u) << keys[0].dump();
  EXPECT_EQ(keys[0][0]["source"], "sun 1");
  EXPECT_EQ(keys[0][1]["source"], "sky.hdr");
  EXPECT_GT(keys[1][1]["elevation"].get<double>(), keys[0][1]["elevation"].get<double>() + 2.0);
  EXPECT_LT(keys[2][1]["radiance"][0].get<double>(), 0.95 * keys[1][1]["radiance"][0].get<double>());
  EXPECT_EQ(keys[2][1]["elevation"], keys[1][1]["elevation"]);
  EXPECT_EQ(keys[3], keys[0]) << "each drag is one step";
}

// The reference traces the edited light, too. Without its disc, or with the old one in addition, the error
// would be the key light's share of 40 %.
TEST_F(EditorProgram, HoldsAMovedKeyLightAgainstTheReference) {
  size = "600x400";
  const Played played = play(fmt::format(R"(
lights {1}
open {0}
wait baked 240
left-panels
right-panels
bottom-panels
move-key 0 120 30
dim-key 0 1 0.6 0.3
reference-samples 16
split
wait rest 60
wait reference 240
wait frames 5
reference
keys
)",
                                         path("hello.glb"), LAMBENT_BINARY_DIR "/assets/sky.hdr"));
  ASSERT_EQ(played.answer("keys").size(), 1u);
  EXPECT_GT(played.answer("keys")[0]["share"].get<double>(), 0.2);
  const json& figures = played.answer("reference");
  ASSERT_TRUE(figures.contains("relativeRms")) << figures.dump();
  // The error is 1.5 % at 32 samples per pixel, and 1.1 % without the edit of the key light.
  EXPECT_LT(figures["relativeRms"].get<double>(), 0.04);
  for (const json& bias : figures["bias"]) EXPECT_NEAR(bias.get<double>(), 0.0, 0.02);
}

}  // namespace
}  // namespace lambent
