#include "editor/panels/fields.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>
#include <imgui.h>
#include <imgui_stdlib.h>

#include "editor/document/actions.hpp"
#include "editor/document/field_use.hpp"
#include "editor/panels/field_words.hpp"
#include "editor/panels/panel.hpp"
#include "editor/session/light_units.hpp"
#include "editor/ui/fitting.hpp"

namespace lambent::editor {

namespace {

using scene::ComponentInfo;
using scene::FieldInfo;
using scene::Value;

constexpr float kDegrees = 180.0f / std::numbers::pi_v<float>;

void checked(Session& session, const Result<void>& done) {
  if (!done) session.log.error(done.error());
}

// Returns the value without a sign where it is shown as zero.
float unsignedZero(float value, int digits) {
  return std::abs(value) < 0.5f * std::pow(10.0f, static_cast<float>(-digits)) ? 0.0f : value;
}

// Edits three numbers beside each other, with as many digits as fit.
bool dragThree(float* values, float speed, int digits) {
  const float spacing = ImGui::GetStyle().ItemInnerSpacing.x;
  const float width = (ImGui::CalcItemWidth() - 2.0f * spacing) / 3.0f;
  const char* format = "%.4f";
  int fewest = digits;
  for (int i = 0; i < 3; ++i) {
    const char* own = numberFormat(values[i], width, digits);
    if (own[2] - '0' <= fewest) fewest = own[2] - '0', format = own;
  }
  float shown[3];
  for (int i = 0; i < 3; ++i) shown[i] = unsignedZero(values[i], fewest);
  if (!ImGui::DragFloat3("##value", shown, speed, 0.0f, 0.0f, format)) return false;
  for (int i = 0; i < 3; ++i)
    if (shown[i] != unsignedZero(values[i], fewest)) values[i] = shown[i];
  return true;
}

// Edits an angle in degrees, whatever unit the field has.
bool editNumber(const FieldInfo& field, float& value) {
  const bool angle = field.unit == "rad";
  float shown = unsignedZero(angle ? value * kDegrees : value, 6);
  float low = 0.0f, high = 0.0f, speed = angle ? 0.5f : 0.01f;
  if (field.range) {
    low = field.range->least, high = field.range->greatest;
    if (angle) low *= kDegrees, high *= kDegrees;
    if (high - low <= 10.0f) speed = 0.002f * (high - low);
  }
  if (!angle) speed = std::max(speed, 0.005f * std::abs(shown));
  const char* format = angle ? "%.1f°" : field.unit == "m" ? "%.3f m" : "%.4g";
  const bool changed = ImGui::DragFloat("##value", &shown, speed, low, high, format,
                                        field.range ? ImGuiSliderFlags_AlwaysClamp : ImGuiSliderFlags_None);
  if (changed) value = angle ? shown / kDegrees : shown;
  if (changed && field.range) value = std::clamp(value, field.range->least, field.range->greatest);
  return changed;
}

// Edits a rotation as Euler angles in degrees: the rotation about x is applied first, then y, then z.
bool editRotation(glm::quat& rotation, HeldAngles& held) {
  const bool same = std::abs(glm::dot(held.rotation, rotation)) > 1.0f - 1e-6f;
  glm::vec3 degrees = same ? held.degrees : glm::degrees(glm::eulerAngles(rotation));
  const bool changed = dragThree(&degrees.x, 0.5f, 1);
  if (changed) rotation = glm::normalize(glm::quat(glm::radians(degrees)));
  held = {rotation, degrees};
  return changed;
}

bool editWord(const FieldInfo& field, scene::Word& word, Marks& marks, const std::string& mark) {
  const bool open = ImGui::BeginCombo("##value", word.text.c_str());
  marks.put(mark);
  if (!open) return false;
  bool changed = false;
  for (const std::string_view name : field.words) {
    if (ImGui::Selectable(std::string(name).c_str(), word.text == name)) word.text = name, changed = true;
    marks.put(mark + "." + std::string(name));
  }
  ImGui::EndCombo();
  return changed;
}

// Edits which measured BRDF replaces a material's reflection, by its name.
bool editBrdf(const Session& session, ecs::Entity entity, std::int32_t& value) {
  const auto brdfs =
      measuredBrdfs(session, session.document.registry().get<scene::MaterialComponent>(entity));
  const auto found = std::ranges::find(brdfs, value, &std::pair<std::int32_t, std::string>::first);
  const std::string shown = value < 0              ? "none"
                            : found != brdfs.end() ? found->second
                                                   : fmt::format("number {}", value);
  if (!ImGui::BeginCombo("##value", shown.c_str())) return false;
  bool changed = false;
  if (ImGui::Selectable("none", value < 0)) value = -1, changed = true;
  for (const auto& [index, name] : brdfs)
    if (ImGui::Selectable(name.c_str(), value == index)) value = index, changed = true;
  ImGui::EndCombo();
  return changed;
}

// Edits the strength of a light in a unit that the user chooses.
bool editStrength(const Session& session, ecs::Entity entity, float& value) {
  const auto& light = session.document.registry().get<scene::LocalLightComponent>(entity);
  const LightUnit unit = unitOf(light, session.preferences.light_unit);
  const float unit_width = em(4.6f), spacing = ImGui::GetStyle().ItemInnerSpacing.x;
  ImGui::SetNextItemWidth(std::max(em(2.0f), ImGui::CalcItemWidth() - unit_width - spacing));
  double shown = double{value} * unit.factor;
  const float speed = 0.005f * std::max(0.1f, static_cast<float>(shown));
  const double least = 0.0, greatest = 1e9 * unit.factor;
  const bool changed = ImGui::DragScalar("##value", ImGuiDataType_Double, &shown, speed, &least, &greatest,
                                         "%.4g", ImGuiSliderFlags_AlwaysClamp);
  if (changed) value = static_cast<float>(shown / unit.factor);
  return changed;
}

// Draws the unit behind the strength. It is no part of the document.
void chooseUnit(Session& session, Marks& marks, ecs::Entity entity) {
  const auto& light = session.document.registry().get<scene::LocalLightComponent>(entity);
  const LightUnit unit = unitOf(light, session.preferences.light_unit);
  ImGui::SameLine(0.0f, ImGui::GetStyle().ItemInnerSpacing.x);
  ImGui::SetNextItemWidth(em(4.6f));
  const bool open =
      ImGui::BeginCombo("##unit", std::string(unit.name).c_str(), ImGuiComboFlags_NoArrowButton);
  marks.put("inspector.Light.unit");
  tooltip(unit.help);
  if (!open) return;
  for (const LightUnit& choice : unitsOf(light)) {
    if (ImGui::Selectable(std::string(choice.name).c_str(), choice.name == unit.name))
      session.preferences.light_unit = choice.name;
    tooltip(choice.help);
    marks.put("inspector.Light.unit." + std::string(choice.name));
  }
  ImGui::EndCombo();
}

bool isStrengthOfLight(const FieldInfo& field) {
  return field.component == scene::LocalLightComponent::kComponentName && field.name == "strength";
}

bool editValue(Session& session, Marks& marks, const FieldInfo& field, ecs::Entity entity, Value& value) {
  const std::string mark = fmt::format("inspector.{}.{}", field.component, field.name);
  ImGui::SetNextItemWidth(-ImGui::GetFrameHeight() - ImGui::GetStyle().ItemInnerSpacing.x);
  bool changed = false;
  if (auto* flag = std::get_if<bool>(&value)) {
    changed = ImGui::Checkbox("##value", flag);
  } else if (auto* number = std::get_if<float>(&value)) {
    changed = isStrengthOfLight(field) ? editStrength(session, entity, *number) : editNumber(field, *number);
  } else if (auto* word = std::get_if<scene::Word>(&value)) {
    return editWord(field, *word, marks, mark);
  } else if (auto* rotation = std::get_if<glm::quat>(&value)) {
    changed = editRotation(*rotation, session.angles);
  } else if (auto* whole = std::get_if<std::int32_t>(&value)) {
    changed = field.component == scene::MaterialComponent::kComponentName && field.name == "brdf"
                  ? editBrdf(session, entity, *whole)
                  : ImGui::DragInt("##value", whole, 0.1f);
  } else if (auto* text = std::get_if<std::string>(&value)) {
    changed = ImGui::InputText("##value", text);
  } else if (auto* vector = std::get_if<glm::vec3>(&value)) {
    // Three numbers take the room of a color's swatch where there is little.
    constexpr ImGuiColorEditFlags kColor = ImGuiColorEditFlags_Float | ImGuiColorEditFlags_HDR;
    const bool narrow = ImGui::CalcItemWidth() < em(13.0f);
    changed = field.color ? ImGui::ColorEdit3("##value", &vector->x,
                                              narrow ? kColor | ImGuiColorEditFlags_NoInputs : kColor)
                          : dragThree(&vector->x, 0.01f, 3);
  }
  marks.put(mark);
  return changed;
}

// Returns the name, unit and meaning of a field.
std::string helpOf(const FieldInfo& field, bool mixed) {
  std::string text = fmt::format("{}.{}", field.component, field.name);
  if (!field.unit.empty()) text += fmt::format(", {}", field.unit);
  if (const std::string_view help = fieldHelp(field.component, field.name); !help.empty())
    text += fmt::format("\n{}", help);
  if (mixed) text += "\nThe selected ones differ.";
  return text;
}

// Draws a button that sets the field back, where it differs from its default.
void drawReset(Session& session, Marks& marks, const FieldInfo& field,
               std::span<const ecs::Entity> entities) {
  const Baseline& baseline = session.changes.baseline();
  if (isDefault(session.document, baseline, entities.back(), field)) return;
  ImGui::SameLine(0.0f, ImGui::GetStyle().ItemInnerSpacing.x);
  if (ImGui::SmallButton("o"))
    checked(session, resetToDefault(session.document, session.history, baseline, entities, field.component,
                                    field.name));
  marks.put(fmt::format("inspector.reset.{}.{}", field.component, field.name));
  tooltip("Back to " + scene::valueText(defaultValue(session.document, baseline, entities.back(), field)));
}

void drawField(Session& session, Marks& marks, const FieldInfo& field,
               std::span<const ecs::Entity> entities) {
  const ecs::Entity primary = entities.back();
  Value value = field.get(session.document.registry(), primary);
  const bool mixed = std::any_of(entities.begin(), entities.end(), [&](ecs::Entity entity) {
    return !scene::sameBits(field.get(session.document.registry(), entity), value);
  });
  const std::string label = fieldLabel(field.component, field.name);
  ImGui::PushID(fmt::format("{}.{}", field.component, field.name).c_str());
  beginFieldRow(mixed ? label + " *" : label, helpOf(field, mixed));
  const bool changed = editValue(session, marks, field, primary, value);
  // A drag is one step, from its first pixel to its end; so is the time that a text field is open.
  if (ImGui::IsItemActivated())
    session.history.beginDrag(fmt::format("{} of {}", label, session.document.nameOf(primary)));
  if (changed) {
    std::vector<FieldEdit> edits;
    for (const ecs::Entity entity : entities) edits.push_back({entity, field.component, field.name, value});
    checked(session, session.history.setFields(edits));
  }
  if (ImGui::IsItemDeactivated()) session.history.endDrag();
  if (isStrengthOfLight(field)) chooseUnit(session, marks, primary);
  drawReset(session, marks, field, entities);
  ImGui::PopID();
}

}  // namespace

bool beginFieldTable(const char* id, float labels) {
  if (!ImGui::BeginTable(id, 2, ImGuiTableFlags_SizingStretchProp)) return false;
  ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthStretch, labels);
  ImGui::TableSetupColumn("value", ImGuiTableColumnFlags_WidthStretch, 1.0f - labels);
  return true;
}

void beginFieldRow(std::string_view label, std::string_view help) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::AlignTextToFramePadding();
  fittedText(label, help);
  ImGui::TableNextColumn();
}

void drawFields(Session& session, Marks& marks, const ComponentInfo& component,
                std::span<const ecs::Entity> entities) {
  if (!beginFieldTable(std::string(component.name).c_str())) return;
  for (const FieldInfo& field : component.fields)
    if (isUsed(session.document.registry(), entities.back(), field))
      drawField(session, marks, field, entities);
  if (component.name == scene::LocalLightComponent::kComponentName) {
    beginFieldRow("Exposure", "Of the whole picture, against which the light is seen");
    drawExposure(session, marks, "inspector.Light");
  }
  ImGui::EndTable();
}

}  // namespace lambent::editor
