// Tests what a user's hands do in the editor's window: numbers that are dragged and typed, handles, layouts.
#include <cmath>

#include "tests/editor/program/editor_program.hpp"

namespace lambent {
namespace {

constexpr const char* kTwoLamps = R"(
create-sphere 0 1 0
rename a
set Light.strength 10
create-sphere 2 3 0
rename b
set Light.strength 1
select a b
panel Inspector
wait frames 3
)";

TEST_F(EditorProgram, EditsWhatSeveralHaveInCommonAsOneStep) {
  const Played played = play(std::string(kTwoLamps) + R"(
drag inspector.Transform.translation.y 40 0
get a:Transform.translation
get b:Transform.translation
drag inspector.Light.strength 40 0
get a:Light.strength
get b:Light.strength
click inspector.Transform.translation.x
type 6
key Enter
get a:Transform.translation
get b:Transform.translation
state
expect /undo "Undo Position of 2 entities"
undo
get a:Transform.translation
get b:Transform.translation
create-empty
select a empty
wait frames 3
marks
)");
  const std::vector<json> a = played.all("get a:Transform"), b = played.all("get b:Transform");
  ASSERT_EQ(a.size(), 3u);
  EXPECT_NEAR(a[0][1].get<double>(), 1.4, 1e-4);
  EXPECT_NEAR(b[0][1].get<double>(), 3.4, 1e-4) << "shifted by the same";
  EXPECT_GT(played.answer("get a:Light").get<double>(), 10.5);
  EXPECT_NEAR(played.answer("get a:Light").get<double>(), 10.0 * played.answer("get b:Light").get<double>(),
              1e-3)
      << "lights keep their ratio";
  EXPECT_EQ(a[1][0], 6.0);
  EXPECT_EQ(b[1][0], 6.0) << "what is typed sets all";
  EXPECT_EQ(b[1][1], b[0][1]) << "and leaves the other numbers as they differ";
  EXPECT_EQ(a[2], a[0]) << "one step";
  EXPECT_EQ(b[2], b[0]);
  const std::string marks = played.answer("marks").dump();
  EXPECT_NE(marks.find("inspector.Transform.translation"), std::string::npos);
  EXPECT_EQ(marks.find("inspector.Light"), std::string::npos) << "not all have a light";
}

TEST_F(EditorProgram, DragsNumbersAndHandlesFinerAndHandlesInSteps) {
  const Played played = play(R"(
create-empty 0.1 0 0
panel Inspector
wait frames 3
drag inspector.Transform.translation.x 100 0
get Transform.translation
drag inspector.Transform.translation.x 100 0 Shift
get Transform.translation
drag inspector.Transform.translation.x 30 0 Alt
get Transform.translation
set Transform.translation 0 0 0
wait frames 3
drag gizmo.y 0 -60
get Transform.translation
undo
wait frames 3
drag gizmo.y 0 -60 Shift
get Transform.translation
undo
wait frames 3
drag gizmo.y 0 -60 Ctrl
get Transform.translation
)");
  const std::vector<json> places = played.all("get");
  ASSERT_EQ(places.size(), 6u);
  const auto x = [&](std::size_t i) { return places[i][0].get<double>(); };
  const auto y = [&](std::size_t i) { return places[i][1].get<double>(); };
  EXPECT_NEAR(x(0), 1.1, 1e-4);
  EXPECT_NEAR(x(1) - x(0), 0.1, 1e-4);
  EXPECT_NEAR(x(2) - x(1), 3.0, 1e-4);
  EXPECT_NEAR(y(4), 0.1 * y(3), 0.02 * y(3));
  EXPECT_NEAR(4.0 * y(5), std::round(4.0 * y(5)), 1e-4);
  EXPECT_NEAR(y(5), y(3), 0.126);
}

TEST_F(EditorProgram, SlidesTheNumberOfKeyLightsAwayFromAutoAndBack) {
  const Played played = playInHello(R"(
panel Settings
wait frames 3
click setting.keys@0.5,0.5
wait frames 3
state
click setting.keys@0.005,0.5
wait frames 3
state
)");
  const std::vector<json> states = played.all("state");
  ASSERT_EQ(states.size(), 2u);
  EXPECT_NEAR(std::stod(states[0]["settings"]["keys"].get<std::string>()), 16.0, 4.0) << "the middle of 32";
  EXPECT_EQ(states[1]["settings"]["keys"], "auto");
}

TEST_F(EditorProgram, SetsTheHandlesByTheToolBar) {
  const Played played = play(R"(
create-empty
wait frames 3
click tool.turn
click tool.local-axes
click tool.snap
click tool.snap.degrees
type 5
key Enter
wait frames 3
state
)");
  const json& handles = played.answer("state")["handles"];
  EXPECT_EQ(handles["mode"], "turn");
  EXPECT_EQ(handles["local"], true);
  EXPECT_EQ(handles["snap"], true);
  EXPECT_EQ(handles["steps"][1], 5.0);
}

TEST_F(EditorProgram, DividesTheWindowAsItsEdgesAreDragged) {
  for (const char* scale : {"1", "2"}) {
    const Played played = play(R"(
wait frames 3
where viewport
drag edge.right 120 0
drag edge.left -40 0
drag edge.below 0 60
where viewport
drag edge.right -2000 0
drag edge.below 0 -2000
where viewport
layout-default
wait frames 3
where viewport
key F11
wait frames 3
where viewport
key F11
)",
                               {"--scale", scale, "--fresh"});
    const std::vector<json> views = played.all("where");
    ASSERT_EQ(views.size(), 5u);
    const auto extent = [&](std::size_t i, const char* side) { return views[i][side].get<double>(); };
    EXPECT_NEAR(extent(1, "width"), extent(0, "width") + 160.0, 8.0) << "at scale " << scale;
    EXPECT_NEAR(extent(1, "height"), extent(0, "height") + 60.0, 4.0) << "at scale " << scale;
    EXPECT_GT(extent(2, "width"), 100.0) << "the view keeps some room";
    EXPECT_GT(extent(2, "height"), 60.0);
    EXPECT_EQ(views[3], views[0]) << "reset";
    EXPECT_EQ(extent(4, "width"), 1280.0);
    EXPECT_GT(extent(4, "height"), 740.0);
  }
}

