#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>
#include <imgui.h>
#include <imgui_internal.h>
#include <imgui_stdlib.h>

#include "editor/document/actions.hpp"
#include "editor/panels/panel.hpp"
#include "editor/session/field_numbers.hpp"
#include "editor/ui/dear_imgui.hpp"
#include "runtime/scene/materials.hpp"

namespace lambent::editor {

namespace {

constexpr double kFine = 0.1, kCoarse = 10.0;

}  // namespace

bool dragNumber(const char* label, double& number, const NumberLook& look) {
  const ImGuiIO& io = ImGui::GetIO();
  // Dear ImGui has Shift for ten times as fast and Alt for a hundredth.
  const double factor = (io.KeyShift ? 0.1 * kFine : 1.0) * (io.KeyAlt ? 100.0 * kCoarse : 1.0);
  return ImGui::DragScalar(label, ImGuiDataType_Double, &number, static_cast<float>(look.speed * factor),
                           &look.least, &look.most, look.mixed ? kMixedText : look.format,
                           ImGuiSliderFlags_NoRoundToFormat | ImGuiSliderFlags_AlwaysClamp);
}

bool dragNumber(const char* label, float& number, const NumberLook& look) {
  double wide = double{number};
  if (!dragNumber(label, wide, look)) return false;
  number = static_cast<float>(wide);
  return true;
}

namespace {

using scene::ComponentInfo;
using scene::FieldInfo;
using scene::Value;

// Returns the value without a sign where it is shown as zero.
double unsignedZero(double value, int digits) {
  return std::abs(value) < 0.5 * std::pow(10.0, -digits) ? 0.0 : value;
}

// Returns how a number of the field is dragged and shown.
NumberLook lookOf(const FieldInfo& field, double shown) {
  NumberLook look;
  const bool angle = field.unit == "rad" || field.kind == scene::ValueKind::Rotation;
  if (isStrengthOfLight(field)) {
    // Lights are compared by ratios.
    look.scales = true;
    look.speed = 0.005 * std::max(0.1, shown);
    look.most = std::numeric_limits<float>::max();
    look.format = "%.4g";
    return look;
  }
  if (angle) look.speed = 0.5;
  if (field.kind == scene::ValueKind::Vector || field.kind == scene::ValueKind::Rotation) return look;
  look.format = angle ? "%.1f°" : field.unit == "m" ? "%.3f m" : "%.4g";
  if (field.range) {
    const double to_shown = angle ? double{glm::degrees(1.0f)} : 1.0;
    look.least = to_shown * double{field.range->least}, look.most = to_shown * double{field.range->greatest};
    if (look.most - look.least <= 10.0) look.speed = 0.002 * (look.most - look.least);
  }
  if (!angle) look.speed = std::max(look.speed, 0.005 * std::abs(shown));
  return look;
}

// Returns a format for three numbers beside each other, with as many digits as fit for each.
const char* formatOfThree(const std::vector<double>& numbers, float width, int digits) {
  const char* format = nullptr;
  for (const double number : numbers) {
    const char* own = numberFormat(static_cast<float>(number), width, digits);
    if (!format || own[2] < format[2]) format = own;  // "%.3f"
  }
  return format;
}

// A field of the selected entities, the primary last.
struct FieldRow {
  const FieldInfo& field;
  std::span<const ecs::Entity> entities;
  std::vector<Value> values;
  bool mixed = false;

