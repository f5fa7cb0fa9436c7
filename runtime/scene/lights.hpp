// Makes entities for lights that belong to no bundle: local lights of the command line, with Name, Transform
// and LocalLightComponent, and the environment, with an EnvironmentComponent.
#pragma once

#include <span>
#include <vector>

#include "runtime/ecs/registry.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::scene {

// Adds an entity for each local light (spec::localLights), in their order, at positions that count from the
// origin. The Transform of a disc rotates -Z to the direction in which it shines.
std::vector<ecs::Entity> addLights(ecs::Registry& registry, std::span<const spec::Light> lights,
                                   const glm::dvec3& origin = glm::dvec3(0.0));

// Returns the smallest rotation that takes -Z, along which lights shine, to the direction, which is not 0.
glm::quat facing(glm::vec3 direction);

ecs::Entity addEnvironment(ecs::Registry& registry, const EnvironmentComponent& environment = {});

}  // namespace lambent::scene
