// Lights as entities that belong to no bundle: those that light words put into the scene, and the one that
// says how the environment stands. Comes in: lights as parsed. Goes out: entities with Name, Transform and
// LocalLightComponent, or EnvironmentComponent.
#pragma once

#include <span>
#include <vector>

#include "runtime/ecs/registry.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::scene {

// One entity for each light that stands in the scene (spec::localLights), in their order; a disc's Transform
// turns -Z to where it shines.
std::vector<ecs::Entity> addLights(ecs::Registry& registry, std::span<const spec::Light> lights);

ecs::Entity addEnvironment(ecs::Registry& registry, const EnvironmentComponent& environment = {});

}  // namespace lambent::scene
