// A bundle's description as entities: one root that places the whole, one entity per node (Name, StableId,
// Transform, CameraComponent and LocalLightComponent where it carries one), one per rigid group, per draw,
// per emissive material in a group that it lights, per animation, and per material. Several bundles, and one
// bundle several times under different instance numbers, may stand in one registry. Payloads are not touched:
// streaming brings them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/bundle/description.hpp"
#include "runtime/ecs/registry.hpp"

namespace lambent::scene {

struct InstantiateOptions {
  std::uint32_t bundle_index = 0;  // what components call the bundle by while the program runs
  std::string bundle_id;  // what StableIds call it by: the same in every session, e.g. its path in the world
  std::uint32_t instance = 0;
};

// Indices are those of the description.
struct SceneInstance {
  ecs::Entity root;
  std::vector<ecs::Entity> nodes;
  std::vector<ecs::Entity> groups;
  std::vector<ecs::Entity> draws;
  // Of each group, by light column: an entity with a LampComponent for a material, the node with its
  // LocalLightComponent for a lamp.
  std::vector<std::vector<ecs::Entity>> lamps;
  std::vector<ecs::Entity> animations;
  std::vector<ecs::Entity> materials;
};

// World matrices and groups are up to date on return (updateTransforms has run over the registry). The
// description is one that a Reader has checked. Error: the registry has this bundle and instance already.
Result<SceneInstance> instantiate(ecs::Registry& registry, const bundle::Description& description,
                                  const InstantiateOptions& options);

// Destroys its entities; those hung below them by others live on, in the world.
void destroyInstance(ecs::Registry& registry, const SceneInstance& instance);

}  // namespace lambent::scene