  ecs::Entity primary() const { return entities.back(); }
  std::string mark() const { return fmt::format("inspector.{}.{}", field.component, field.name); }
};

// Edits the numbers of a field, which lie beside each other. A drag shifts or scales those of all entities by
// the same, and a typed number sets them alike. Returns the values of all entities if they changed.
std::optional<std::vector<Value>> editNumbers(Session& session, Marks& marks, const FieldRow& row) {
  constexpr std::array kAxes = {".x", ".y", ".z"};
  std::vector<std::vector<double>> numbers;
  for (std::size_t i = 0; i < row.values.size(); ++i)
    numbers.push_back(numbersOf(session, row.field, row.entities[i], row.values[i]));
  const std::vector<double> shown = numbers.back();
  const float spacing = ImGui::GetStyle().ItemInnerSpacing.x;
  const auto count = static_cast<float>(shown.size());
  const float width = (ImGui::CalcItemWidth() - (count - 1.0f) * spacing) / count;
  const int digits = row.field.kind == scene::ValueKind::Rotation ? 1 : 3;
  bool changed = false;
  ImGui::BeginGroup();
  for (std::size_t channel = 0; channel < shown.size(); ++channel) {
    NumberLook look = lookOf(row.field, shown[channel]);
    if (shown.size() > 1) look.format = formatOfThree(shown, width, digits);
    // Rotations of the same angles differ in their last bits.
    const double same = row.field.kind == scene::ValueKind::Rotation ? 1e-3 : 0.0;
    look.mixed = row.mixed && std::ranges::any_of(numbers, [&](const std::vector<double>& other) {
                   return std::abs(other[channel] - shown[channel]) > same;
                 });
    ImGui::PushID(static_cast<int>(channel));
    if (channel > 0) ImGui::SameLine(0.0f, spacing);
    ImGui::SetNextItemWidth(std::max(1.0f, width));
    const double from = unsignedZero(shown[channel], shown.size() > 1 ? look.format[2] - '0' : 6);
    double to = from;
    if (dragNumber("##value", to, look)) {
      const bool typed = ImGui::TempInputIsActive(ImGui::GetID("##value"));
      for (std::vector<double>& own : numbers)
        own[channel] = typed                        ? to
                       : look.scales && from != 0.0 ? own[channel] * (to / from)
                                                    : own[channel] + (to - from);
      changed = true;
    }
    if (shown.size() > 1) marks.put(row.mark() + kAxes[channel]);
    ImGui::PopID();
  }
  ImGui::EndGroup();
  if (!changed) return std::nullopt;
  std::vector<Value> after;
  if (row.field.kind == scene::ValueKind::Rotation) session.angles.clear();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    after.push_back(valueOf(session, row.field, row.entities[i], numbers[i]));
    if (const auto* rotation = std::get_if<glm::quat>(&after.back()))
      session.angles.push_back({*rotation, glm::vec3(numbers[i][0], numbers[i][1], numbers[i][2])});
  }
  return after;
}

bool editFieldWord(const FieldRow& row, scene::Word& word, Marks& marks) {
  const bool open = ImGui::BeginCombo("##value", row.mixed ? kMixedText : word.text.c_str());
  marks.put(row.mark());
  if (!open) return false;
  bool changed = false;
  for (const std::string_view name : row.field.words) {
    if (ImGui::Selectable(std::string(name).c_str(), !row.mixed && word.text == name))
      word.text = name, changed = true;
    marks.put(row.mark() + "." + std::string(name));
  }
  ImGui::EndCombo();
  return changed;
}

// Returns the measured BRDFs of the bundle that the material belongs to: values of its field, and names.
std::vector<std::pair<std::int32_t, std::string>> measuredBrdfs(const Session& session,
                                                                const scene::MaterialComponent& material) {
  std::vector<std::pair<std::int32_t, std::string>> found;
  const auto& tables = session.stage.world().description(material.bundle).brdf_tables;
  for (std::size_t i = 0; i < tables.size(); ++i)
    if (tables[i].family == bundle::BrdfFamily::Measured)
      found.emplace_back(static_cast<std::int32_t>(i), tables[i].name);
  return found;
}

// Edits which measured BRDF replaces a material's reflection, by its name.
bool editBrdf(const Session& session, const FieldRow& row, std::int32_t& value) {
  const auto brdfs =
      measuredBrdfs(session, session.document.registry().get<scene::MaterialComponent>(row.primary()));
  const auto found = std::ranges::find(brdfs, value, &std::pair<std::int32_t, std::string>::first);
  const std::string shown = row.mixed              ? kMixedText
                            : value < 0            ? "none"
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

// Edits a color of all entities. A dash on the swatch says that they differ.
bool editColor(const FieldRow& row, glm::vec3& color) {
  constexpr ImGuiColorEditFlags kColor = ImGuiColorEditFlags_Float | ImGuiColorEditFlags_HDR;
  // Three numbers take the room of a color's swatch where there is little, and mean nothing where they
  // differ.
  const bool swatch_only = row.mixed || ImGui::CalcItemWidth() < em(13.0f);
  const bool changed =
      ImGui::ColorEdit3("##value", &color.x, swatch_only ? kColor | ImGuiColorEditFlags_NoInputs : kColor);
  if (row.mixed) {
    const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
    const ImVec2 size = ImGui::CalcTextSize(kMixedText);
    const ImVec2 at(0.5f * (low.x + high.x - size.x), 0.5f * (low.y + high.y - size.y));
    ImGui::GetWindowDrawList()->AddText(ImVec2(at.x + 1.0f, at.y + 1.0f), IM_COL32_BLACK, kMixedText);
    ImGui::GetWindowDrawList()->AddText(at, IM_COL32_WHITE, kMixedText);
  }
  return changed;
}

// Edits a value that is not made of numbers. All entities get the same.
bool editWhole(Session& session, Marks& marks, const FieldRow& row, Value& value) {
  if (auto* flag = std::get_if<bool>(&value)) {
    ImGui::PushItemFlag(ImGuiItemFlags_MixedValue, row.mixed);
    const bool changed = ImGui::Checkbox("##value", flag);
    ImGui::PopItemFlag();
    if (changed && row.mixed) *flag = true;
    return changed;
  }
  if (auto* word = std::get_if<scene::Word>(&value)) return editFieldWord(row, *word, marks);
  if (auto* whole = std::get_if<std::int32_t>(&value)) return editBrdf(session, row, *whole);
  if (auto* color = std::get_if<glm::vec3>(&value)) return editColor(row, *color);
  auto* text = std::get_if<std::string>(&value);
  if (!text) return false;
  if (row.mixed) text->clear();
  return ImGui::InputTextWithHint("##value", kMixedText, text);
}

// Draws the widget, and returns the values of all entities if it changed them.
std::optional<std::vector<Value>> editValues(Session& session, Marks& marks, const FieldRow& row) {
  const float unit = isStrengthOfLight(row.field) ? em(4.6f) + ImGui::GetStyle().ItemInnerSpacing.x : 0.0f;
  ImGui::SetNextItemWidth(
      std::min(-ImGui::GetFrameHeight() - ImGui::GetStyle().ItemInnerSpacing.x - unit, -1.0f));
  if (hasNumbers(row.field)) {
    auto after = editNumbers(session, marks, row);
    marks.put(row.mark());
    return after;
  }
  Value value = row.values.back();
  const bool changed = editWhole(session, marks, row, value);
  if (row.field.kind != scene::ValueKind::Word) marks.put(row.mark());
  if (!changed) return std::nullopt;
  return std::vector(row.values.size(), value);
}

// Returns the name, unit and meaning of a field.
std::string helpOf(const FieldInfo& field, bool mixed) {
  std::string text = fmt::format("{}.{}", field.component, field.name);
  if (!field.unit.empty()) text += fmt::format(", {}", field.unit);
  if (const std::string_view help = fieldHelp(field.component, field.name); !help.empty())
    text += fmt::format("\n{}", help);
  if (mixed) text += "\nThe selected ones differ.";
  if (hasNumbers(field)) text += fmt::format("\n{}", kNumberHelp);
  return text;
}

// Draws a button that sets the field back, where it differs from its default.
void drawReset(Session& session, Marks& marks, const FieldInfo& field,
               std::span<const ecs::Entity> entities) {
  const Baseline& baseline = session.changes.baseline();
  if (std::ranges::all_of(
          entities, [&](ecs::Entity entity) { return isDefault(session.document, baseline, entity, field); }))
    return;
  ImGui::SameLine(0.0f, ImGui::GetStyle().ItemInnerSpacing.x);
  if (ImGui::SmallButton("o"))
    logRefusal(session, resetToDefault(session.document, session.history, baseline, entities, field.component,
                                       field.name));
  marks.put(fmt::format("inspector.reset.{}.{}", field.component, field.name));
  tooltip("Back to " + scene::valueText(defaultValue(session.document, baseline, entities.back(), field)));
}

void drawField(Session& session, Marks& marks, const FieldInfo& field,
               std::span<const ecs::Entity> entities) {
  FieldRow row{field, entities, {}};
  for (const ecs::Entity entity : entities)
    row.values.push_back(field.get(session.document.registry(), entity));
  row.mixed = std::ranges::any_of(
      row.values, [&](const Value& value) { return !scene::sameBits(value, row.values.back()); });
  const std::string label = fieldLabel(field.component, field.name);
  ImGui::PushID(fmt::format("{}.{}", field.component, field.name).c_str());
  beginFieldRow(label, helpOf(field, row.mixed));
  const auto after = editValues(session, marks, row);
  // A drag is one step, from its first pixel to its end; so is the time that a text field is open.
  const bool activated = ImGui::IsItemActivated(), deactivated = ImGui::IsItemDeactivated();
  if (activated)
    session.history.beginDrag(fmt::format("{} of {}", label, entitiesName(session.document, entities)));
  if (after) {
    std::vector<FieldEdit> edits;
    for (std::size_t i = 0; i < entities.size(); ++i)
      edits.push_back({entities[i], field.component, field.name, (*after)[i]});
    logRefusal(session, session.history.setFields(edits));
  }
  // Tab goes from one number of the field to the next, which begins a step of its own.
  if (deactivated && !activated) session.history.endDrag();
  if (isStrengthOfLight(field)) chooseUnit(session, marks, row.primary());
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

void asOneStep(Session& session, const char* name) {
  if (ImGui::IsItemActivated()) session.history.beginDrag(name);
  if (ImGui::IsItemDeactivated()) session.history.endDrag();
}

void logRefusal(Session& session, const Result<void>& done) {
  if (!done) session.log.error(done.error());
}

void drawFields(Session& session, Marks& marks, const ComponentInfo& component,
                std::span<const ecs::Entity> entities) {
  if (!beginFieldTable(std::string(component.name).c_str())) return;
  for (const FieldInfo& field : component.fields)
    if (std::ranges::all_of(
            entities, [&](ecs::Entity entity) { return isUsed(session.document.registry(), entity, field); }))
      drawField(session, marks, field, entities);
  if (component.name == scene::LocalLightComponent::kComponentName) {
    beginFieldRow("Exposure", "Of the whole picture, against which the light is seen");
    drawExposure(session, marks, "inspector.Light");
  }
  ImGui::EndTable();
}

}  // namespace lambent::editor
