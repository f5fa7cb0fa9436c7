// Tests panels in a Dear ImGui context without window and OpenGL, whose only input comes from the test.
#include <chrono>
#include <fstream>

#include <imgui.h>
#include <imgui_internal.h>

#include "editor/panels/panel.hpp"
#include "editor/ui/dear_imgui.hpp"
#include "editor/ui/ui.hpp"
#include "runtime/scene/materials.hpp"
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

  // Draws a frame. Returns the text that the panel shows, parts that are scrolled away left out.
  std::string draw(const Panel& row) {
    marks.beginFrame();
    ImGui::GetIO().DeltaTime = 0.02f;
    ImGui::NewFrame();
    ImGui::SetNextWindowPos(ImVec2(0.0f, 0.0f));
    ImGui::SetNextWindowSize(ImGui::GetIO().DisplaySize);
    ImGui::Begin(row.name, nullptr, ImGuiWindowFlags_NoMove);
    ImGui::LogToBuffer(/*auto_open_depth=*/0);
    row.draw(*session, marks);
    std::string text = ImGui::GetCurrentContext()->LogBuffer.c_str();
    ImGui::LogFinish();
    ImGui::End();
    ImGui::EndFrame();
    return text;
  }
  // Draws until the marks are those of a complete frame.
  void settle(const Panel& panel) {
    for (int i = 0; i < 3; ++i) draw(panel);
  }
  void click(const Panel& panel, const std::string& mark) {
    const auto where = marks.find(mark);
    ASSERT_TRUE(where) << mark << " is not in the panel";
    ScriptedInput input;
    input.pointer = where->center();
    for (const bool down : {false, true, true, false, false}) {
      input.left = down;
      apply(input);
      draw(panel);
    }
  }
  std::string textOf(const Panel& row) {
    settle(row);
    return draw(row);
  }
  const Panel& panel(std::string_view name) const {
    for (const Panel& row : panelList())
      if (name == row.name) return row;
    ADD_FAILURE() << "no panel " << name;
    return panelList().front();
  }
  const Panel& settled(std::string_view name) {
    settle(panel(name));
    return panel(name);
  }

  Marks marks;
};

TEST_F(WindowlessPanels, AllOfThemDrawASceneThatIsOpen) {
  openHello();
  answer("select", {"sphere"});
  for (const Panel& row : panelList()) {
    settle(row);
    EXPECT_FALSE(marks.names().empty()) << row.name;
  }
  EXPECT_EQ(session->log.errors(), 0u);
}

TEST_F(WindowlessPanels, AClickInTheTreeSelects) {
  answer("create-point");
  answer("create-camera");
  const Panel& tree = settled("Scene");
  click(tree, "scene.point");
  EXPECT_EQ(answer("state")["selected"], nlohmann::json::array({"point"}));
}

// A script that clicks at such a mark would click at something else, or at nothing.
TEST_F(WindowlessPanels, MarksOfWhatIsScrolledOutOfViewSaySo) {
  ImGui::GetIO().DisplaySize.y = 160.0f;
  answer("create-point");
  settle(panel("Inspector"));
  ASSERT_TRUE(marks.find("inspector.Transform.translation") && marks.find("inspector.Light.range"));
  EXPECT_TRUE(marks.find("inspector.Transform.translation")->shown);
  EXPECT_FALSE(marks.find("inspector.Light.range")->shown);
}

TEST_F(WindowlessPanels, AnObjectLeadsToItsMaterial) {
  openHello();
  answer("select", {"has:Transform box"});
  const Panel& inspector = settled("Inspector");
  click(inspector, "inspector.material.box");
  settle(inspector);
  EXPECT_TRUE(marks.find("inspector.Material.roughness")) << "it is edited in place";
  click(inspector, "inspector.material.box.select");
  const ecs::Entity primary = session->selection.primaryEntity(session->document);
  EXPECT_TRUE(session->document.registry().has<scene::MaterialComponent>(primary));
  EXPECT_EQ(session->document.nameOf(primary), "box");
}

TEST_F(WindowlessPanels, ZeroHasNoSignAndBrdfsHaveNames) {
  openHello();
  answer("select", {"has:Transform box"});
  answer("set", {"Transform.rotation", "0", "-0.00001", "0", "1"});
  std::string text = textOf(panel("Inspector"));
  EXPECT_EQ(text.find("-0.0"), std::string::npos) << text;
  EXPECT_NE(text.find("0.0"), std::string::npos) << text;
  answer("select", {"type:material box"});
  text = textOf(panel("Inspector"));
  EXPECT_EQ(text.find("-1"), std::string::npos) << text;
  EXPECT_NE(text.find("none"), std::string::npos) << text;
}

TEST_F(WindowlessPanels, FieldsStayWhileAnEditBringsAReasonToRebake) {
  openHello();
  answer("select", {"type:material box"});
  const Panel& inspector = settled("Inspector");
  const auto before = marks.find("inspector.Material.metallic");
  answer("set", {"Material.metallic", "1"});
  settle(inspector);
  ASSERT_TRUE(marks.find("inspector.rebake"));
  const auto after = marks.find("inspector.Material.metallic");
  ASSERT_TRUE(before && after);
  EXPECT_EQ(before->min, after->min);
}

