// Tests opening, dropping and closing scenes and worlds in the editor's window.
#include "tests/editor/program/editor_program.hpp"

namespace lambent {
namespace {

TEST_F(EditorProgram, TakesADroppedSceneAndShowsItBeforeItIsBaked) {
  const Played played =
      play(fmt::format("drop {0}\nwait frames 3\nwait loaded 60\nstate\nwait baked 240\nstate\n"
                       "tree type:light\n",
                       path("hello.glb")));
  EXPECT_EQ(played.answer("state")["scenes"][0]["bake"]["reached"], "final");
  EXPECT_EQ(played.answer("state")["errors"], 0);
}

TEST_F(EditorProgram, AsksBeforeItClosesASceneWithEdits) {
  play(fmt::format(R"(
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
click dialog.no
get Transform.translation
expect /1 0.6
undo
get Transform.translation
expect /1 0.3
close
wait frames 3
state
expect /scenes []
expect /errors 0
)",
                   path("hello.glb")),
       {"--no-bake"});
}

// Each way to another world must ask, and leave everything as it is if the answer is no.
TEST_F(EditorProgram, AsksBeforeAWorldTakesThePlaceOfUnsavedEdits) {
  const Played played = play(fmt::format(R"(
wait rest 20
create-empty
save {0}
create-empty
wait frames 3
drop {0}
wait frames 3
where dialog.third
click dialog.no
wait frames 3
click menu.File
click menu.open@0.05,0.5
wait frames 3
click dialog.name
type {0}
key Enter
wait frames 3
where dialog.third
click dialog.no
wait frames 3
click menu.File
click menu.recent@0.05,0.5
click menu.recent.world.json@0.05,0.5
wait frames 3
where dialog.third
click dialog.no
wait frames 3
key Ctrl+N
wait frames 3
where dialog.third
click dialog.no
wait frames 3
key Ctrl+Q
wait frames 3
where dialog.third
click dialog.no
wait frames 3
state
tree empty
open {0}
wait frames 3
click dialog.third
wait frames 3
state
tree empty
new
wait rest 20
lights constant:0.3,0.3,0.3
wait frames 3
click start.world.json
wait frames 3
where dialog.third
click dialog.yes
wait frames 3
state
tree empty
)",
                                         path("world.json")));
  EXPECT_EQ(played.all("where").size(), 6u);
  const std::vector<json> states = played.all("state"), trees = played.all("tree");
  ASSERT_EQ(states.size(), 3u);
  EXPECT_EQ(states[0]["modified"], true);
  EXPECT_EQ(trees[0].size(), 2u) << "five times no";
  EXPECT_EQ(states[1]["modified"], false) << "it was saved first";
  EXPECT_EQ(trees[1].size(), 2u);
  EXPECT_EQ(states[2]["modified"], false);
  EXPECT_EQ(trees[2].size(), 2u);
}

}  // namespace
}  // namespace lambent
