// Tests commands on a session without window and OpenGL.
#include <fstream>
#include <utility>

#include "editor/session/scene_changes.hpp"
#include "tests/editor/program/windowless.hpp"

namespace lambent::editor {
namespace {

using nlohmann::json;

class WindowlessCommands : public testing::Windowless {
 protected:
  // Closes the dialog that asks, and returns it.
  Dialog takeDialog() const {
    EXPECT_TRUE(session->window.dialog) << "nothing asks";
    return std::exchange(session->window.dialog, std::nullopt).value_or(Dialog{});
  }
  // Says under which name a world file finds the bundle that is shown, though nothing is baked.
  void keepBundle() const {
    const SceneEntry& entry = session->scenes.entries().front();
    std::filesystem::copy(entry.shown, entry.bundle);
  }
  template <typename Condition>
  void waitFor(const Condition& holds) const {
    EXPECT_TRUE(lambent::testing::eventually([&] {
      session->update(0.0);
      return holds();
    }));
  }
  // Moves the sphere of hello.glb.
  void moveSphere() {
    answer("select", {"has:Transform sphere"});
    answer("set", {"Transform.translation", "0.1", "0.6", "0.2"});
  }
};

TEST_F(WindowlessCommands, CreateSelectMoveAndTakeItBack) {
  answer("create-sphere", {"0", "1", "0"});
  answer("create-point");
  answer("select", {"sphere"});
  EXPECT_EQ(answer("state")["selected"], json::array({"sphere"}));
  answer("set", {"Transform.translation", "1", "2", "3"});
  EXPECT_EQ(answer("get", {"Transform.translation"}), json::array({1.0, 2.0, 3.0}));
  EXPECT_EQ(answer("undo")["done"], true);
  EXPECT_EQ(answer("get", {"Transform.translation"}), json::array({0.0, 1.0, 0.0}));
  answer("redo");
  EXPECT_EQ(answer("get", {"Transform.translation"}), json::array({1.0, 2.0, 3.0}));
  EXPECT_FALSE(run("set", {"Light.radius", "-1"})) << "out of its range";
}

TEST_F(WindowlessCommands, DeleteAndBringBack) {
  answer("create-spot");
  answer("rename", {"desk lamp"});
  const json found = answer("tree", {"\"desk lamp\""});
  ASSERT_EQ(found.size(), 1u);
  answer("delete");
  EXPECT_EQ(answer("tree", {"\"desk lamp\""}).size(), 0u);
  answer("undo");
  EXPECT_EQ(answer("tree", {"\"desk lamp\""}), found) << "the same id";
  answer("select", {"desk lamp"});
  answer("duplicate");
  EXPECT_EQ(answer("tree", {"type:light"}).size(), 2u);
}

TEST_F(WindowlessCommands, AddLightsThatComeOnStage) {
  answer("add-light", {"sun:35,45,0.5,20000"});
  session->update(0.0);
  EXPECT_EQ(session->stage.lights().size(), 2u);
  const json keys = answer("keys");
  ASSERT_EQ(keys.size(), 1u);
  EXPECT_NEAR(keys[0]["elevation"].get<double>(), 45.0, 0.01);
  answer("move-key", {"0", "90", "30"});
  EXPECT_NEAR(answer("keys")[0]["azimuth"].get<double>(), 90.0, 0.01);
  answer("remove-light", {"1"});
  EXPECT_EQ(answer("keys").size(), 0u);
  EXPECT_FALSE(run("add-light", {"sun:1"}));
  EXPECT_FALSE(run("add-light", {"nowhere.hdr"}));
}

TEST_F(WindowlessCommands, SettingsAndQualitiesAreStepsThatTheStageFollows) {
  answer("setting", {"key-samples", "17"});
  answer("quality", {"low"});
  session->followDocument();
  EXPECT_EQ(session->stage.settings().mostKeys(), 4u);
  EXPECT_EQ(answer("state")["settings"]["keys"], "4");
  answer("undo");
  session->followDocument();
  EXPECT_EQ(answer("state")["settings"]["key-samples"], "17");
  EXPECT_EQ(answer("state")["settings"]["keys"], "auto");
  EXPECT_FALSE(run("setting", {"key-samples", "no number"}));
}

TEST_F(WindowlessCommands, LookAtTheWorldAsTheyAreTold) {
  answer("view", {"normals"});
  EXPECT_EQ(answer("state")["view"], "normals");
  answer("camera", {"pose:1,2,3,0,0,5,40"});
  EXPECT_FALSE(run("camera", {"no such camera"}));
  answer("split");
  EXPECT_TRUE(session->reference.on());
  answer("reference-bands", {"5"});
  EXPECT_EQ(session->reference.band_limit, 5);
}

// The plain picture must not be shown under the name of a difference before there is one.
TEST_F(WindowlessCommands, ShowADifferenceOnlyOnceThereIsOne) {
  ReferenceView& reference = session->reference;
  answer("heat");
  EXPECT_FALSE(reference.shows());
  reference.shown(std::make_shared<const baker::reference::Snapshot>());
  EXPECT_FALSE(reference.shows()) << "samples are no difference yet";
  answer("split");
  EXPECT_TRUE(reference.shows());
  answer("heat");
  reference.compared(baker::Difference{});
  EXPECT_TRUE(reference.shows());
}

TEST_F(WindowlessCommands, ChangeAMaterialOfABundle) {
  openHello();
  answer("select", {"type:material floor"});
  answer("set", {"Material.base_color", "0.9", "0.1", "0.1"});
  const baker::SceneEdits edits = session->changes.editsOf(0);
  ASSERT_EQ(edits.materials.size(), 1u);
  EXPECT_EQ(edits.materials.front().name, "floor");
  answer("reset", {"Material"});
  EXPECT_TRUE(session->changes.editsOf(0).materials.empty());
}

TEST_F(WindowlessCommands, SetOptionsOfABakeAndBake) {
  openHello();
  answer("bake-option", {"rays", "300"});
  answer("bake-option", {"bounces", "1", "hello"});
  EXPECT_EQ(answer("state")["scenes"][0]["bakeOptions"]["rays"], "300");
  EXPECT_FALSE(run("bake-option", {"rays", "few"}));
  EXPECT_FALSE(run("bake-option", {"rays", "300", "no such scene"}));
  EXPECT_EQ(session->scenes.jobOf(0)->request.last, baker::PreviewLevel::Unshadowed);
  answer("bake");
  EXPECT_EQ(session->scenes.jobOf(0)->request.last, baker::PreviewLevel::Final);
  EXPECT_EQ(session->scenes.jobOf(0)->request.options.settings().at("rays"), "300");
  answer("cancel");
}

TEST_F(WindowlessCommands, SaveAWorldThatComesBack) {
  openHello();
  moveSphere();
  answer("create-point", {"0", "2", "0"});
  const std::string file = (folder.path() / "world.json").string();
  keepBundle();
  EXPECT_TRUE(session->files.modified());
  answer("save", {file});
  EXPECT_FALSE(session->files.modified());
  session = makeSession();
  answer("open", {file});
  waitForBundle(*session);
  answer("select", {"has:Transform sphere"});
  EXPECT_NEAR(answer("get", {"Transform.translation"})[1].get<double>(), 0.6, 1e-6);
  EXPECT_NEAR(answer("get", {"point:Transform.translation"})[1].get<double>(), 2.0, 1e-6);
}

TEST_F(WindowlessCommands, OpenAWorldOfWhichOneSceneIsGoneAndAnotherDoesNotBake) {
  openHello();
  moveSphere();
  const std::filesystem::path gone = folder.path() / "hello.glb", away = folder.path() / "away",
                              broken = folder.path() / "broken.glb";
  std::ofstream(broken) << "no scene";
  answer("open", {broken.string()});
  waitFor([&] { return statusOf(*session, 1).text == "bake failed"; });
  const std::string file = (folder.path() / "world.json").string();
  answer("save", {file});
  std::filesystem::rename(gone, away);

  session = makeSession();
  answer("open", {file});
  ASSERT_EQ(session->scenes.entries().size(), 2u) << "both are listed";
  const SceneStatus missing = statusOf(*session, 0);
  EXPECT_EQ(missing.text, "missing");
  EXPECT_NE(missing.detail.find(gone.string()), std::string::npos) << missing.detail;
  EXPECT_FALSE(run("bake", {"hello"}));
  waitFor([&] { return statusOf(*session, 1).text == "bake failed"; });
  answer("save", {file});

  session = makeSession();
  answer("open", {file});
  std::filesystem::rename(away, gone);
  answer("bake", {"hello"});
  waitForBundle(*session);
  answer("select", {"has:Transform sphere"});
  EXPECT_NEAR(answer("get", {"Transform.translation"})[1].get<double>(), 0.6, 1e-6)
      << "its edits waited in the file";
  answer("close", {"broken"});
  EXPECT_EQ(session->scenes.entries().size(), 1u);
  EXPECT_TRUE(session->files.modified()) << "the file has two";
}

TEST_F(WindowlessCommands, AskBeforeASceneIsClosedWhoseEditsWouldBeLost) {
  openHello();
  moveSphere();
  answer("close");
  EXPECT_EQ(session->scenes.entries().size(), 1u) << "nothing is closed before the answer";
  takeDialog().answered(*session, {});
  EXPECT_TRUE(session->scenes.entries().empty());
  EXPECT_EQ(answer("undo")["missing"].size(), 1u) << "the step of what is gone is passed over";
}

TEST_F(WindowlessCommands, SayThatTheEditsOfAWorldFileCannotBeRead) {
  openHello();
  const std::string file = (folder.path() / "world.json").string();
  keepBundle();
  answer("save", {file});
  json world = json::parse(std::ifstream(file));
  world["bundles"][0]["bake_options"]["edits"] = "cut o";
  std::ofstream(file) << world.dump();
  session = makeSession();
  answer("open", {file});
  std::string told;
  for (const LogEntry& line : session->log.entries())
    if (line.severity == Severity::Warning) told += line.text + '\n';
  EXPECT_NE(told.find("the world file's edits cannot be read"), std::string::npos) << told;
}

TEST_F(WindowlessCommands, SayInOnePlaceThatASceneNeedsARebake) {
  openHello();
  const auto status = [&] { return statusOf(*session, 0); };
  // Only a preview was made of it.
  EXPECT_EQ(status().standing, Standing::Wanting) << status().text;
  keepBundle();
  answer("close");
  answer("open", {(folder.path() / "hello.glb").string()});
  waitFor([&] { return !session->scenes.busy(); });
  EXPECT_EQ(status().standing, Standing::Good) << status().text;
  EXPECT_TRUE(worstStatus(*session).text.empty());
  moveSphere();
  session->update(0.0);
  answer("select-none");
  EXPECT_EQ(status().text, "needs a rebake");
  EXPECT_NE(status().detail.find("sphere"), std::string::npos) << status().detail;
  EXPECT_EQ(worstStatus(*session).text, "hello: needs a rebake");
  answer("undo");
  session->update(0.0);
  EXPECT_EQ(status().standing, Standing::Good) << status().text;
  answer("bake-option", {"rays", "300"});
  EXPECT_EQ(status().text, "needs a rebake") << "other options are no less a reason";
}

TEST_F(WindowlessCommands, AskInADialogWhatHasNotBeenSaid) {
  answer("open");
  ASSERT_TRUE(session->window.dialog);
  EXPECT_EQ(session->window.dialog->kind, Dialog::Kind::OpenFile);
  session->window.dialog.reset();
  answer("quit");
  EXPECT_TRUE(session->window.quit) << "nothing would be lost";
  session->window.quit = false;
  answer("create-empty");
  answer("quit");
  EXPECT_FALSE(session->window.quit);
  ASSERT_TRUE(session->window.dialog);
  const Dialog asked = *session->window.dialog;
  asked.answered(*session, {});
  EXPECT_TRUE(session->window.quit);
}

TEST_F(WindowlessCommands, AskBeforeAWorldTakesThePlaceOfUnsavedEdits) {
  const std::string world = (folder.path() / "hall.json").string(),
                    broken = (folder.path() / "broken.json").string(),
                    scene = (folder.path() / "hello.glb").string();
  ASSERT_TRUE(assets::writeGlb(scene, assets::hello()));
  answer("create-point");
  answer("save", {world});
  answer("open", {world});
  EXPECT_FALSE(session->window.dialog) << "nothing would be lost";
  answer("create-sphere");
  std::ofstream(broken) << "{}";
  EXPECT_FALSE(run("open", {broken})) << "a file that cannot be read is told at once";
  EXPECT_FALSE(session->window.dialog);
  answer("open", {scene, world});
  ASSERT_TRUE(session->window.dialog);
  EXPECT_TRUE(session->scenes.entries().empty()) << "nothing is opened before the answer";
  const Dialog asked = takeDialog();
  EXPECT_EQ(answer("tree", {"type:light"}).size(), 2u);
  asked.third_chosen(*session);
  EXPECT_EQ(answer("tree", {"type:light"}).size(), 2u) << "it was saved, and is open again";
  EXPECT_FALSE(session->files.modified());
}

TEST_F(WindowlessCommands, AskForTheFileOfAWorldThatIsSavedBeforeAnotherOne) {
  answer("create-point");
  answer("new");
  const Dialog asked = takeDialog();
  asked.third_chosen(*session);
  const Dialog saving = takeDialog();  // it has no file yet
  EXPECT_EQ(saving.kind, Dialog::Kind::SaveFile);
  const std::filesystem::path file = folder.path() / "mine.json";
  saving.answered(*session, file.string());
  EXPECT_TRUE(std::filesystem::exists(file));
  EXPECT_TRUE(session->empty()) << "and then a new one has begun";
}

TEST_F(WindowlessCommands, KeepTwoBundlesOfOneIdApart) {
  openHello();
  std::filesystem::copy(session->scenes.entries().front().shown, folder.path() / "room.lmb.glb");
  const std::string file = (folder.path() / "world.json").string();
  const json bundles = {{{"path", "room.lmb.glb"}, {"id", "room"}, {"instance", 3}},
                        {{"path", "room.lmb.glb"}, {"id", "room"}, {"instance", 0}}};
  std::ofstream(file) << json{{"lambent_world", 1}, {"bundles", bundles}}.dump();
  session = makeSession();
  answer("open", {file});
  waitForBundle(*session);
  session->changes.baseline();
  answer("save", {file});
  const json saved = json::parse(std::ifstream(file))["bundles"];
  ASSERT_EQ(saved.size(), 2u);
  EXPECT_EQ(saved[0]["instance"], 3);
  EXPECT_EQ(saved[1]["instance"], 0);
  EXPECT_EQ(session->log.errors(), 0u) << "they are two";
}

TEST_F(WindowlessCommands, WhatIsNotSavedIsRescuedBesideTheWorld) {
  openHello();
  const std::filesystem::path file = folder.path() / "room.json",
                              rescued = folder.path() / "room.rescued.json";
  answer("save", {file.string()});
  const auto nothing = session->files.rescue();
  ASSERT_TRUE(nothing);
  EXPECT_TRUE(nothing->empty()) << "all is saved";
  const json saved = json::parse(std::ifstream(file));
  answer("add-light", {"sun:35,45,0.5,20000"});
  const auto lies_in = session->files.rescue();
  ASSERT_TRUE(lies_in) << lies_in.error().line();
  EXPECT_EQ(*lies_in, rescued);
  EXPECT_EQ(json::parse(std::ifstream(file)), saved) << "the world's file stays as it was";
  EXPECT_NE(json::parse(std::ifstream(rescued)), saved);
}

TEST_F(WindowlessCommands, ChangeALayoutThatIsRemembered) {
  answer("bottom-panels");
  session->preferences.addRecent(folder.path() / "a.glb");
  const std::filesystem::path file = folder.path() / "editor.json";
  savePreferences(file, session->preferences);
  const Preferences loaded = loadPreferences(file);
  EXPECT_EQ(loaded.layout, session->preferences.layout);
  EXPECT_FALSE(loaded.layout.of(Dock::Bottom).shown);
  EXPECT_EQ(loaded.recent, session->preferences.recent);
  answer("layout-default");
  EXPECT_EQ(session->preferences.layout, WindowLayout());
}

TEST_F(WindowlessCommands, SaveProposesTheScenesNameAndReplacesNoOtherFileUnasked) {
  openHello();
  answer("save");
  const Dialog saving = takeDialog();
  EXPECT_EQ(saving.name, "hello.json");
  EXPECT_EQ(saving.folder, folder.path());
  const std::filesystem::path file = folder.path() / "hello.json";
  std::ofstream(file) << "{}";
  saving.answered(*session, file.string());
  const Dialog asked = takeDialog();  // the file is there already
  EXPECT_EQ(std::filesystem::file_size(file), 2u);
  asked.answered(*session, {});
  EXPECT_GT(std::filesystem::file_size(file), 2u);
  saving.answered(*session, file.string());
  EXPECT_FALSE(session->window.dialog) << "it is the world's own file now";
}

// The menu bar, the tree and the Bakes panel are drawn one after another, while a bake goes on.
TEST_F(WindowlessCommands, TellOneShareOfABakeFromUpdateToUpdate) {
  const std::filesystem::path file = folder.path() / "hello.glb";
  ASSERT_TRUE(assets::writeGlb(file, assets::hello()));
  answer("open", {file.string()});
  std::string told = statusOf(*session, 0).text;
  EXPECT_TRUE(lambent::testing::eventually([&] {
    EXPECT_EQ(statusOf(*session, 0).text, told);
    session->update(0.0);
    told = statusOf(*session, 0).text;
    return session->scenes.entries().front().slot.has_value();
  }));
}

}  // namespace
}  // namespace lambent::editor