TEST_F(EditorProgram, BringsTheLogUpWhereThereIsAnError) {
  const Played played = play(
      fmt::format("panel Bakes\nwait frames 3\ndrop {}\nwait frames 5\nwhere log.clear\n", path("lost.glb")));
  EXPECT_GT(played.answer("where log.clear")["width"], 0.0);
}

// At twice the size in a small window, nothing that is clicked may be covered or out of reach.
TEST_F(EditorProgram, KeepsWhatIsClickedInReachAtTwiceTheSize) {
  const Played played = play(fmt::format(R"(
wait frames 3
where start
where viewport
click menu.Window
wait frames 3
where menu.panels
key Escape
click menu.Window
click menu.panels
click menu.panel.Cost
wait frames 3
panel Bakes
drop {}
wait loaded 60
wait frames 3
where bakes.hello.options
where bakes.hello.close
)",
                                         path("hello.glb")),
                             {"--scale", "2", "--fresh"});
  const auto end = [&](const char* mark, const char* at, const char* extent) {
    const json& area = played.answer(std::string("where ") + mark);
    return area[at].get<double>() + area[extent].get<double>();
  };
  EXPECT_GE(played.answer("where start")["y"], played.answer("where viewport")["y"]) << "below the tool bar";
  EXPECT_LE(end("start", "y", "height"), end("viewport", "y", "height"));
  EXPECT_LE(end("menu.panels", "y", "height"), 800.0) << "the Window menu need not scroll";
  for (const char* button : {"bakes.hello.options", "bakes.hello.close"}) {
    EXPECT_LE(end(button, "x", "width"), end("viewport", "x", "width")) << button;
    EXPECT_LE(end(button, "y", "height"), 800.0) << button;
  }
}

// Counts frames instead of time: a machine under load draws no more of them.
TEST_F(EditorProgram, DrawsNoFrameWhileNothingChanges) {
  const Played played = playInHello(R"(
create-camera 0 1 3
wait rest 60
wait seconds 1
state
wait seconds 1.5
state
set Transform.translation 0 1.2 3
wait rest 60
wait seconds 1
state
wait seconds 1.5
state
)");
  std::vector<int> frames, pictures;
  for (const json& state : played.all("state")) {
    frames.push_back(state["frames"].get<int>());
    pictures.push_back(state["pictures"].get<int>());
  }
  ASSERT_EQ(frames.size(), 4u);
  // Each line of a script is followed by a few frames that show what it did.
  EXPECT_LE(frames[1] - frames[0], 5);
  EXPECT_LE(frames[3] - frames[2], 5);
  EXPECT_EQ(pictures[1], pictures[0]);
  EXPECT_GT(pictures[2], pictures[1]) << "an edit is shown";
  EXPECT_EQ(pictures[3], pictures[2]);
}

TEST_F(EditorProgram, LooksThroughTheSelectedCameraAndPlacesItAtTheView) {
  const Played played = playInHello(R"(
create-camera 0 1 3
key C
wait frames 3
state
camera orbit:120,30,2,40
key Shift+C
get Transform.translation
undo
get Transform.translation
)");
  EXPECT_TRUE(played.answer("state")["eye"].get<std::string>().starts_with("pose:0,1,"))
      << "as high as the camera";
  const std::vector<json> places = played.all("get");
  EXPECT_NE(places[0], places[1]);
  EXPECT_EQ(places[1], (json{0.0, 1.0, 3.0}));
}

}  // namespace
}  // namespace lambent