TEST_F(WindowlessPanels, ARotationDoesNotJumpBeyondAQuarterTurn) {
  answer("create-empty");
  const Panel& inspector = panel("Inspector");
  // Euler angles that are made of this rotation anew would be 180, 80, 180.
  const glm::vec3 degrees(0.0f, 100.0f, 0.0f);
  const glm::quat q(glm::radians(degrees));
  session->angles = {{q, degrees}};
  answer("set", {"Transform.rotation", std::to_string(q.x), std::to_string(q.y), std::to_string(q.z),
                 std::to_string(q.w)});
  EXPECT_NE(textOf(inspector).find("100.0"), std::string::npos) << textOf(inspector);
}

// Draws all panels in little room for a large font: a widget may be wrapped or scrolled to, but not cut.
TEST_F(WindowlessPanels, KeepTheirWidgetsWithinNarrowRoomAtALargeFont) {
  openHello();
  answer("create-spot");
  answer("select", {"type:material box"});
  ImGui::GetIO().FontGlobalScale = 2.0f;
  ImGui::GetStyle().ScaleAllSizes(2.0f);
  for (const char* name : {"Scene", "Inspector", "Environment", "Settings", "Log"}) {
    const Panel& row = panel(name);
    const float width = (row.dock == Dock::Left ? 13.0f : 22.0f) * 26.0f;
    ImGui::GetIO().DisplaySize = ImVec2(width, 900.0f);
    settle(row);
    for (const std::string& mark : marks.names()) {
      const auto where = marks.find(mark);
      EXPECT_LE(where->max.x, width + 1.0f) << name << ": " << mark;
      EXPECT_LT(where->min.x, where->max.x) << name << ": " << mark;
    }
  }
}

TEST_F(WindowlessPanels, TheStartPageOpensARecentScene) {
  const std::filesystem::path file = folder.path() / "hello.glb";
  ASSERT_TRUE(assets::writeGlb(file, assets::hello()));
  session->preferences.recent = {"/nowhere/else.glb", file.string()};
  const Panel start{"start", Dock::Left, "", &drawStartPage};
  EXPECT_NE(textOf(start).find("Drop a glTF scene"), std::string::npos);
  settle(start);
  click(start, "start.hello.glb");
  ASSERT_EQ(session->scenes.entries().size(), 1u);
  EXPECT_EQ(session->scenes.entries().front().source, file);
}

TEST_F(WindowlessPanels, TheStartPageGoesOnceALampIsInTheWorld) {
  const Panel start{"start", Dock::Left, "", &drawStartPage};
  settle(start);
  EXPECT_TRUE(marks.find("start.open"));
  answer("create-point");
  settle(start);
  EXPECT_FALSE(marks.find("start.open")) << "it would lie over the lamp's handles";
  answer("undo");
  settle(start);
  EXPECT_TRUE(marks.find("start.open"));
}

TEST_F(WindowlessPanels, AFileDialogListsFoldersFirstAndWhatComes) {
  const std::filesystem::path shown = folder.path() / "shown";
  std::filesystem::create_directories(shown / "z");
  std::ofstream(shown / "b.glb") << "x";
  for (const char* name : {".hidden.glb", "c.txt"}) std::ofstream(shown / name) << "x";
  answer("open");
  ASSERT_TRUE(session->window.dialog);
  Dialog& dialog = *session->window.dialog;
  dialog.folder = shown;
  const auto listed = [&] {
    settle(Panel{"dialogs", Dock::Left, "", &drawDialogs});
    std::string names;
    for (const DialogFile& file : dialog.files) names += file.name + ' ';
    return names;
  };
  EXPECT_EQ(listed(), "z b.glb ");
  std::ofstream(shown / "a.glb") << "x";
  // The clock of the file system may be too coarse to tell both times apart.
  std::filesystem::last_write_time(shown, std::filesystem::last_write_time(shown) + std::chrono::seconds(1));
  EXPECT_EQ(listed(), "z a.glb b.glb ");
  dialog.kind = Dialog::Kind::Folder;
  dialog.listed.forget();
  EXPECT_EQ(listed(), "z ");
}

TEST_F(WindowlessPanels, AFileDialogLeadsToThePlacesOfFilesByOneClick) {
  openHello();
  answer("open");
  ASSERT_TRUE(session->window.dialog);
  session->window.dialog->folder = "/";
  const Panel dialogs{"dialogs", Dock::Left, "", &drawDialogs};
  settle(dialogs);
  click(dialogs, "dialog.place.Scene");
  ASSERT_TRUE(session->window.dialog);
  EXPECT_EQ(session->window.dialog->folder, folder.path());
  settle(dialogs);
  click(dialogs, "dialog.hello.glb");
  EXPECT_EQ(session->window.dialog->name, "hello.glb");
}

TEST_F(WindowlessPanels, AButtonOfTheEnvironmentAddsASunAsOneStep) {
  const Panel& environment = settled("Environment");
  click(environment, "environment.add-sun");
  EXPECT_EQ(session->document.world().lights.size(), 2u);
  EXPECT_EQ(session->history.stepsDone(), 1u);
  answer("undo");
  EXPECT_EQ(session->document.world().lights.size(), 1u);
}

}  // namespace
}  // namespace lambent::editor
