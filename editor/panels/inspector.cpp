#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <imgui.h>
#include <nlohmann/json.hpp>

#include "editor/commands/command.hpp"
#include "editor/panels/panel.hpp"
#include "editor/session/session.hpp"
#include "editor/ui/dear_imgui.hpp"
#include "editor/ui/marks.hpp"
#include "runtime/scene/materials.hpp"

namespace lambent::editor {

namespace {

// Returns the materials of all draws at and below a node, each once. They are none for other entities.
std::vector<ecs::Entity> materialsOf(const Session& session, ecs::Entity object) {
  const ecs::Registry& registry = session.document.registry();
  std::vector<ecs::Entity> found;
  for (const auto [draw, item] : registry.view<const scene::DrawItem>()) {
    if (item.material < 0 || !isBelow(registry, item.node, object)) continue;
    const ecs::Entity material =
        session.stage.world().instance(item.bundle).materials[static_cast<std::size_t>(item.material)];
    if (std::ranges::find(found, material) == found.end()) found.push_back(material);
  }
  return found;
}

// Lists the textures that the material of the file names.
void drawTextures(const Session& session, Marks& marks, ecs::Entity material) {
  const auto& component = session.document.registry().get<scene::MaterialComponent>(material);
  const bundle::Description& description = session.stage.world().description(component.bundle);
  gltf::forEachMaterialField([&](const auto& field) {
    if constexpr (std::is_same_v<typename std::remove_cvref_t<decltype(field)>::Value, gltf::TextureRef>) {
      const gltf::TextureRef& reference = description.materials[component.material].*field.member;
      if (reference.texture < 0) return;
      const std::int32_t image = description.textures[static_cast<std::size_t>(reference.texture)].image;
      if (image < 0) return;
      const std::string& name = description.images[static_cast<std::size_t>(image)].name;
      fittedText(dimmed(), fmt::format("{}: {}", fieldLabel("Material", field.name), name), field.name);
      marks.put("inspector.texture." + std::string(field.name));
    }
  });
}

void drawMaterial(Session& session, Marks& marks, ecs::Entity material) {
  const std::string name = session.document.nameOf(material);
  const glm::vec3& color = session.document.registry().get<scene::MaterialComponent>(material).base_color;
  ImGui::ColorButton("##color", ImVec4(color.r, color.g, color.b, 1.0f), ImGuiColorEditFlags_NoTooltip);
  ImGui::SameLine();
  const float select = ImGui::CalcTextSize("Select").x + 3.0f * ImGui::GetStyle().FramePadding.x;
  const std::string shown =
      ellipsized(name, ImGui::GetContentRegionAvail().x - select - ImGui::GetTreeNodeToLabelSpacing());
  const bool open = ImGui::TreeNodeEx("##fields", ImGuiTreeNodeFlags_FramePadding, "%s", shown.c_str());
  marks.put("inspector.material." + name);
  tooltip(name + "\nOpen it to edit it here");
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - select);
  if (ImGui::SmallButton("Select")) session.selection.set(session.document.idOf(material));
  marks.put("inspector.material." + name + ".select");
  if (!open) return;
  drawTextures(session, marks, material);
  const ecs::Entity one[] = {material};
  drawFields(session, marks, *scene::findComponent(scene::MaterialComponent::kComponentName), one);
  ImGui::TreePop();
}

// Draws the materials of an object with their fields; nothing for an entity without draws.
void drawObjectMaterials(Session& session, Marks& marks, ecs::Entity object) {
  const std::vector<ecs::Entity> materials = materialsOf(session, object);
  if (materials.empty()) return;
  const bool open = ImGui::CollapsingHeader("Materials", ImGuiTreeNodeFlags_DefaultOpen);
  marks.put("inspector.materials");
  if (!open) return;
  for (const ecs::Entity material : materials) {
    ImGui::PushID(static_cast<int>(material.index));
    drawMaterial(session, marks, material);
    ImGui::PopID();
  }
}

using scene::ComponentInfo;

bool allCreated(const Session& session, std::span<const ecs::Entity> entities) {
  return std::ranges::all_of(entities, [&](ecs::Entity entity) { return session.document.created(entity); });
}

void drawComponentMenu(Session& session, const ComponentInfo& component,
                       std::span<const ecs::Entity> entities) {
  if (!ImGui::BeginPopupContextItem()) return;
  const std::string name(component.name);
  if (ImGui::MenuItem("Reset")) runOrLog(session, "reset", std::array{name});
  if (component.removable && allCreated(session, entities) && ImGui::MenuItem("Remove")) {
    session.history.begin(
        fmt::format("removal of {} from {}", component.name, entitiesName(session.document, entities)));
    for (const ecs::Entity entity : entities)
      logRefusal(session, session.history.removeComponent(entity, component.name));
    session.history.commit();
  }
  ImGui::EndPopup();
}

// Draws a component that all selected entities have.
void drawComponent(Session& session, Marks& marks, const ComponentInfo& component,
                   std::span<const ecs::Entity> entities) {
  if (!std::ranges::all_of(
          entities, [&](ecs::Entity entity) { return component.has(session.document.registry(), entity); }))
    return;
  const std::string name(component.name);
  const bool open = ImGui::CollapsingHeader(name.c_str(), ImGuiTreeNodeFlags_DefaultOpen);
  marks.put("inspector." + name);
  drawComponentMenu(session, component, entities);
  if (!open) return;
  if (name == scene::MaterialComponent::kComponentName) drawTextures(session, marks, entities.back());
  drawFields(session, marks, component, entities);
}

// Draws a button that adds a component to all selected entities that lack it.
void drawAdd(Session& session, Marks& marks, std::span<const ecs::Entity> selected) {
  if (!allCreated(session, selected)) return;
  if (ImGui::Button("Add component")) ImGui::OpenPopup("add");
  marks.put("inspector.add");
  if (!ImGui::BeginPopup("add")) return;
  for (const ComponentInfo& component : scene::components()) {
    std::vector<ecs::Entity> lacking;
    for (const ecs::Entity entity : selected)
      if (!component.has(session.document.registry(), entity)) lacking.push_back(entity);
    if (!component.addable || lacking.empty()) continue;
    const std::string name(component.name);
    if (ImGui::MenuItem(name.c_str())) {
      session.history.begin(fmt::format("{} of {}", name, entitiesName(session.document, lacking)));
      for (const ecs::Entity entity : lacking)
        logRefusal(session, session.history.addComponent(entity, component.name));
      session.history.commit();
    }
    marks.put("inspector.add." + name);
  }
  ImGui::EndPopup();
}

// Lists what the picture only approximates since the bundle was baked, with a button to bake it again.
void drawRebake(Session& session, Marks& marks, std::size_t entry, const std::vector<std::string>& reasons) {
  ImGui::Separator();
  ImGui::PushStyleColor(ImGuiCol_Text, kWarningColor);
  ImGui::TextUnformatted("Needs a rebake");
  ImGui::PopStyleColor();
  if (ImGui::Button("Bake with these edits", ImVec2(-1.0f, 0.0f)))
    runOrLog(session, "bake", std::array{std::to_string(entry)});
  marks.put("inspector.rebake");
  ImGui::BeginChild("reasons");
  for (const std::string& reason : reasons) {
    ImGui::Bullet();
    ImGui::TextWrapped("%s", reason.c_str());
  }
  ImGui::EndChild();
}

void drawSelected(Session& session, Marks& marks, const std::vector<ecs::Entity>& selected) {
  const std::string name = session.document.nameOf(selected.back());
  fittedText(dimmed(),
             selected.size() == 1 ? name : fmt::format("{} and {} more", name, selected.size() - 1));
  marks.put("inspector.name");
  for (const ComponentInfo& component : scene::components())
    drawComponent(session, marks, component, selected);
  drawObjectMaterials(session, marks, selected.back());
  drawAdd(session, marks, selected);
}

}  // namespace

void drawInspector(Session& session, Marks& marks) {
  const std::vector<ecs::Entity> selected = session.selection.entities(session.document);
  const auto entry = sceneAtHand(session);
  const std::vector<std::string> reasons =
      entry ? session.changes.needsRebakeNow(*entry) : std::vector<std::string>();
  // The reasons stand below the fields, which must not move under the pointer while an edit gives a reason.
  const float room = ImGui::GetContentRegionAvail().y;
  // A title, a button, and a line for each reason; where these are wrapped, they scroll.
  const float lines = 3.5f + static_cast<float>(reasons.size());
  const float below =
      reasons.empty() ? 0.0f : std::min(lines * ImGui::GetFrameHeightWithSpacing(), 0.4f * room);
  ImGui::BeginChild("fields", ImVec2(0.0f, std::max(1.0f, room - below)));
  if (selected.empty()) {
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextDisabled("Nothing is selected: click in the view or in the tree.");
    ImGui::PopTextWrapPos();
  } else {
    drawSelected(session, marks, selected);
  }
  ImGui::EndChild();
  if (!reasons.empty()) drawRebake(session, marks, *entry, reasons);
}

}  // namespace lambent::editor
