// Drives the Assets panel in the editor's window.
#include <fstream>

#include "runtime/spec/image.hpp"
#include "tests/editor/program/editor_program.hpp"

namespace lambent::testing {
namespace {

constexpr const char* kScript = R"(
open "{0}"
wait loaded 60
wait rest 60
panel Assets
wait frames 5
click assets.search
type "evening map"
assets
double-click assets.evening.hdr
wait frames 5
state
undo
state
drag assets.evening.hdr to viewport
wait frames 5
state
undo
click assets.search
key Ctrl+A
type "second"
wait frames 3
key Enter
wait loaded 60
state
undo
state
)";

TEST_F(EditorProgram, UsesAMapAndOpensASceneOfTheAssetsAsSteps) {
  const spec::RgbImage map{16, 8, std::vector<glm::vec3>(128, glm::vec3(1.0f, 0.8f, 0.6f))};
  ASSERT_TRUE(spec::writeHdr(folder / "evening.hdr", map));
  std::filesystem::copy(folder / "hello.glb", folder / "second.glb");
  const Played played =
      play(fmt::format(kScript, path("hello.glb")), {"--no-bake", "--light", "constant:0.5,0.5,0.5"});
  const json& listed = played.answer("assets");
  ASSERT_EQ(listed.size(), 1u) << listed;
  EXPECT_EQ(listed[0]["kind"], "environment map");
  const std::vector<json> states = played.all("state");
  ASSERT_EQ(states.size(), 5u);
  const json map_alone = json::array({path("evening.hdr")}), before = json::array({"constant:0.5,0.5,0.5"});
  EXPECT_EQ(states[0]["lights"], map_alone) << "a double click";
  EXPECT_EQ(states[1]["lights"], before) << "one step";
  EXPECT_EQ(states[2]["lights"], map_alone) << "a drag into the view";
  EXPECT_EQ(states[3]["scenes"].size(), 2u) << "Enter uses the first that is found";
  EXPECT_EQ(states[4]["scenes"].size(), 1u);
}

}  // namespace
}  // namespace lambent::testing
