// Holds the world that is edited: a registry that belongs to somebody else (frame::World), the rest of the
// world as a WorldState, and the names by which both are meant. Entities are known by StableId: bundles bring
// theirs; what a person makes gets one of its own and the mark Created. Handles may change (undo makes
// entities anew, a bundle is loaded again), ids do not, so selection, history and files keep ids. One thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <glm/mat4x4.hpp>

#include "editor/document/world_state.hpp"
#include "runtime/ecs/registry.hpp"
#include "runtime/scene/stable_id.hpp"

namespace lambent::editor {

using scene::StableId;

// The id of no entity.
inline constexpr StableId kNoId{};

// Marks what a person has made: it is saved whole, may be destroyed, and gains and loses components.
struct Created {};

// Returns the id of the one entity that says how the environment stands.
StableId environmentId();

// Writes an id as 16 hexadecimal digits, and reads it back.
std::string idText(StableId id);
std::optional<StableId> parseId(std::string_view text);

class Document {
 public:
  // seed: makes the ids that are given; by default it is another one each time, so that worlds of two people
  // can be merged. The registry outlives the document, or another is attached.
  explicit Document(ecs::Registry& registry, std::optional<std::uint64_t> seed = {});
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;

  ecs::Registry& registry() const { return *registry_; }
  // Edits this registry from now on, after the program made its world anew.
  void attach(ecs::Registry& registry);

  const WorldState& world() const { return world_; }
  // Sets it without a step in the history, for what is opened. Raises worldVersion() if it differs.
  void setWorld(WorldState world);
  std::uint64_t worldVersion() const { return world_version_; }

  // Returns the entity, or none if it is not there now.
  ecs::Entity find(StableId id) const;
  // Returns its id, or kNoId if it has none.
  StableId idOf(ecs::Entity entity) const;
  // Returns its id; an entity that has none gets one and becomes Created (the environment gets
  // environmentId()).
  StableId adopt(ecs::Entity entity);
  // Adopts all that lack an id and have a component that is described: lights that the command line put
  // there.
  void adoptAll();
  StableId newId();
  bool created(ecs::Entity entity) const { return registry_->has<Created>(entity); }

  // Returns "ball", or "entity 0123456789abcdef" where it has no name.
  std::string nameOf(ecs::Entity entity) const;
  std::string nameOf(StableId id) const;

 private:
  void index() const;

  ecs::Registry* registry_;
  WorldState world_;
  std::uint64_t world_version_ = 1;
  std::uint64_t seed_ = 0;
  std::uint32_t given_ = 0;
  // Ids to entities; looked through again when an id is missed and the ids have changed.
  mutable std::unordered_map<std::uint64_t, ecs::Entity> entities_;
  mutable std::uint64_t indexed_version_ = 0;
};

// ---- the hierarchy of Transforms

// Returns the parent, or none where it is no longer alive.
ecs::Entity parentOf(const ecs::Registry& registry, ecs::Entity entity);
// Returns whether `entity` is `ancestor` or hangs below it.
bool isBelow(const ecs::Registry& registry, ecs::Entity entity, ecs::Entity ancestor);
// Returns those given and all below them, each once, parents before children.
std::vector<ecs::Entity> withDescendants(const ecs::Registry& registry,
                                         const std::vector<ecs::Entity>& entities);
// Computes the matrix from the Transforms themselves, so that it is up to date between two updateTransforms
// too.
glm::mat4 worldFromNode(const ecs::Registry& registry, ecs::Entity entity);

}  // namespace lambent::editor
