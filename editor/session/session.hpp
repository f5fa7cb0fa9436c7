// Holds the editor's whole state except for windows and OpenGL: the document and its history, the scenes and
// their bakes, the lit world, the camera, and the reference. Commands and panels work on its parts; update()
// applies, once a frame, what bakes, files and edits did. A renderer (editor/render) draws it and writes its
// results to `picture`. Main thread. Errors are logged, and the session goes on.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "editor/document/document.hpp"
#include "editor/document/history.hpp"
#include "editor/document/selection.hpp"
#include "editor/document/tree.hpp"
#include "editor/gizmo/gizmo.hpp"
#include "editor/gizmo/light_gizmo.hpp"
#include "editor/gizmo/projection.hpp"
#include "editor/gizmo/sun_gizmo.hpp"
#include "editor/session/assets.hpp"
#include "editor/session/dialog.hpp"
#include "editor/session/field_numbers.hpp"
#include "editor/session/files.hpp"
#include "editor/session/key_lights.hpp"
#include "editor/session/log.hpp"
#include "editor/session/materials.hpp"
#include "editor/session/preferences.hpp"
#include "editor/session/reference_view.hpp"
#include "editor/session/scene_changes.hpp"
#include "editor/session/scenes.hpp"
#include "editor/session/stage.hpp"
#include "editor/session/studies.hpp"
#include "editor/session/viewing.hpp"

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

// Holds the state of the gizmos between frames: the handles that move, turn and scale the selection, shape
// lights, and drag suns. editor/panels/manipulate.cpp drives them.
struct Handles {
  bool shown = true;
  Gizmo gizmo;
  LightGizmo light_gizmo;
  SunGizmo sun_gizmo;
  FinePointer pointer;
  std::optional<SunOnSky> sun_taken;  // the sun as it was when its drag began
};

// Holds whether the world's animations are playing, and their time.
struct Playback {
  bool playing = false;
  float time_s = 0.0f;
};

// Holds the text that was copied last: in the system's clipboard if a window has set its functions, else in
// `text`.
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
  bool measured() const { return !settings.busy(); }
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
  Plans plans;
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

  std::vector<std::string> told_;  // bundle errors that are already in the log
  std::uint64_t world_followed_ = 0;
};

// ---- Words of scripts and menus, for entities by name, id or search, and for scenes by id or number.

// Returns whether all words of the search are parts of the text.
bool holdsWords(std::string_view text, std::string_view search);
// Returns all matches, or an error if there is none. A match of the whole name wins over matches of parts.
Result<std::vector<ecs::Entity>> findEntities(const Session& session, const std::string& word);
// Returns the scene of the primary selected entity, else the first scene, or none if no scene is open.
std::optional<std::size_t> sceneAtHand(const Session& session);
// Finds a scene by its id or number. An empty word means sceneAtHand().
Result<std::size_t> findScene(const Session& session, const std::string& word);

}  // namespace lambent::editor
