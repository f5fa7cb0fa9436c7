// Tests what a dialog for files lists.
#include <fstream>

#include "editor/session/dialog.hpp"
#include "tests/editor/program/windowless.hpp"

namespace lambent::editor {
namespace {

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
