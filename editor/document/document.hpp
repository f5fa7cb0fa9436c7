// Holds the world that is edited: a registry that frame::World owns, the rest of the world as a WorldState,
// and the ids of its entities. Entities are identified by StableId. Bundles bring the ids of their entities;
// an entity that a person makes gets a new id and the component Created. Entity handles may change (undo
// creates entities anew, bundles are reloaded) but ids do not, so selection, history and files store ids.
// One thread.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include <glm/mat4x4.hpp>

#include "runtime/ecs/registry.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/scene/reflection.hpp"

namespace lambent::editor {

struct BundleEntry {
  std::string path;            // relative to the world file's folder, or absolute; '/' between folders
  std::string id;              // the bundle's part of a StableId (scene::InstantiateOptions::bundle_id)
  std::uint32_t instance = 0;  // distinguishes bundles of the same id
  std::string source;          // the glTF file that it was baked from, a path like `path`; empty: unknown
  std::map<std::string, std::string> bake_options;  // by name, as in Description::bake_options
  bool operator==(const BundleEntry&) const = default;
};

// Holds all of a world except its entities. It is a plain value: the history stores it before and after a
// step, world files store it, and the program follows it. Words are those of the command line
// (docs/conventions.md). Paths are as in the world file.
struct WorldState {
  std::vector<BundleEntry> bundles;
  // Distant lights, in the words of --light and --fade-light. Lights within the scene are entities;
  // intensity, rotation and fade are fields of the EnvironmentComponent.
  std::vector<std::string> lights, fade_lights;
  // Edits of key lights that were found in the environment maps among these lights, in the words of
  // --edit-key.
  std::vector<std::string> key_edits;
  std::optional<float> exposure_ev;             // none: automatic
  std::map<std::string, std::string> settings;  // of the frame, by option name
  std::map<std::string, std::string> view;      // of the editor: free camera, panels
  bool operator==(const WorldState&) const = default;
};

using scene::StableId;

// This id belongs to no entity.
inline constexpr StableId kNoId{};

// Marks an entity that a person has made. It is saved completely, can be destroyed, and can gain and lose
// components.
struct Created {};

// Returns the id of the one entity that holds the EnvironmentComponent.
StableId environmentId();

// Convert an id to 16 hexadecimal digits and back.
std::string idText(StableId id);
std::optional<StableId> parseId(std::string_view text);

class Document {
 public:
  // seed: determines the ids of new entities. By default it differs each time, so that the worlds of two
  // people can be merged. The registry must outlive the document.
  explicit Document(ecs::Registry& registry, std::optional<std::uint64_t> seed = {});
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;

  ecs::Registry& registry() const { return *registry_; }

  const WorldState& world() const { return world_; }
  // Sets the state without a step in the history, as when a file is opened. Raises worldVersion() if the
  // state differs.
  void setWorld(WorldState world);
  std::uint64_t worldVersion() const { return world_version_; }

  // Returns the entity, or none if it does not exist at present.
  ecs::Entity find(StableId id) const;
  StableId idOf(ecs::Entity entity) const;
  // Returns the entity's id. An entity without id gets one and becomes Created (the environment gets
  // environmentId()).
  StableId adopt(ecs::Entity entity);
  // Adopts all entities that have a described component but no id, such as lights from the command line.
  void adoptAll();
  StableId newId();
  bool created(ecs::Entity entity) const { return registry_->has<Created>(entity); }

  // Returns the entity's name, or "entity 0123456789abcdef" if it has none.
  std::string nameOf(ecs::Entity entity) const;
  std::string nameOf(StableId id) const;

 private:
  void index() const;

  ecs::Registry* registry_;
  WorldState world_;
  std::uint64_t world_version_ = 1;
  std::uint64_t seed_ = 0;
  std::uint32_t given_ = 0;
  // Maps ids to entities. It is rebuilt when an id is not found and the ids have changed.
  mutable std::unordered_map<std::uint64_t, ecs::Entity> entities_;
  mutable std::uint64_t indexed_version_ = 0;
};

// ---- The hierarchy of Transforms.

// Returns the parent, or none if it is no longer alive.
ecs::Entity parentOf(const ecs::Registry& registry, ecs::Entity entity);
bool isBelow(const ecs::Registry& registry, ecs::Entity entity, ecs::Entity ancestor);
// Returns the entities and their descendants, each once, parents before children.
std::vector<ecs::Entity> withDescendants(const ecs::Registry& registry,
                                         const std::vector<ecs::Entity>& entities);
// Computes the matrix from the Transforms themselves, so that it is also current between two calls of
// updateTransforms.
glm::mat4 worldFromNode(const ecs::Registry& registry, ecs::Entity entity);

// Copies the editable state of an entity out of a registry as plain values, and creates an entity from it.
// The history, the clipboard and duplicate use these snapshots.

// Holds all fields of one component, in the order of ComponentInfo::fields.
struct ComponentValues {
  const scene::ComponentInfo* component = nullptr;
  std::vector<scene::Value> values;
};

struct EntitySnapshot {
  StableId id;      // kNoId: a new id is given
  StableId parent;  // kNoId: the world
  std::vector<ComponentValues> components;

  const scene::Value* find(std::string_view component, std::string_view field) const;
  // Sets a field of a component that the snapshot has.
  void put(std::string_view component, std::string_view field, scene::Value value);
};

ComponentValues componentValues(const ecs::Registry& registry, ecs::Entity entity,
                                const scene::ComponentInfo& component);
// Takes a snapshot of an entity that has an id (Document::adopt).
EntitySnapshot takeSnapshot(const Document& document, ecs::Entity entity);
// Creates a Created entity with these components, below the world if its parent does not exist.
ecs::Entity makeEntity(Document& document, const EntitySnapshot& snapshot);

// Return what the Create menu makes. Each has a Name and a Transform.
EntitySnapshot emptyEntity(std::string name);
EntitySnapshot lightEntity(std::string_view kind, std::string name);  // kind: a word of Light.kind
EntitySnapshot cameraEntity(std::string name);

}  // namespace lambent::editor
