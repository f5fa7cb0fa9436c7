#include <array>
#include <numbers>

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>
#include <imgui.h>
#include <imgui_stdlib.h>
#include <nlohmann/json.hpp>

#include "editor/commands/command.hpp"
#include "editor/document/actions.hpp"
#include "editor/panels/colors.hpp"
#include "editor/panels/panel.hpp"
#include "editor/session/names.hpp"

namespace lambent::editor {

namespace {

using scene::ComponentInfo;
using scene::FieldInfo;
using scene::Value;

struct Edited {
  bool changed = false;  // in this frame
  bool active = false;   // is being dragged or typed
};

void checked(Session& session, const Result<void>& done) {
  if (!done) session.log.error(done.error());
}

// Edits an angle in degrees, whatever unit the field has.
constexpr float kDegrees = 180.0f / std::numbers::pi_v<float>;

Edited editNumber(const FieldInfo& field, float& value) {
  const bool angle = field.unit == "rad";
  float shown = angle ? value * kDegrees : value;
  float low = 0.0f, high = 0.0f, speed = angle ? 0.5f : 0.01f;
  if (field.range) {
    low = field.range->least, high = field.range->greatest;
    if (angle) low *= kDegrees, high *= kDegrees;
    if (high - low <= 10.0f) speed = 0.002f * (high - low);
  }
  if (!angle) speed = std::max(speed, 0.005f * std::abs(shown));
  const char* format = angle ? "%.1f deg" : field.unit == "m" ? "%.3f m" : "%.4g";
  Edited edited;
  edited.changed = ImGui::DragFloat("##value", &shown, speed, low, high, format,
                                    field.range ? ImGuiSliderFlags_AlwaysClamp : ImGuiSliderFlags_None);
  edited.active = ImGui::IsItemActive();
  if (edited.changed) value = angle ? shown / kDegrees : shown;
  if (edited.changed && field.range) value = std::clamp(value, field.range->least, field.range->greatest);
  return edited;
}

// Edits a rotation as Euler angles in degrees: the rotation about x is applied first, then y, then z.
Edited editRotation(glm::quat& rotation) {
  glm::vec3 degrees = glm::degrees(glm::eulerAngles(rotation));
  Edited edited;
  edited.changed = ImGui::DragFloat3("##value", &degrees.x, 0.5f, 0.0f, 0.0f, "%.1f");
  edited.active = ImGui::IsItemActive();
  if (edited.changed) rotation = glm::normalize(glm::quat(glm::radians(degrees)));
  return edited;
}

Edited editWord(const FieldInfo& field, scene::Word& word) {
  Edited edited;
  if (!ImGui::BeginCombo("##value", word.text.c_str())) return edited;
  for (const std::string_view name : field.words)
    if (ImGui::Selectable(std::string(name).c_str(), word.text == name))
      word.text = name, edited.changed = true;
  ImGui::EndCombo();
  return edited;
}

Edited editValue(const FieldInfo& field, Value& value) {
  ImGui::SetNextItemWidth(-28.0f);
  if (auto* flag = std::get_if<bool>(&value)) return {ImGui::Checkbox("##value", flag), false};
  if (auto* number = std::get_if<float>(&value)) return editNumber(field, *number);
  if (auto* word = std::get_if<scene::Word>(&value)) return editWord(field, *word);
  if (auto* rotation = std::get_if<glm::quat>(&value)) return editRotation(*rotation);
  Edited edited;
  if (auto* whole = std::get_if<std::int32_t>(&value)) {
    edited.changed = ImGui::DragInt("##value", whole, 0.1f);
  } else if (auto* text = std::get_if<std::string>(&value)) {
    edited.changed = ImGui::InputText("##value", text, ImGuiInputTextFlags_EnterReturnsTrue);
    return edited;
  } else if (auto* vector = std::get_if<glm::vec3>(&value)) {
    edited.changed = field.color ? ImGui::ColorEdit3("##value", &vector->x,
                                                     ImGuiColorEditFlags_Float | ImGuiColorEditFlags_HDR)
                                 : ImGui::DragFloat3("##value", &vector->x, 0.01f, 0.0f, 0.0f, "%.3f");
  }
  edited.active = ImGui::IsItemActive();
  return edited;
}

// Draws a field of the primary entity. An edit sets it for all the given entities.
void drawField(Session& session, Marks& marks, const FieldInfo& field,
               std::span<const ecs::Entity> entities) {
  const ecs::Entity primary = entities.back();
  Value value = field.get(session.document.registry(), primary);
  const std::string name = fmt::format("{}.{}", field.component, field.name);
  ImGui::PushID(name.c_str());
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::AlignTextToFramePadding();
  const bool mixed = std::any_of(entities.begin(), entities.end(), [&](ecs::Entity entity) {
    return !scene::sameBits(field.get(session.document.registry(), entity), value);
  });
  ImGui::Text("%s%s", std::string(field.name).c_str(), mixed ? " *" : "");
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("%s%s%s%s", name.c_str(), field.unit.empty() ? "" : ", ",
                      std::string(field.unit).c_str(), mixed ? "; the selected ones differ" : "");
  ImGui::TableNextColumn();
  const Edited edited = editValue(field, value);
  marks.put("inspector." + name);
  // A drag is one step, from its first pixel to its end.
  if (ImGui::IsItemActivated())
    session.history.beginDrag(fmt::format("{} of {}", field.name, session.document.nameOf(primary)));
  if (edited.changed) {
    std::vector<FieldEdit> edits;
    for (const ecs::Entity entity : entities) edits.push_back({entity, field.component, field.name, value});
    checked(session, session.history.setFields(edits));
  }
  if (ImGui::IsItemDeactivated()) session.history.endDrag();
  if (!isDefault(session.document, session.changes.baseline(), primary, field)) {
    ImGui::SameLine(0.0f, 4.0f);
    if (ImGui::SmallButton("o"))
      checked(session, resetToDefault(session.document, session.history, session.changes.baseline(), entities,
                                      field.component, field.name));
    marks.put("inspector.reset." + name);
    if (ImGui::IsItemHovered())
      ImGui::SetTooltip(
          "Back to %s",
          scene::valueText(defaultValue(session.document, session.changes.baseline(), primary, field))
              .c_str());
  }
  ImGui::PopID();
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
    checked(session, pasteComponent(session.document, session.history, entities, clip));
  if (ImGui::MenuItem("Reset"))
    checked(session, resetToDefault(session.document, session.history, session.changes.baseline(), entities,
                                    component.name));
  if (component.removable && session.document.created(entities.back()) && ImGui::MenuItem("Remove"))
    for (const ecs::Entity entity : entities)
      checked(session, session.history.removeComponent(entity, component.name));
  ImGui::EndPopup();
}

void drawComponent(Session& session, Marks& marks, const ComponentInfo& component,
                   std::span<const ecs::Entity> selected) {
  const ecs::Registry& registry = session.document.registry();
  std::vector<ecs::Entity> entities;
  for (const ecs::Entity entity : selected)
    if (component.has(registry, entity)) entities.push_back(entity);
  if (entities.empty() || entities.back() != selected.back()) return;
  const std::string name(component.name);
  const bool open = ImGui::CollapsingHeader(name.c_str(), ImGuiTreeNodeFlags_DefaultOpen);
  marks.put("inspector." + name);
  drawComponentMenu(session, component, entities);
  if (!open || !ImGui::BeginTable(name.c_str(), 2, ImGuiTableFlags_SizingStretchProp)) return;
  ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthStretch, 0.38f);
  ImGui::TableSetupColumn("value", ImGuiTableColumnFlags_WidthStretch, 0.62f);
  for (const FieldInfo& field : component.fields) drawField(session, marks, field, entities);
  ImGui::EndTable();
}

void drawAdd(Session& session, Marks& marks, std::span<const ecs::Entity> selected) {
  if (!session.document.created(selected.back())) return;
  if (ImGui::Button("Add component")) ImGui::OpenPopup("add");
  marks.put("inspector.add");
  if (!ImGui::BeginPopup("add")) return;
  for (const ComponentInfo& component : scene::components()) {
    if (!component.addable || component.has(session.document.registry(), selected.back())) continue;
    if (ImGui::MenuItem(std::string(component.name).c_str()))
      checked(session, session.history.addComponent(selected.back(), component.name));
  }
  ImGui::EndPopup();
}

// Lists what the picture only approximates since the bundle was baked, with a button to bake it again.
void drawRebake(Session& session, Marks& marks) {
  const auto entry = sceneAtHand(session);
  if (!entry) return;
  const std::vector<std::string>& reasons = session.changes.needsRebakeNow(*entry);
  if (reasons.empty()) return;
  ImGui::PushStyleColor(ImGuiCol_Text, kWarningColor);
  ImGui::TextUnformatted("Needs a rebake");
  ImGui::PopStyleColor();
  for (const std::string& reason : reasons) {
    ImGui::Bullet();
    ImGui::TextWrapped("%s", reason.c_str());
  }
  if (ImGui::Button("Bake with these edits", ImVec2(-1.0f, 0.0f)))
    if (auto done = runCommand(session, "bake", std::array{std::to_string(*entry)}); !done)
      session.log.error(done.error());
  marks.put("inspector.rebake");
  ImGui::Separator();
}

}  // namespace

void drawInspector(Session& session, Marks& marks) {
  const std::vector<ecs::Entity> selected = session.selection.entities(session.document);
  if (selected.empty()) {
    ImGui::TextDisabled("Nothing is selected: click in the view or in the tree.");
    drawRebake(session, marks);
    return;
  }
  ImGui::TextDisabled(
      "%s", selected.size() == 1
                ? session.document.nameOf(selected.back()).c_str()
                : fmt::format("{} and {} more", session.document.nameOf(selected.back()), selected.size() - 1)
                      .c_str());
  marks.put("inspector.name");
  drawRebake(session, marks);
  for (const ComponentInfo& component : scene::components())
    drawComponent(session, marks, component, selected);
  drawAdd(session, marks, selected);
}

}  // namespace lambent::editor
