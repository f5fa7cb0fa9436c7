#include "editor/session/suns.hpp"

#include <array>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

#include "editor/gizmo/sun_gizmo.hpp"
#include "editor/session/key_lights.hpp"
#include "editor/session/session.hpp"
#include "runtime/scene/affine.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::editor {

namespace {

float turnOf(const Session& session) {
  const auto* environment =
      session.document.registry().tryGet<scene::EnvironmentComponent>(session.stage.environmentEntity());
  return environment ? environment->rotation_deg : 0.0f;
}

void addSunsOfWords(const Session& session, std::vector<SunOnSky>& suns) {
  const std::vector<std::string>& words = session.document.world().lights;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto light = spec::parseLight(words[i]);
    const auto* sun = light ? std::get_if<spec::SunLight>(&*light) : nullptr;
    if (sun)
      suns.push_back({.name = "sun",
                      .light = i,
                      .key = {},
                      .entity = {},
                      .towards_ws = towardsSun({sun->azimuth_deg, sun->elevation_deg}, turnOf(session)),
                      .world_from_node = glm::mat4(1.0f)});
  }
}

void addKeyLights(const Session& session, std::vector<SunOnSky>& suns) {
  const std::vector<KeyLight> keys = keyLightsOf(session);
  for (std::size_t i = 0; i < keys.size(); ++i)
    if (keys[i].in_map)
      suns.push_back({.name = "key light",
                      .light = {},
                      .key = i,
                      .entity = {},
                      .towards_ws = keys[i].towards_ws,
                      .world_from_node = glm::mat4(1.0f)});
}

}  // namespace

std::vector<SunOnSky> sunsOf(const Session& session) {
  std::vector<SunOnSky> suns;
  const ecs::Registry& registry = session.document.registry();
  for (const ecs::Entity entity : session.selection.entities(session.document)) {
    if (entity == session.stage.environmentEntity()) {
      addSunsOfWords(session, suns);
      addKeyLights(session, suns);
    }
    const auto* light = registry.tryGet<scene::LocalLightComponent>(entity);
    if (!light || light->kind != scene::LocalLightComponent::Kind::Directional) continue;
    if (!registry.has<scene::Transform>(entity)) continue;
    const glm::mat4 place = worldFromNode(registry, entity);
    // A directional light shines along its -Z.
    if (const glm::vec3 back(place[2]); glm::length(back) > 0.0f)
      suns.push_back({.name = session.document.nameOf(entity),
                      .light = {},
                      .key = {},
                      .entity = entity,
                      .towards_ws = glm::normalize(back),
                      .world_from_node = place});
  }
  return suns;
}

void moveSun(Session& session, const SunOnSky& start, const glm::vec3& towards_ws) {
  if (start.light) {
    const auto word = withSunDirection(session.document.world().lights[*start.light],
                                       skyDirection(towards_ws, turnOf(session)));
    if (!word) return session.log.error(word.error());
    session.history.editWorld("turn of sun", [&](WorldState& world) { world.lights[*start.light] = *word; });
    return;
  }
  if (start.key) {
    if (auto moved = moveKeyLight(session, *start.key, towards_ws); !moved) session.log.error(moved.error());
    return;
  }
  const ecs::Registry& registry = session.document.registry();
  const glm::mat4 turn = glm::mat4_cast(glm::quat(start.towards_ws, glm::normalize(towards_ws)));
  glm::mat4 world_from_node = turn * start.world_from_node;
  world_from_node[3] = start.world_from_node[3];
  scene::Transform to = registry.get<scene::Transform>(start.entity);
  scene::setLocalMatrix(
      to, glm::inverse(worldFromNode(registry, parentOf(registry, start.entity))) * world_from_node);
  const std::array<FieldEdit, 4> edits{{{start.entity, "Transform", "translation", to.translation},
                                        {start.entity, "Transform", "rotation", to.rotation},
                                        {start.entity, "Transform", "scale", to.scale},
                                        {start.entity, "Transform", "shear", to.shear}}};
  if (auto done = session.history.setFields(edits); !done) session.log.error(done.error());
}

std::string sunReadout(const Session& session, const SunOnSky& sun) {
  const SkyDirection now = skyDirection(sun.towards_ws, sun.light ? turnOf(session) : 0.0f);
  return fmt::format("azimuth {:.1f}, elevation {:.1f}", now.azimuth_deg, now.elevation_deg);
}

}  // namespace lambent::editor
