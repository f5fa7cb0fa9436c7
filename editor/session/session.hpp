// Holds the editor's whole state except for windows and OpenGL: the document and its history, the scenes and
// their bakes, the lit world, the camera, and the reference. Commands and panels work on its parts; update()
// applies, once a frame, what bakes, files and edits did. A renderer (editor/render) draws it and writes its
// results to `picture`. Main thread. Errors are logged, and the session goes on.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "editor/document/document.hpp"
#include "editor/document/history.hpp"
#include "editor/document/selection.hpp"
#include "editor/document/tree.hpp"
#include "editor/session/asset_browser.hpp"
#include "editor/session/asset_pictures.hpp"
#include "editor/session/clipboard.hpp"
#include "editor/session/environment_map_shelf.hpp"
#include "editor/session/field_edit_state.hpp"
#include "editor/session/files.hpp"
#include "editor/session/handles.hpp"
#include "editor/session/log.hpp"
#include "editor/session/object_materials.hpp"
#include "editor/session/picture_facts.hpp"
#include "editor/session/plans.hpp"
#include "editor/session/playback.hpp"
#include "editor/session/preferences.hpp"
#include "editor/session/quality_study.hpp"
#include "editor/session/reference_view.hpp"
#include "editor/session/scene_changes.hpp"
#include "editor/session/scene_steps.hpp"
#include "editor/session/scenes.hpp"
#include "editor/session/setting_study.hpp"
#include "editor/session/stage.hpp"
#include "editor/session/viewing.hpp"
#include "editor/session/window_requests.hpp"

namespace lambent::editor {

struct SessionOptions {
  std::vector<std::filesystem::path> files;
  std::vector<std::string> light_words;  // empty: spec::kDefaultLights
  std::filesystem::path output_folder, cache_folder;
  std::uint64_t cache_bytes = baker::kCacheBytes;
  std::uint64_t max_memory_bytes = ~std::uint64_t{0};
  unsigned threads = 0;  // for bakes; 0: all but one
  bool bake = true;
  baker::Quality quality = baker::Quality::Standard;
};

class Session {
 public:
  // Opens the files and logs those that cannot be opened. Errors: those of Stage.
  static Result<std::unique_ptr<Session>> create(const SessionOptions& options, Preferences preferences);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  // Applies what bakes, files, animations and edits did since the last call. Call it once a frame.
  void update(double seconds);
  // Applies the document to the stage at once, for commands that query the stage right after an edit.
  void followDocument();

  // Returns whether no scene is open and nothing was made: no lamp, no camera, no empty entity.
  bool empty() const { return scenes.entries().empty() && document.registry().count<Created>() == 0; }

  // Scripts wait for these conditions.
  bool loaded() const { return stage.world().loaded() && (!viewing.frame_when_loaded || !awaitsScene()); }
  bool baked() const { return !scenes.busy() && loaded(); }
  bool atRest() const { return loaded() && picture.settled && !picture.in_flight; }
  bool measured() const { return !settings.busy() && !qualities.busy(); }
  // Returns whether frames must be drawn even without input.
  bool moving() const;
  // Returns whether something comes from elsewhere that the window will show: bakes, files that are read,
  // notices that vanish. It need not be looked at in every frame.
  bool awaits() const;

  Log log;
  Preferences preferences;
  Stage stage;
  Scenes scenes;
  Document document;
  History history;
  Selection selection;
  TreeRows tree;
  SceneSteps scene_steps{*this};
  SceneChanges changes{stage.world(), scenes, history, log};
  Files files{*this};
  Viewing viewing;
  Handles handles;
  Playback playback;
  PictureFacts picture;
  ReferenceView reference;
  SettingStudy settings;
  QualityStudy qualities;
  Plans plans;
  EnvironmentMapShelf environment_maps;
  AssetBrowser assets;
  AssetPictures asset_pictures;
  MaterialPictures material_pictures;
  Clipboard clipboard;
  FieldEditState field_edit;
  WindowRequests window;

 private:
  Session(const SessionOptions& options, Preferences preferences, Stage stage);
  // Returns whether a scene is open of which nothing is shown yet, and may be.
  bool awaitsScene() const;
  void logBundleErrors();
  void useDesktopDialogs();

  std::vector<std::string> told_;  // bundle errors that are already in the log
  std::uint64_t world_followed_ = 0;
};

}  // namespace lambent::editor
