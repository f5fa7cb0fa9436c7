// Undoes and redoes all edits of a document. Every edit goes through this class, which checks it, carries it
// out and stores the values before and after by StableId, component and field. Steps therefore stay valid
// when undo creates an entity anew or a bundle is reloaded. Edits between begin() and commit() form one step;
// a field that is set many times in it (a drag) is stored once. An error changes nothing. One thread.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
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

// An OutsideChange is a change of something that the document does not hold, such as which scenes are open.
struct OutsideChange {
  // Redoes the change if `forth`, else undoes it. Appends what is no longer possible to `missing`.
  std::function<void(bool forth, std::vector<std::string>& missing)> carry_out;
  std::size_t bytes = 0;  // approximate memory use
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
  // Records a change that has just been made outside the document.
  void did(OutsideChange change, std::string name);

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
  bool canUndo() const { return done_ > 0 || !current_.empty(); }
  bool canRedo() const { return current_.empty() && done_ < steps_.size(); }
  std::string undoName() const;  // "Undo move of ball"; "Undo" if there is nothing to undo
  std::string redoName() const { return canRedo() ? "Redo " + steps_[done_].name : "Redo"; }
  // Return the names of all steps, oldest first, and how many of them are done.
  std::vector<std::string> stepNames() const;
  std::size_t stepsDone() const { return done_; }

  // Return whether anything was edited since markSaved(), and whether by more than OutsideChanges.
  bool modified() const;
  bool modifiedInside() const;
  void markSaved();
  void clear();  // drops all steps; the present state counts as saved
  std::size_t bytes() const { return bytes_; }
  // Increases with every edit, undo and redo.
  std::uint64_t version() const { return version_; }

 private:
  struct FieldChange {
    StableId entity;
    const scene::FieldInfo* field;
    scene::Value before, after;
  };
  struct ParentChange {
    StableId entity, before, after;
  };
  struct EntityChange {
    EntitySnapshot snapshot;
    bool made;  // false: destroyed
  };
  struct ComponentChange {
    StableId entity;
    ComponentValues values;
    bool added;  // false: removed
  };
  struct WorldChange {
    WorldState before, after;
  };
  using Change =
      std::variant<FieldChange, ParentChange, EntityChange, ComponentChange, WorldChange, OutsideChange>;
  struct Step {
    std::string name;
    std::vector<Change> changes;
    std::size_t bytes = 0;
  };
  struct Scope {
    std::string name;
    std::size_t first;  // index of its first change in current_
    bool single;        // opened by beginEdit(): joins an enclosing step
  };

  static std::size_t bytesOf(const Change& change);
  // Enclose a single edit, as begin() and commit() do.
  void beginEdit(std::string name);
  void endEdit();
  void run(Change change);   // carries the change out and keeps it
  void keep(Change change);  // adds the change to the open step
  void apply(const Change& change, bool forth, std::vector<std::string>& missing);
  // Returns the changes that reparent an entity: of its parent and, if the place is kept, of its Transform.
  Result<std::vector<Change>> moves(ecs::Entity entity, ecs::Entity parent, bool keep_place);
  void push(std::string name, std::vector<Change> changes);
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
  std::vector<Change> current_;
  // The index in current_ of a field's change; later edits of the field join it.
  std::map<std::pair<StableId, const scene::FieldInfo*>, std::size_t> joinable_;
};

// Returns edits of all fields of an entity's Transform but its parent.
std::vector<FieldEdit> transformEdits(ecs::Entity entity, const scene::Transform& to);
std::string entitiesName(const Document& document, std::span<const ecs::Entity> entities);
// Returns the name of a step: "move of ball", "strength of 3 entities".
std::string editName(const Document& document, std::span<const FieldEdit> edits);

}  // namespace lambent::editor
