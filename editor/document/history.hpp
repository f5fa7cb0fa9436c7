// Undoes and redoes all edits of a document. Every edit goes through this class, which checks it, carries it
// out and keeps the entities and the world's state as they were before and after it, by StableId. Steps
// therefore stay valid when undo creates an entity anew or a bundle is reloaded. Edits between begin() and
// commit() form one step. An error changes nothing. One thread.
#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "editor/document/document.hpp"
#include "runtime/base/result.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/scene/reflection.hpp"

namespace lambent::editor {

struct FieldEdit {
  ecs::Entity entity;
  std::string_view component, field;
  scene::Value value;
};

// Describes what undo or redo did. Entities and components that do not exist at present (their bundle was
// closed, or came back without them) are skipped and named in `missing`.
struct Replay {
  bool done = false;  // false: there was no step
  std::string name;   // of the step
  std::vector<std::string> missing;
};

class History {
 public:
  static constexpr std::size_t kDefaultBytes = std::size_t{64} << 20;

  // The document must outlive the history. When the steps take more than max_bytes, the oldest are dropped.
  explicit History(Document& document, std::size_t max_bytes = kDefaultBytes)
      : document_(document), max_bytes_(max_bytes) {}

  // ---- Each of these edits is one step, unless a step is open.
  Result<void> setField(ecs::Entity entity, std::string_view component, std::string_view field,
                        scene::Value value);
  // Sets all fields or, on an error, none. Values that they had before (a bundle's) need not be in range.
  Result<void> setFields(std::span<const FieldEdit> edits, std::string name = {}, bool in_range = true);
  // Creates an entity from a snapshot. Errors: the parent has no Transform.
  Result<ecs::Entity> create(const EntitySnapshot& snapshot);
  // Destroys the entities and their descendants. Descendants that belong to bundles stay, at the same place,
  // below the world. Errors: an entity that is not Created.
  Result<void> destroy(std::span<const ecs::Entity> entities);
  Result<void> destroy(ecs::Entity entity) { return destroy(std::span(&entity, 1)); }
  // Moves the entities below `parent`, or to the top of the world if it is none. keep_place: an entity keeps
  // its place in the world and its Transform changes. Errors: an entity has no Transform; the parent is the
  // entity or a descendant of it; the parent's matrix has no inverse although the place is to be kept.
  Result<void> reparent(std::span<const ecs::Entity> entities, ecs::Entity parent, bool keep_place);
  Result<void> reparent(ecs::Entity entity, ecs::Entity parent, bool keep_place) {
    return reparent(std::span(&entity, 1), parent, keep_place);
  }
  // Add or remove a component of a Created entity, if the component allows it.
  Result<void> addComponent(ecs::Entity entity, std::string_view component);
  Result<void> removeComponent(ecs::Entity entity, std::string_view component);
  // Replaces the environment, the settings, the camera and the list of bundles. The program sees it by
  // Document::worldVersion().
  void setWorld(WorldState world, std::string name);
  // Lets `change` edit a copy of the world's state, and sets the result.
  template <typename Change>
  void editWorld(std::string name, const Change& change) {
    WorldState world = document_.world();
    change(world);
    setWorld(std::move(world), std::move(name));
  }

  // ---- begin() and commit() nest; the outermost pair makes the step.
  void begin(std::string name);
  void commit();
  void cancel();  // undoes the edits since the matching begin()
  bool open() const { return !scopes_.empty(); }
  // Make one step of a widget's drag, from press to release. beginDrag() ends a drag that is still open;
  // endDrag() without a drag does nothing.
  void beginDrag(std::string name);
  void endDrag();

  // ---- Undo and redo first commit a step that is open.
  Replay undo();
  Replay redo();
  bool canUndo() const { return done_ > 0 || edited(); }
  bool canRedo() const { return !edited() && done_ < steps_.size(); }
  std::string undoName() const;  // "Undo move of ball"; "Undo" if there is nothing to undo
  std::string redoName() const { return canRedo() ? "Redo " + steps_[done_].name : "Redo"; }
  std::size_t stepsDone() const { return done_; }

  // Returns whether anything was edited since markSaved().
  bool modified() const { return edited() || saved_ != forgotten_ + done_; }
  void markSaved();
  void clear();  // drops all steps; the present state counts as saved
  std::size_t bytes() const { return bytes_; }
  // Increases with every edit, undo and redo.
  std::uint64_t version() const { return version_; }

 private:
  // The part of a document that a step touches.
  struct State {
    std::map<StableId, std::optional<EntitySnapshot>> entities;  // none: there is no such entity
    std::optional<WorldState> world;

    bool empty() const { return entities.empty() && !world; }
    std::size_t bytes() const;
  };
  struct Step {
    std::string name;
    State before, after;  // of the same entities
    std::size_t bytes = 0;
  };
  // A pair of begin() and commit() that is open.
  struct Scope {
    std::string name;
    State before;
  };

  // Calls `edit`, which changes only what it has touched, as a step of its own unless one is open.
  template <typename Edit>
  void make(std::string name, const Edit& edit) {
    const bool alone = scopes_.empty();
    if (alone) begin(std::move(name));
    edit();
    if (alone) commit();
  }
  // Keeps the entity as it is before its first edit in the open scope. One without id is adopted.
  void touch(ecs::Entity entity);
  void touch(StableId id);
  // Returns whether anything was edited in the step that is open.
  bool edited() const;
  // Returns the present state of what `before` has.
  State now(const State& before) const;
  // Leaves out what is the same in both.
  static void keepDifferences(State& before, State& after);
  // Goes from one state to the other, and leaves alone what is the same in both.
  void go(const State& from, const State& to, std::vector<std::string>& missing);
  void goEntity(StableId id, const std::optional<EntitySnapshot>& from,
                const std::optional<EntitySnapshot>& to, std::vector<std::string>& missing);
  void goParent(StableId id, const std::optional<EntitySnapshot>& from, const EntitySnapshot& to,
                std::vector<std::string>& missing);
  // Returns the entity's Transform below another parent.
  Result<scene::Transform> below(ecs::Entity parent, ecs::Entity entity, bool keep_place) const;
  void push(Step step);
  void forgetOldest();
  // Returns the component if a person may add it to the entity (has: false) or remove it from there (true).
  Result<const scene::ComponentInfo*> changeable(ecs::Entity entity, std::string_view component,
                                                 bool has) const;

  Document& document_;
  std::size_t max_bytes_, bytes_ = 0;
  std::deque<Step> steps_;
  std::size_t done_ = 0;         // number of steps_ that are done
  std::uint64_t forgotten_ = 0;  // number of steps that were dropped from the front of steps_
  // The value of forgotten_ + done_ at markSaved(); none: no undo or redo leads there.
  std::optional<std::uint64_t> saved_ = 0;
  std::uint64_t version_ = 0;

  std::vector<Scope> scopes_;
  bool dragging_ = false;
};

// Returns edits of all fields of an entity's Transform but its parent.
std::vector<FieldEdit> transformEdits(ecs::Entity entity, const scene::Transform& to);
std::string entitiesName(const Document& document, std::span<const ecs::Entity> entities);
// Returns the name of a step: "move of ball", "strength of 3 entities".
std::string editName(const Document& document, std::span<const FieldEdit> edits);

}  // namespace lambent::editor
