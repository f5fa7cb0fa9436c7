// The room scene owns the scene as entities of a registry: it creates, moves, animates, edits and replaces
// them. Its systems are functions over a registry that only one thread may use at a time; bad input is
// returned as an Error.
//
// This header turns a bundle's description into entities: one root that places the whole, one per node (with
// Name, StableId, Transform and, if it has them, CameraComponent and LocalLightComponent), and one per rigid
// group, draw, animation and material, and per emissive material of each group that it lights. A registry may
// hold several bundles, and the same bundle several times under different instance numbers. Streaming loads
// the payloads.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/bundle/description.hpp"
#include "runtime/ecs/registry.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::scene {

struct InstantiateOptions {
  std::uint32_t bundle_index = 0;  // number of the bundle in components while the program runs
  std::string bundle_id;  // id for StableIds, equal in every session, such as the path in the world file
  std::uint32_t instance = 0;
};

// Lists the entities of an instance, with the indices of the description.
struct SceneInstance {
  ecs::Entity root;
  std::vector<ecs::Entity> nodes;
  std::vector<ecs::Entity> groups;
  std::vector<ecs::Entity> draws;
  // Holds, for each group and light column, an entity with a LampComponent for an emissive material, or the
  // node with a LocalLightComponent for a KHR light.
  std::vector<std::vector<ecs::Entity>> lamps;
  std::vector<ecs::Entity> animations;
  std::vector<ecs::Entity> materials;
};

// Adds the entities of a description that a Reader has checked. World matrices and groups are up to date on
// return, because it calls updateTransforms. Fails if the registry already has this bundle and instance.
Result<SceneInstance> instantiate(ecs::Registry& registry, const bundle::Description& description,
                                  const InstantiateOptions& options);

// Destroys the entities of an instance. Other entities that have one of them as parent stay alive, in the
// world.
void destroyInstance(ecs::Registry& registry, const SceneInstance& instance);

// Replaces a bundle in a registry by another one, which is the same scene baked better, or changed and baked
// again. Entities are matched by their StableIds. An entity of both bundles is kept, with all changes that
// the user made: declared fields that differ from the old bundle, components added or removed, another
// parent, destruction. All its other values come from the new bundle. Entities of the old bundle only are
// destroyed, and those of the new bundle only are created. playAnimations gives animated nodes a new pose
// from the new keys.

// Replaces `instance`, which was made from `before` with these options. World matrices and groups are up to
// date on return.
SceneInstance exchangeInstance(ecs::Registry& registry, const SceneInstance& instance,
                               const bundle::Description& before, const bundle::Description& now,
                               const InstantiateOptions& options);

// Makes entities for lights that belong to no bundle: local lights of the command line, with Name, Transform
// and LocalLightComponent, and the environment, with an EnvironmentComponent.

// Adds an entity for each local light (spec::localLights), in their order, at positions that count from the
// origin. The Transform of a disc rotates -Z to the direction in which it shines.
std::vector<ecs::Entity> addLights(ecs::Registry& registry, std::span<const spec::Light> lights,
                                   const glm::dvec3& origin = glm::dvec3(0.0));

// Returns the smallest rotation that takes -Z, along which lights shine, to the direction, which is not 0.
glm::quat facing(glm::vec3 direction);

ecs::Entity addEnvironment(ecs::Registry& registry, const EnvironmentComponent& environment = {});

}  // namespace lambent::scene
