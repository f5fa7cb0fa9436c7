// Undoes and redoes everything that is edited. Every edit goes through here: it is checked, carried out and
// kept as values before and after, by StableId, component and field, so that steps outlive the entities they
// speak of: made anew by undo, or gone and back with a bundle that was loaded again. Edits between begin()
// and commit() are one step, in which a field that is set a hundred times (a drag) is one pair of values.
// Errors change nothing. One thread.
#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "editor/document/document.hpp"
#include "editor/document/snapshot.hpp"
#include "runtime/base/result.hpp"
#include "runtime/scene/reflection.hpp"

namespace lambent::editor {

struct FieldEdit {
  ecs::Entity entity;
  std::string_view component, field;
  scene::Value value;
};

// Tells what undo and redo did. An entity or component that is not there now (its bundle was taken away, or
// came back without it) is passed over and named.
struct Replay {
  bool done = false;  // there was a step
  std::string name;   // its name
  std::vector<std::string> missing;
};

// A change of something that the document does not hold (which scenes are open); whoever holds it undoes it.
class OutsideChange {
 public:
  virtual ~OutsideChange() = default;
  // Does it again if `forth`, else takes it back. What cannot be done any more is named among the missing.
  virtual void carryOut(bool forth, std::vector<std::string>& missing) = 0;
  // Returns about how much memory it takes.
  virtual std::size_t bytes() const = 0;
};

class History {
 public:
  static constexpr std::size_t kDefaultBytes = std::size_t{64} << 20;

  // The document outlives the history. Beyond max_bytes the oldest steps are forgotten.
  explicit History(Document& document, std::size_t max_bytes = kDefaultBytes);

  // ---- Each of these edits is one step, unless a step is open.
  Result<void> setField(ecs::Entity entity, std::string_view component, std::string_view field,
                        scene::Value value);
  // Sets all of them or none.
  Result<void> setFields(std::span<const FieldEdit> edits, std::string name = {});
  // Does the same with values that stood there before (a bundle's), which ranges do not bind: only kinds
  // count.
  Result<void> restoreFields(std::span<const FieldEdit> edits, std::string name = {});
  // Makes an entity as the snapshot says. Errors: the parent has no Transform.
  Result<ecs::Entity> create(const EntitySnapshot& snapshot, std::string name = {});
  // Destroys them with what hangs below; bundles' nodes below stay where they are, in the world. Errors: one
  // that a person has not made.
  Result<void> destroy(std::span<const ecs::Entity> entities, std::string name = {});
  Result<void> destroy(ecs::Entity entity) { return destroy(std::span(&entity, 1)); }
  // Hangs them below `parent`, or in the world where that is none. keep_place: each stays where it is, and
  // its Transform changes. Errors: no Transform, a parent that is the entity or below it; a flat parent, if
  // the place is to be kept.
  Result<void> reparent(std::span<const ecs::Entity> entities, ecs::Entity parent, bool keep_place,
                        std::string name = {});
  Result<void> reparent(ecs::Entity entity, ecs::Entity parent, bool keep_place) {
    return reparent(std::span(&entity, 1), parent, keep_place);
  }
  // Work on what a person has made, where the component allows it.
  Result<void> addComponent(ecs::Entity entity, std::string_view component);
  Result<void> removeComponent(ecs::Entity entity, std::string_view component);
  // Replaces the environment, settings, camera and list of bundles. The program follows
  // Document::worldVersion().
  void setWorld(WorldState world, std::string name);
  // Lets `change` edit a copy of the world's state, and sets that.
  template <typename Change>
  void editWorld(std::string name, const Change& change) {
    WorldState world = document_.world();
    change(world);
    setWorld(std::move(world), std::move(name));
  }
  // Notes what has been done outside just now.
  void did(std::shared_ptr<OutsideChange> change, std::string name);

  // ---- Steps of several edits nest, and the outermost is the step.
  void begin(std::string name);
  void commit();
  void cancel();  // takes back what was edited since its begin()
  bool open() const { return !scopes_.empty(); }
  // A widget's drag is one step, from its first pixel to its end. Beginning one ends the one before; ending
  // none does nothing.
  void beginDrag(std::string name);
  void endDrag();

  // ---- Undo and redo commit a step that is open first.
  Replay undo();
  Replay redo();
  bool canUndo() const { return done_ > 0 || !current_.empty(); }
  bool canRedo() const { return current_.empty() && done_ < steps_.size(); }
  std::string undoName() const;  // "Undo move of ball"; "Undo" where there is nothing
  std::string redoName() const;
  // Return all steps, the oldest first, and how many of them are done: for a list of steps.
  std::vector<std::string> stepNames() const;
  std::size_t stepsDone() const { return done_; }

  bool modified() const;        // since markSaved()
  bool modifiedInside() const;  // by more than changes outside
  void markSaved();
  void clear();  // forgets all steps; what is there counts as saved
  std::size_t bytes() const { return bytes_; }
  // Rises with every edit, undo and redo.
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
    bool made;  // else destroyed
  };
  struct ComponentChange {
    StableId entity;
    ComponentValues values;
    bool added;  // else removed
  };
  struct WorldChange {
    WorldState before, after;
  };
  using Change = std::variant<FieldChange, ParentChange, EntityChange, ComponentChange, WorldChange,
                              std::shared_ptr<OutsideChange>>;
  struct Step {
    std::string name;
    std::vector<Change> changes;
    std::size_t bytes = 0;
  };
  struct Scope {
    std::string name;
    std::size_t first;  // change
    bool single;        // of one edit; joins the step around it
  };

  static std::size_t bytesOf(const Change& change);
  void beginEdit(std::string name);  // begin() and commit() of a single edit
  void endEdit();
  Result<void> editFields(std::span<const FieldEdit> edits, std::string name, bool in_range);
  void run(Change change);   // carries it out and puts it into the open step
  void keep(Change change);  // puts it there
  void apply(const Change& change, bool forth, std::vector<std::string>& missing);
  // Changes that hang an entity elsewhere; the Transform's where the place is kept.
  Result<std::vector<Change>> moves(ecs::Entity entity, ecs::Entity parent, bool keep_place);
  void push(std::string name, std::vector<Change> changes);
  void forgetOldest();
  Result<void> mayChangeComponents(ecs::Entity entity, const scene::ComponentInfo& component) const;

  Document& document_;
  std::size_t max_bytes_, bytes_ = 0;
  std::deque<Step> steps_;
  std::size_t done_ = 0;                    // of steps_
  std::uint64_t forgotten_ = 0;             // steps before the first of steps_
  std::optional<std::uint64_t> saved_ = 0;  // forgotten_ + done_ when it was saved; none: out of reach
  std::uint64_t version_ = 0;

  std::vector<Scope> scopes_;
  bool dragging_ = false;
  std::vector<Change> current_;
  // Where a field's change stands in current_: later ones join it.
  std::map<std::pair<StableId, const scene::FieldInfo*>, std::size_t> joinable_;
};

// Returns a name for the step: "move of ball", "strength of 3 entities".
std::string editName(const Document& document, std::span<const FieldEdit> edits);

}  // namespace lambent::editor
