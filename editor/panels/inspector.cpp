#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <imgui.h>
#include <nlohmann/json.hpp>

#include "editor/commands/command.hpp"
#include "editor/document/actions.hpp"
#include "editor/panels/colors.hpp"
#include "editor/panels/fields.hpp"
#include "editor/panels/object_materials.hpp"
#include "editor/panels/panel.hpp"
#include "editor/session/names.hpp"
#include "editor/ui/fitting.hpp"

namespace lambent::editor {

namespace {

using scene::ComponentInfo;

bool allCreated(const Session& session, std::span<const ecs::Entity> entities) {
  return std::ranges::all_of(entities, [&](ecs::Entity entity) { return session.document.created(entity); });
}

void drawComponentMenu(Session& session, const ComponentInfo& component,
                       std::span<const ecs::Entity> entities) {
  if (!ImGui::BeginPopupContextItem()) return;
  if (ImGui::MenuItem("Copy")) {
    if (auto text = copyComponent(session.document, entities.back(), component.name))
      ImGui::SetClipboardText(text->c_str());
    else
      session.log.error(text.error());
  }
  const char* clip = ImGui::GetClipboardText();
  const Clip held = peekClip(clip ? clip : "");
  if (ImGui::MenuItem("Paste", nullptr, false, held.kind == Pasted::Component))
    logRefusal(session, pasteComponent(session.document, session.history, entities, clip));
  if (ImGui::MenuItem("Reset"))
    logRefusal(session, resetToDefault(session.document, session.history, session.changes.baseline(),
                                       entities, component.name));
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
  if (name == scene::MaterialComponent::kComponentName) drawMaterialPictures(session, marks, entities.back());
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

// Returns the height of drawRebake: a line, a button and the reasons, each as a wrapped text behind a bullet.
float rebakeHeight(const std::vector<std::string>& reasons) {
  const ImGuiStyle& style = ImGui::GetStyle();
  const float wrap = ImGui::GetContentRegionAvail().x - ImGui::GetFontSize() - 2.0f * style.FramePadding.x;
  float height =
      ImGui::GetFrameHeightWithSpacing() + ImGui::GetTextLineHeightWithSpacing() + 4.0f * style.ItemSpacing.y;
  for (const std::string& reason : reasons)
    height += ImGui::CalcTextSize(reason.c_str(), nullptr, false, wrap).y + style.ItemSpacing.y;
  return height;
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
  const auto* draw = session.document.registry().tryGet<scene::DrawItem>(selected.back());
  const std::string name =
      draw ? fmt::format("primitive {} of {}", draw->primitive, session.document.nameOf(draw->node))
           : session.document.nameOf(selected.back());
  ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyle().Colors[ImGuiCol_TextDisabled]);
  fittedText(selected.size() == 1 ? name : fmt::format("{} and {} more", name, selected.size() - 1));
  ImGui::PopStyleColor();
  marks.put("inspector.name");
  for (const ComponentInfo& component : scene::components())
    drawComponent(session, marks, component, selected);
  drawPrimitive(session, marks, selected.back());
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
  const float below = reasons.empty() ? 0.0f : std::min(rebakeHeight(reasons), 0.4f * room);
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
