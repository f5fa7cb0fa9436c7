// Tests the desktop's file dialogs with a program in PATH that answers in their place.
#include <cstdlib>
#include <fstream>

#include "editor/session/dialog.hpp"
#include "tests/editor/program/windowless.hpp"

namespace lambent::editor {
namespace {

// Sets a variable of the environment and restores it.
class Variable {
 public:
  Variable(const char* name, const std::string& value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    ::setenv(name, value.c_str(), /*overwrite=*/1);
  }
  ~Variable() {
    if (before_)
      ::setenv(name_, before_->c_str(), 1);
    else
      ::unsetenv(name_);
  }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
  std::optional<std::string> before_;
};

class DesktopDialogs : public testing::Windowless {
 protected:
  void SetUp() override {
    Windowless::SetUp();
    std::filesystem::create_directories(programs);
  }
  void install(const std::string& script) const {
    const std::filesystem::path file = programs / "zenity";
    std::ofstream(file) << "#!/bin/sh\n" << script << '\n';
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  }
  // Asks for a folder of environment maps and waits for the program's end.
  void ask() {
    session->window.desktop_program = desktopDialogProgram();
    answer("environment-map-folder");
    EXPECT_TRUE(lambent::testing::eventually([&] {
      session->update(0.0);
      return !session->window.desktop_dialog.open();
    }));
  }

  std::filesystem::path programs = folder.path() / "bin";
  Variable path{"PATH", programs.string()}, display{"DISPLAY", ":7"};
};

TEST_F(DesktopDialogs, AreTheEditorsOwnWithoutSuchAProgramOrADesktop) {
  ask();
  EXPECT_TRUE(session->window.dialog);
  install("exit 1");
  EXPECT_EQ(desktopDialogProgram(), programs / "zenity");
  const Variable no_display("DISPLAY", ""), no_wayland("WAYLAND_DISPLAY", "");
  EXPECT_TRUE(desktopDialogProgram().empty());
}

TEST_F(DesktopDialogs, AnswerWithTheFileThatIsChosen) {
  const std::filesystem::path file = folder.path() / "a scene's $HOME.glb";
  ASSERT_TRUE(assets::writeGlb(file, assets::hello()));
  install("printf '%s\\n' \"" + (folder.path() / "a scene's \\$HOME.glb").string() +
          "\"; printf '%s\\n' \"$@\" >" + (folder.path() / "words").string());
  session->window.desktop_program = desktopDialogProgram();
  answer("open");
  ASSERT_TRUE(lambent::testing::eventually([&] {
    session->update(0.0);
    return !session->scenes.entries().empty();
  }));
  EXPECT_EQ(session->scenes.entries().front().source, file);
  EXPECT_FALSE(session->window.dialog);
  std::ifstream words(folder.path() / "words");
  std::string said((std::istreambuf_iterator<char>(words)), {});
  EXPECT_NE(said.find("--file-filter=Scenes | *.gltf *.glb\n"), std::string::npos) << said;
}

TEST_F(DesktopDialogs, ChangeNothingWhenTheyAreCancelled) {
  install("echo /nowhere; exit 1");
  session->window.desktop_program = desktopDialogProgram();
  answer("open");
  session->update(0.0);
  EXPECT_FALSE(session->window.dialog);
  ask();
  EXPECT_FALSE(session->window.dialog);
  EXPECT_TRUE(session->scenes.entries().empty());
  EXPECT_TRUE(session->log.entries().empty());
}

TEST_F(DesktopDialogs, GiveWayToTheEditorsOwnWhenTheyFailOrAreNotWanted) {
  install("exit 5");
  ask();
  EXPECT_TRUE(session->window.dialog) << "the question is asked in the window";
  session->window.dialog.reset();
  install("exit 1");
  session->preferences.desktop_dialogs = false;
  ask();
  EXPECT_TRUE(session->window.dialog);
}

}  // namespace
}  // namespace lambent::editor
