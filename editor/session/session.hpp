// All that the editor holds, without its windows: the world on stage, the scenes that it is made of, the
// document over it with its history, the eye, the reference beside it. Commands and panels work on this;
// update() follows, once a frame, what bakes, files and edits did. Main thread, with a current OpenGL
// context. What goes wrong is logged, and the session goes on.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "editor/document/baseline.hpp"
#include "editor/document/document.hpp"
#include "editor/document/history.hpp"
#include "editor/document/selection.hpp"
#include "editor/document/tree.hpp"
#include "editor/document/world_file.hpp"
#include "editor/session/dialog.hpp"
#include "editor/session/environment_map_shelf.hpp"
#include "editor/session/log.hpp"
#include "editor/session/plans.hpp"
#include "editor/session/preferences.hpp"
#include "editor/session/quality_study.hpp"
#include "editor/session/reference_view.hpp"
#include "editor/session/scene_steps.hpp"
#include "editor/session/scenes.hpp"
#include "editor/session/setting_study.hpp"
#include "editor/session/stage.hpp"
#include "editor/session/viewing.hpp"

namespace lambent::editor {

// The system's, once there is a window; until then one of its own.
struct Clipboard {
  std::function<void(const std::string&)> put_system;
  std::function<std::string()> get_system;
  std::string text;

  void put(const std::string& value) {
    text = value;
    if (put_system) put_system(value);
  }
  std::string get() const { return get_system ? get_system() : text; }
};

struct SessionOptions {
  std::vector<std::filesystem::path> files;
  std::vector<std::string> light_words;  // empty: the usual ones
  std::filesystem::path output_folder, cache_folder;
  std::uint64_t cache_bytes = baker::kCacheBytes;
  std::uint64_t max_memory_bytes = ~std::uint64_t{0};
  unsigned threads = 0;  // of bakes; 0: all but one
  bool bake = true;
  baker::Quality quality = baker::Quality::Standard;
};

class Session {
 public:
  // Errors: no OpenGL 4.5. Files that cannot be opened are logged.
  static Result<std::unique_ptr<Session>> create(const SessionOptions& options, Preferences preferences);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  // Once a frame: what bakes, files, animations and edits did since the last.
  void update(double seconds);
  // What the document says is on stage: for commands that ask about the stage right after an edit.
  void followDocument();
  // Draws the view in `size` pixels, if anything moved; a failure is logged once.
  void render(spec::Size size);
  // Whether frames have to go on without input.
  bool moving() const;

  // ---- files
  // A scene, a bundle, a folder of them, or a world. The answer is of the world file alone.
  Result<void> open(const std::filesystem::path& path);
  void openLogged(const std::filesystem::path& path);
  Result<void> save(const std::filesystem::path& path);
  void newWorld();
  const std::filesystem::path& worldFile() const { return world_file_; }
  // Whether something would be lost. What is merely open in a world that has no file is not.
  bool modified() const;
  // Asks first where something is not saved.
  void askToQuit();
  // After a question whether what is not saved may be lost.
  void unlessUnsaved(std::string question, std::function<void(Session&)> then);

  // ---- the world
  // An edit of the world beside its entities, as one step.
  template <typename Change>
  void editWorld(std::string name, const Change& change) {
    WorldState world = document.world();
    change(world);
    history.setWorld(std::move(world), std::move(name));
  }
  // Of the bundle that the primary selected entity belongs to, else the only or first one.
  std::optional<std::size_t> entryAtHand() const;
  // What of the entry's bundle differs from its file.
  baker::SceneEdits editsOf(std::size_t entry) const;
  scene::Box selectionBounds() const;
  // How the bundles stand unedited.
  const Baseline& baseline();
  // What the picture only approximates of the entry's edits until they are baked; sentences.
  std::vector<std::string> needsRebake(std::size_t entry) const;
  // The same, looked for again only when edits or scenes have changed: for every frame.
  const std::vector<std::string>& needsRebakeNow(std::size_t entry);
  // Rows of the tree as `tree` asks for them; made anew when something has changed.
  const std::vector<TreeRow>& treeRowsNow();
  // From the first pixel of a widget's drag to its end is one step of the history.
  void beginDrag(std::string name);
  void endDrag();
  Replay undo();
  Replay redo();

  // ---- for scripts and the title
  bool loaded() const;
  bool baked() const { return !scenes.busy() && loaded(); }
  bool atRest() const { return loaded() && stage.atRest(); }
  bool measured() const { return !settings.busy() && !qualities.busy(); }
  bool referenceDone() const { return reference.done(); }
  std::string title() const;
  bool titleChanged();
  std::string statusLine() const;

  Log log;
  Preferences preferences;
  Stage stage;
  Scenes scenes;
  Document document;
  History history;
  SceneSteps scene_steps{*this};
  Selection selection;
  Viewing viewing;
  ReferenceView reference;
  Plans plans;
  EnvironmentMapShelf environment_maps;
  SettingStudy settings;
  QualityStudy qualities;
  TreeQuery tree;
  Clipboard clipboard;
  std::optional<Dialog> dialog;            // at most one
  bool raise_tabs = true;                  // the preferences' tabs are to come up
  std::vector<std::string> wanted_panels;  // to be brought up
  bool quit = false;

 private:
  Session(const SessionOptions& options, Preferences preferences, Stage stage);
  Result<void> openWorld(const std::filesystem::path& path);
  frame::OverlayOptions overlaysNow() const;
  std::vector<std::uint32_t> selectedGroups() const;
  std::uint64_t editsVersion() const;
  void keepWorldState();

  std::filesystem::path world_file_;
  std::optional<WorldFile> loaded_world_;  // unknown parts of it are saved again
  std::string title_;
  std::vector<std::string> told_;  // what is wrong with bundles
  std::uint64_t world_followed_ = 0;
  std::vector<TreeRow> rows_;
  TreeQuery rows_of_;
  std::uint64_t rows_version_ = ~std::uint64_t{0};
  bool dragging_ = false;
  struct Rebake {
    std::size_t entry = 0;
    std::uint64_t edits = 0, scenes = 0;
    bool operator==(const Rebake&) const = default;
  };
  std::optional<Rebake> rebake_of_;
  std::vector<std::string> rebake_;
  Baseline baseline_;
  // Version of the scenes, and the descriptions.
  std::pair<std::uint64_t, std::vector<const void*>> baseline_of_{0, {}};
  // What the last picture was of.
  std::uint64_t edits_drawn_ = 0;
  spec::View view_drawn_;
  spec::Size size_drawn_;
  int frames_to_draw_ = 1;
};

}  // namespace lambent::editor
