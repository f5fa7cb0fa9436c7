// Tests what a user's hands do in the editor's window: numbers that are dragged and typed, handles, layouts.
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/editor/program/editor_program.hpp"

namespace lambent {
namespace {

using nlohmann::json;
using testing::EditorProgram;
using testing::Played;
using testing::told;

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
type 2*3
key Enter
get a:Transform.translation
get b:Transform.translation
click inspector.Transform.translation.y
type "+=1"
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
  ASSERT_EQ(played.outcome.exit_code, 0) << told(played.outcome);
  const std::vector<json> a = played.all("get a:Transform"), b = played.all("get b:Transform");
  ASSERT_EQ(a.size(), 4u);
  EXPECT_NEAR(a[0][1].get<double>(), 1.4, 1e-4);
  EXPECT_NEAR(b[0][1].get<double>(), 3.4, 1e-4) << "shifted by the same";
  EXPECT_GT(played.answer("get a:Light").get<double>(), 10.5);
  EXPECT_NEAR(played.answer("get a:Light").get<double>(), 10.0 * played.answer("get b:Light").get<double>(),
              1e-3)
      << "lights keep their ratio";
  EXPECT_EQ(a[1][0], 6.0);
  EXPECT_EQ(b[1][0], 6.0) << "what is typed sets all";
  EXPECT_EQ(b[1][1], b[0][1]) << "and leaves the other numbers as they differ";
  EXPECT_NEAR(b[2][1].get<double>(), 4.4, 1e-4) << "a sum is added to each";
  EXPECT_EQ(a[3], a[1]) << "one step";
  EXPECT_EQ(b[3], b[1]);
  const std::string marks = played.answer("marks").dump();
  EXPECT_NE(marks.find("inspector.Transform.translation"), std::string::npos);
  EXPECT_EQ(marks.find("inspector.Light"), std::string::npos) << "not all have a light";
}

TEST_F(EditorProgram, DragsNumbersAndHandlesFinerAndInSteps) {
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
drag inspector.Transform.translation.x 30 0 Ctrl
get Transform.translation
set Transform.translation 0 0 0
drag gizmo.y 0 -60
get Transform.translation
undo
drag gizmo.y 0 -60 Shift
get Transform.translation
undo
drag gizmo.y 0 -60 Ctrl
get Transform.translation
)");
  ASSERT_EQ(played.outcome.exit_code, 0) << told(played.outcome);
  const std::vector<json> places = played.all("get");
  ASSERT_EQ(places.size(), 7u);
  const auto x = [&](std::size_t i) { return places[i][0].get<double>(); };
  const auto y = [&](std::size_t i) { return places[i][1].get<double>(); };
  EXPECT_NEAR(x(0), 1.1, 1e-4);
  EXPECT_NEAR(x(1) - x(0), 0.1, 1e-4);
  EXPECT_NEAR(x(2) - x(1), 3.0, 1e-4);
  EXPECT_EQ(x(3), 4.5) << "a multiple of the step of 0.25 m";
  EXPECT_NEAR(y(5), 0.1 * y(4), 0.02 * y(4));
  EXPECT_NEAR(4.0 * y(6), std::round(4.0 * y(6)), 1e-4);
  EXPECT_NEAR(y(6), y(4), 0.126);
}

}  // namespace
}  // namespace lambent
