#include "runtime/demo/stage.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>

#include "runtime/scene/instantiate.hpp"

namespace lambent::demo {

Result<lighting::Environment> loadEnvironment(const Options& options) {
  Result<lighting::Environment> environment =
      lighting::Environment::create(options.lights, options.fade_lights);
  if (!environment) return failAgain(environment.error());
  environment->setMostKeys(options.settings.mostKeys());
  environment->setKeyEdits(options.key_edits);
  for (const spec::KeyEdit& edit : options.key_edits)
    if (std::ranges::none_of(environment->foundKeys(),
                             [&](const lighting::Environment::FoundKey& key) { return key.edit == edit; }))
      fmt::print(stderr, "lambent-demo: {}: no key light was found there\n", spec::keyEditWord(edit));
  for (const std::string& notice : environment->notices()) fmt::print(stderr, "lambent-demo: {}\n", notice);
  return environment;
}

Stage::Stage(const Options& options, lighting::Environment environment)
    : world_({.max_resident_bytes = options.max_memory_bytes}), environment_(std::move(environment)) {}

Result<Stage> Stage::create(const Options& options, lighting::Environment environment) {
  Stage stage(options, std::move(environment));
  for (const std::filesystem::path& path : options.bundles)
    if (const auto opened = stage.world_.open(path); !opened) return failAgain(opened.error());
  stage.world_.scaleLamps(options.lamps);
  ecs::Registry& registry = stage.world_.registry();
  scene::addLights(registry, options.lights, stage.world_.origin());
  stage.environment_entity_ = scene::addEnvironment(registry);
  auto& component = registry.edit<scene::EnvironmentComponent>(stage.environment_entity_);
  component.rotation_deg = options.rotate_light_deg;
  component.fade = options.fade;
  stage.applyEnvironment();
  return stage;
}

void Stage::turnLight(float degrees) {
  world_.registry().edit<scene::EnvironmentComponent>(environment_entity_).rotation_deg = degrees;
  applyEnvironment();
}

void Stage::applyEnvironment() {
  const auto* component = world_.registry().tryGet<scene::EnvironmentComponent>(environment_entity_);
  if (!component) return;
  environment_.setTurn(component->rotation_deg);
  environment_.setFade(component->fade);
  environment_.setIntensity(component->intensity);
}

void Stage::dragLight(const spec::View& view, float right, float down) {
  ecs::Registry& registry = world_.registry();
  for (auto [entity, light] : registry.view<const scene::LocalLightComponent>()) {
    const auto* place = registry.tryGet<scene::WorldTransform>(entity);
    if (light.kind == scene::LocalLightComponent::Kind::Directional || !place) continue;
    const glm::vec3 position_vs(view.view_from_world * place->world_from_node[3]);
    // This is the picture's height at the light's distance; an orthographic picture is equally high
    // everywhere.
    const bool perspective = view.clip_from_view[2][3] != 0.0f;
    const float height = 2.0f / view.clip_from_view[1][1] * (perspective ? std::abs(position_vs.z) : 1.0f);
    const glm::vec3 by_vs = height * glm::vec3(right, -down, 0.0f);
    const glm::vec3 by_ws = glm::transpose(glm::mat3(view.view_from_world)) * by_vs;
    const auto& transform = registry.get<scene::Transform>(entity);
    const auto* parent = registry.tryGet<scene::WorldTransform>(transform.parent);
    const glm::mat3 parent_from_world =
        parent ? glm::inverse(glm::mat3(parent->world_from_node)) : glm::mat3(1.0f);
    const glm::vec3 by_parent = parent_from_world * by_ws;
    if (!glm::all(glm::equal(by_parent, by_parent))) return;  // its parent is scaled flat
    registry.edit<scene::Transform>(entity).translation += by_parent;
    return;
  }
}

}  // namespace lambent::demo
