// Holds the editor's whole state except for windows and OpenGL: the document and its history, the scenes and
// their bakes, the lit world, the camera, and the reference. Commands and panels work on its parts; update()
// applies, once a frame, what bakes, files and edits did. A renderer (editor/render) draws it and writes its
// results to `picture`. Main thread. Errors are logged, and the session goes on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "editor/document/actions.hpp"
#include "editor/document/document.hpp"
#include "editor/document/history.hpp"
#include "editor/document/tree.hpp"
#include "editor/gizmo/gizmo.hpp"
#include "editor/gizmo/projection.hpp"
#include "editor/session/field_numbers.hpp"
#include "editor/session/files.hpp"
#include "editor/session/key_lights.hpp"
#include "editor/session/log.hpp"
#include "editor/session/preferences.hpp"
#include "editor/session/reference_view.hpp"
#include "editor/session/scene_changes.hpp"
#include "editor/session/scenes.hpp"
#include "editor/session/viewing.hpp"
#include "runtime/base/change_gate.hpp"
#include "runtime/frame/frame_settings.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/world/world.hpp"

namespace lambent::editor {

// Owns the lit world: the bundles' entities, the distant light, and the frame settings, all kept in step with
// the document. Light words are loaded when they change; if an environment map cannot be read, the light
// stays as it was. Main thread. With a limit in max_memory_bytes, bundles are uploaded with the first
// picture. Without a limit, and when one bundle replaces another, loading needs a current OpenGL context.
// Errors: those of lighting::Environment.

class Stage {
 public:
  static Result<Stage> create(std::uint64_t max_memory_bytes);

  frame::World& world() { return world_; }
  const frame::World& world() const { return world_; }
  lighting::Environment& environment() { return environment_; }
  const lighting::Environment& environment() const { return environment_; }
  ecs::Entity environmentEntity() const { return environment_entity_; }
  const frame::FrameSettings& settings() const { return settings_; }
  // Returns the distant lights: those of the document, or the previous ones if these could not be loaded.
  const std::vector<spec::Light>& lights() const { return lights_; }
  const std::vector<spec::Light>& fadeLights() const { return fade_lights_; }

  // Applies lights, edits of key lights, settings and exposure of `state`. Errors: unknown words and
  // environment maps that cannot be read; everything else is applied.
  std::vector<Error> follow(const WorldState& state);
  void followEnvironment();

 private:
  Stage(frame::World world, lighting::Environment environment);
  Result<void> followLights(const WorldState& state);

  frame::World world_;
  lighting::Environment environment_;
  frame::FrameSettings settings_;
  ecs::Entity environment_entity_;
  std::vector<std::string> words_, fade_words_;
  std::vector<spec::Light> lights_, fade_lights_;
};

// Describes questions to the user: which file, which text, or whether to go on. panels/dialogs.cpp draws
// them, and the rest of the editor keeps running. Main thread.

class Session;

struct DialogPlace {
  std::string name;
  std::filesystem::path folder;
};

struct DialogFile {
  std::string name;
  bool is_folder = false;
};

struct Dialog {
  enum class Kind : std::uint8_t { OpenFile, SaveFile, Folder, Confirm, Text };
  Kind kind = Kind::Confirm;
  std::string title{}, question{};
  std::vector<std::string> endings{};              // of the files to list; empty: all files
  std::filesystem::path folder{};                  // the folder that is shown
  std::string name{};                              // the text typed so far
  std::string yes = "OK", no = "Cancel", third{};  // button texts; an empty one has no button
  std::function<void(Session&, const std::string& answer)> answered{};
  std::function<void(Session&)> third_chosen{};

  // What the window lists: places where files are likely to be, found when the dialog opens, and the contents
  // of the folder. Disks are not asked in every frame.
  std::vector<DialogPlace> places{};
  std::vector<DialogFile> files{};
  ChangeGate<std::filesystem::path, std::filesystem::file_time_type> listed{};
};

// Holds what commands request from the window: a dialog, panels to bring to the front, or the end of the
// program. The window reads and clears them once a frame.
struct WindowRequests {
  std::optional<Dialog> dialog;            // at most one at a time
  std::vector<std::string> wanted_panels;  // names of panels to bring to the front
  bool raise_tabs = true;                  // also bring the preferences' tabs to the front
  // Ids of commands to run in the next frame, when fields that were open have taken over what was typed.
  std::vector<std::string> wanted_commands;
  bool quit = false;
  std::uint64_t frames = 0;  // how many the window has drawn
};

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

// Holds the state of the handles that move, turn and scale the selection between frames.
// editor/panels/viewport.cpp drives them.
struct Handles {
  bool shown = true;
  Gizmo gizmo;
  FinePointer pointer;
};

// Holds whether the world's animations are playing, and their time.
struct Playback {
  bool playing = false;
  float time_s = 0.0f;
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

  Log log;
  Preferences preferences;
  Stage stage;
  Scenes scenes;
  Document document;
  History history;
  Selection selection;
  TreeRows tree;
  SceneChanges changes{stage.world(), scenes, history, log};
  Files files{*this};
  Viewing viewing;
  Handles handles;
  Playback playback;
  PictureFacts picture;
  ReferenceView reference;
  SettingStudy settings;
  std::vector<EntitySnapshot> clipboard;
  std::vector<HeldAngles> angles;  // of the rotations that were edited last
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

// Returns all matches, or an error if there is none. A match of the whole name wins over matches of parts.
Result<std::vector<ecs::Entity>> findEntities(const Session& session, const std::string& word);
// Returns the scene of the primary selected entity, else the first scene, or none if no scene is open.
std::optional<std::size_t> sceneAtHand(const Session& session);
// Finds a scene by its id or number. An empty word means sceneAtHand().
Result<std::size_t> findScene(const Session& session, const std::string& word);

}  // namespace lambent::editor
