// Tests panels in a Dear ImGui context without window and OpenGL, whose only input comes from the test.
#include <imgui.h>

#include "editor/panels/panel.hpp"
#include "tests/editor/program/windowless.hpp"

namespace lambent::editor {
namespace {

class WindowlessPanels : public testing::Windowless {
 protected:
  void SetUp() override {
    Windowless::SetUp();
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.DisplaySize = ImVec2(800.0f, 600.0f);
    unsigned char* pixels = nullptr;
    int width = 0, height = 0;
    io.Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
  }
  void TearDown() override { ImGui::DestroyContext(); }

  void draw(const Panel& panel) {
    marks.beginFrame();
    ImGui::GetIO().DeltaTime = 0.02f;
    ImGui::NewFrame();
    ImGui::SetNextWindowPos(ImVec2(0.0f, 0.0f));
    ImGui::SetNextWindowSize(ImGui::GetIO().DisplaySize);
    ImGui::Begin(panel.name, nullptr, ImGuiWindowFlags_NoMove);
    panel.draw(*session, marks);
    ImGui::End();
    ImGui::EndFrame();
  }
  // Draws until the marks are those of a complete frame.
  void settle(const Panel& panel) {
    for (int i = 0; i < 3; ++i) draw(panel);
  }
  void click(const Panel& panel, const std::string& mark) {
    const auto where = marks.find(mark);
    ASSERT_TRUE(where) << mark << " is not in the panel";
    ImGuiIO& io = ImGui::GetIO();
    io.MousePos = ImVec2(where->center().x, where->center().y);
    for (const bool down : {false, true, true, false, false}) {
      io.MouseDown[0] = down;
      draw(panel);
    }
  }
  const Panel& panel(std::string_view name) const {
    for (const Panel& row : panelList())
      if (name == row.name) return row;
    ADD_FAILURE() << "no panel " << name;
    return panelList().front();
  }

  Marks marks;
};

TEST_F(WindowlessPanels, AllOfThemDrawASceneThatIsOpen) {
  openHello();
  answer("select", {"sphere"});
  for (const Panel& row : panelList()) {
    settle(row);
    EXPECT_FALSE(row.name != std::string("Plan") && marks.names().empty()) << row.name;
  }
  EXPECT_EQ(session->log.errors(), 0u);
}

TEST_F(WindowlessPanels, AClickInTheTreeSelects) {
  answer("create-point");
  answer("create-camera");
  const Panel& tree = panel("Scene");
  settle(tree);
  click(tree, "scene.point");
  EXPECT_EQ(answer("state")["selected"], nlohmann::json::array({"point"}));
}

TEST_F(WindowlessPanels, AButtonOfTheEnvironmentAddsASunAsOneStep) {
  const Panel& environment = panel("Environment");
  settle(environment);
  click(environment, "environment.add-sun");
  EXPECT_EQ(session->document.world().lights.size(), 2u);
  EXPECT_EQ(session->history.stepNames().size(), 1u);
  answer("undo");
  EXPECT_EQ(session->document.world().lights.size(), 1u);
}

}  // namespace
}  // namespace lambent::editor
