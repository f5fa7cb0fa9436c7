#include <cstdlib>
#include <fstream>

#include "editor/session/dialog.hpp"
#include "tests/editor/program/windowless.hpp"

namespace lambent::editor {
namespace {

// Tests the desktop's file dialogs with a program in PATH that answers in their place.

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

// Tests what a dialog for files lists.

class DialogLists : public testing::Windowless {
 protected:
  std::vector<std::string> names() {
    files.update(*session, dialog);
    std::vector<std::string> names;
    for (const DialogFile& file : files.files()) names.push_back(file.name);
    return names;
  }
  void write(const char* name) const { std::ofstream(shown / name) << "x"; }

  using Names = std::vector<std::string>;
  std::filesystem::path shown = folder.path() / "shown";
  Dialog dialog;
  DialogFiles files;
};

TEST_F(DialogLists, FoldersFirstAndThenFilesOfTheKindsThatAreWanted) {
  std::filesystem::create_directories(shown / "z");
  for (const char* name : {"b.glb", "a.json", "c.txt", ".hidden.glb"}) write(name);
  dialog.kind = Dialog::Kind::OpenFile;
  dialog.folder = shown;
  dialog.kinds = {{"Scenes", {".glb"}}, {"Worlds", {".json"}}};
  EXPECT_EQ(names(), (Names{"z", "a.json", "b.glb"}));
  dialog.filter = 1;
  EXPECT_EQ(names(), (Names{"z", "b.glb"}));
  dialog.filter = 3;
  EXPECT_EQ(names(), (Names{"z", "a.json", "b.glb", "c.txt"}));
  dialog.kind = Dialog::Kind::Folder;
  files = {};
  EXPECT_EQ(names(), Names{"z"});
}

TEST_F(DialogLists, WhatComesIntoTheFolder) {
  std::filesystem::create_directories(shown);
  dialog.kind = Dialog::Kind::OpenFile;
  dialog.folder = shown;
  EXPECT_EQ(names(), Names{});
  write("new.glb");
  EXPECT_EQ(names(), Names{"new.glb"});
}

// A folder on a sleeping disk or a slow network must not be asked in every frame.
TEST_F(DialogLists, PlacesThatWereFoundWhenTheDialogOpened) {
  std::filesystem::create_directories(shown);
  session->preferences.recent = {(shown / "scene.glb").string()};
  dialog.folder = folder.path();
  files.update(*session, dialog);
  const auto hasShown = [&] {
    return std::ranges::find(files.places(), shown, &DialogPlace::folder) != files.places().end();
  };
  EXPECT_TRUE(hasShown());
  std::filesystem::remove(shown);
  files.update(*session, dialog);
  EXPECT_TRUE(hasShown()) << "it was asked again";
  DialogFiles anew;
  std::swap(files, anew);
  files.update(*session, dialog);
  EXPECT_FALSE(hasShown()) << "another dialog asks anew";
}

}  // namespace
}  // namespace lambent::editor
