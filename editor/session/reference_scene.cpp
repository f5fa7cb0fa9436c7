#include "editor/session/reference_scene.hpp"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "baker/import/gltf.hpp"
#include "baker/import/join_scenes.hpp"
#include "reference/reference.hpp"
#include "runtime/scene/components.hpp"

namespace lambent::editor {

namespace {

using scene::LocalLightComponent;
using Kind = LocalLightComponent::Kind;

bool isShape(Kind kind) {
  return kind == Kind::Sphere || kind == Kind::Disc;
}

template <typename Visitor>
void forEachLight(const ecs::Registry& registry, const Document& document, const Visitor& visit) {
  for (const auto [entity, light] : registry.view<const LocalLightComponent>())
    if (light.enabled && document.created(entity) && registry.has<scene::Transform>(entity))
      visit(light, worldFromNode(registry, entity), document.nameOf(entity));
}

gltf::Light::Type typeOf(Kind kind) {
  if (kind == Kind::Spot) return gltf::Light::Type::Spot;
  return kind == Kind::Directional ? gltf::Light::Type::Directional : gltf::Light::Type::Point;
}

}  // namespace

ReferenceLamps lampsOf(const ecs::Registry& registry, const Document& document) {
  ReferenceLamps found;
  forEachLight(registry, document,
               [&](const LocalLightComponent& light, const glm::mat4& place, const std::string& name) {
                 if (isShape(light.kind)) return;
                 found.lamps.push_back({{.name = name,
                                         .type = typeOf(light.kind),
                                         .color = light.color,
                                         .intensity = light.strength,
                                         .range_m = light.range_m,
                                         .inner_cone_rad = light.inner_cone_rad,
                                         .outer_cone_rad = light.outer_cone_rad},
                                        place});
               });
  return found;
}

std::string ReferenceLamps::text() const {
  std::string text;
  for (const Lamp& lamp : lamps) {
    const gltf::Light& l = lamp.light;
    text += fmt::format("{} {} {} {} {} {} {} {}", static_cast<int>(l.type), l.color.r, l.color.g, l.color.b,
                        l.intensity, l.range_m, l.inner_cone_rad, l.outer_cone_rad);
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 4; ++row) text += fmt::format(" {}", lamp.world_from_node[column][row]);
    text += '\n';
  }
  return text;
}

void addLamps(const ReferenceLamps& lamps, baker::Scene& scene) {
  for (const ReferenceLamps::Lamp& lamp : lamps.lamps) {
    gltf::Node node;
    node.name = lamp.light.name;
    node.parent_from_node = lamp.world_from_node;
    node.light = static_cast<std::int32_t>(scene.lights.size());
    scene.lights.push_back(lamp.light);
    scene.roots.push_back(static_cast<std::int32_t>(scene.nodes.size()));
    scene.nodes.push_back(std::move(node));
  }
}

std::vector<spec::Light> shapesOf(const ecs::Registry& registry, const Document& document) {
  std::vector<spec::Light> shapes;
  forEachLight(registry, document,
               [&](const LocalLightComponent& light, const glm::mat4& place, const std::string&) {
                 const glm::vec3 at(place[3]), radiance = light.power();
                 if (light.kind == Kind::Sphere)
                   shapes.emplace_back(spec::SphereLight{at, light.radius_m, radiance});
                 else if (light.kind == Kind::Disc)
                   shapes.emplace_back(
                       spec::DiscLight{at, -glm::normalize(glm::vec3(place[2])), light.radius_m, radiance});
               });
  return shapes;
}

Result<baker::Scene> makeReferenceScene(const std::vector<ReferencePart>& parts, const ReferenceLamps& lamps,
                                        float animation_s) {
  baker::Scene all;
  for (const ReferencePart& part : parts) {
    auto scene = baker::importScene(part.source, {});
    if (!scene) return failAgain(scene.error());
    baker::reference::poseAt(*scene, animation_s);
    baker::applyEdits(part.edits, *scene);
    if (all.source.empty()) all.source = part.source;
    const glm::mat4 world_from_scene =
        glm::translate(part.world_from_scene, glm::vec3(scene->origin - part.origin));
    baker::joinScene(std::move(*scene), part.name, world_from_scene, all);
  }
  addLamps(lamps, all);
  return all;
}

}  // namespace lambent::editor
