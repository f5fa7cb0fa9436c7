#include "editor/session/object_materials.hpp"

#include <algorithm>

#include "editor/session/session.hpp"

namespace lambent::editor {

std::vector<ecs::Entity> materialsOf(const Session& session, ecs::Entity object) {
  const ecs::Registry& registry = session.document.registry();
  std::vector<ecs::Entity> found;
  for (const auto [draw, item] : registry.view<const scene::DrawItem>()) {
    if (draw != object && item.node != object && !isBelow(registry, item.node, object)) continue;
    if (item.material < 0) continue;
    const ecs::Entity material =
        session.stage.world().instance(item.bundle).materials[static_cast<std::size_t>(item.material)];
    if (std::ranges::find(found, material) == found.end()) found.push_back(material);
  }
  return found;
}

std::vector<std::pair<std::int32_t, std::string>> measuredBrdfs(const Session& session,
                                                                const scene::MaterialComponent& material) {
  std::vector<std::pair<std::int32_t, std::string>> found;
  const auto& tables = session.stage.world().description(material.bundle).brdf_tables;
  for (std::size_t i = 0; i < tables.size(); ++i)
    if (tables[i].family == bundle::BrdfFamily::Measured)
      found.emplace_back(static_cast<std::int32_t>(i), tables[i].name);
  return found;
}

PrimitiveFacts factsOf(const Session& session, const scene::DrawItem& draw) {
  const bundle::Description& description = session.stage.world().description(draw.bundle);
  const bundle::Mesh& mesh = description.meshes[draw.mesh];
  const bundle::Primitive& primitive = mesh.primitives[draw.primitive];
  PrimitiveFacts facts{mesh.name, {}, primitive.vertex_count, primitive.index_count / 3};
  switch (description.draws[draw.draw].form()) {
    case transfer::Form::Matrix:
      facts.shading = "glossy, per pixel";
      break;
    case transfer::Form::NormalMapped:
      facts.shading = "diffuse, per pixel by its normal map";
      break;
    default:
      facts.shading = "diffuse, at its vertices";
      break;
  }
  return facts;
}

}  // namespace lambent::editor
