#include "runtime/scene/lights.hpp"

#include <algorithm>
#include <string>

#include <glm/geometric.hpp>

namespace lambent::scene {
namespace {

using Kind = LocalLightComponent::Kind;

// Makes the brightest channel the strength, so that colours are within 0..1.
LocalLightComponent lightOf(Kind kind, float radius_m, glm::vec3 radiance) {
  const float strength = std::max({radiance.r, radiance.g, radiance.b});
  return {.kind = kind,
          .color = strength > 0.0f ? radiance / strength : glm::vec3(1.0f),
          .strength = strength,
          .radius_m = radius_m};
}

}  // namespace

glm::quat facing(glm::vec3 direction) {
  const glm::dvec3 to = glm::normalize(glm::dvec3(direction)), from(0.0, 0.0, -1.0);
  const double w = 1.0 + glm::dot(from, to);
  if (w < 1e-12) return {0.0f, 0.0f, 1.0f, 0.0f};  // half a turn about +Y
  const glm::dvec3 axis = glm::cross(from, to);
  return glm::quat(glm::normalize(glm::dquat(w, axis.x, axis.y, axis.z)));
}

std::vector<ecs::Entity> addLights(ecs::Registry& registry, std::span<const spec::Light> lights,
                                   const glm::dvec3& origin) {
  std::vector<ecs::Entity> entities;
  for (const spec::LocalLight& light : spec::localLights(lights, origin)) {
    const ecs::Entity entity = entities.emplace_back(registry.create());
    Transform place;
    if (const auto* sphere = std::get_if<spec::SphereLight>(&light)) {
      place.translation = glm::vec3(sphere->position_ws);
      registry.emplace<LocalLightComponent>(entity,
                                            lightOf(Kind::Sphere, sphere->radius_m, sphere->radiance));
    } else if (const auto* disc = std::get_if<spec::DiscLight>(&light)) {
      place.translation = glm::vec3(disc->position_ws);
      place.rotation = facing(disc->normal_ws);
      registry.emplace<LocalLightComponent>(entity, lightOf(Kind::Disc, disc->radius_m, disc->radiance));
    }
    registry.emplace<Transform>(entity, place);
    registry.emplace<Name>(entity, "light " + std::to_string(entities.size()));
  }
  return entities;
}

ecs::Entity addEnvironment(ecs::Registry& registry, const EnvironmentComponent& environment) {
  const ecs::Entity entity = registry.create();
  registry.emplace<Name>(entity, "environment");
  registry.emplace<EnvironmentComponent>(entity, environment);
  return entity;
}

}  // namespace lambent::scene
