// Draws the key lights found in the environment: a table, and the fields of the chosen one.
#include "editor/session/key_lights.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <imgui.h>

#include "editor/panels/fields.hpp"
#include "editor/panels/number_field.hpp"
#include "editor/panels/panel.hpp"
#include "editor/ui/dear_imgui.hpp"
#include "editor/ui/fitting.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::editor {

namespace {

void swatch(const glm::vec3& radiance) {
  const float peak = std::max({radiance.r, radiance.g, radiance.b, 1e-6f});
  const ImVec4 color(radiance.r / peak, radiance.g / peak, radiance.b / peak, 1.0f);
  ImGui::ColorButton("##color", color, ImGuiColorEditFlags_NoTooltip | ImGuiColorEditFlags_NoBorder,
                     ImVec2(em(0.8f), em(0.8f)));
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("radiance %.4g %.4g %.4g", double{radiance.r}, double{radiance.g}, double{radiance.b});
}

void drawTable(Session& session, Marks& marks, const std::vector<KeyLight>& keys) {
  constexpr ImGuiTableFlags kTable =
      ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerV | ImGuiTableFlags_SizingFixedFit;
  if (!ImGui::BeginTable("keys", 6, kTable)) return;
  for (const char* title : {"", "az", "el", "radius", "share"}) ImGui::TableSetupColumn(title);
  ImGui::TableSetupColumn("found in", ImGuiTableColumnFlags_WidthStretch);
  ImGui::TableHeadersRow();
  std::optional<std::size_t>& at_hand = session.viewing.key_at_hand;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const KeyLight& key = keys[i];
    ImGui::PushID(static_cast<int>(i));
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    swatch(key.radiance);
    ImGui::TableNextColumn();
    const std::string azimuth = fmt::format("{:.1f}", key.azimuth_deg);
    if (ImGui::Selectable(azimuth.c_str(), at_hand == i,
                          ImGuiSelectableFlags_SpanAllColumns | kSelectableAllowOverlap)) {
      at_hand = at_hand == i ? std::nullopt : std::optional(i);
      session.viewing.changed = true;  // the overlay shows its box
    }
    marks.put(fmt::format("key.{}", i));
    ImGui::TableNextColumn();
    ImGui::Text("%.1f", double{key.elevation_deg});
    ImGui::TableNextColumn();
    ImGui::Text("%.2f", double{key.radius_deg});
    ImGui::TableNextColumn();
    ImGui::Text("%.1f %%", 100.0 * key.share);
    ImGui::TableNextColumn();
    fittedText(key.edited ? key.source() + " *" : key.source());
    ImGui::PopID();
  }
  ImGui::EndTable();
}

void drawKeyLight(Session& session, Marks& marks, std::size_t index, const KeyLight& key) {
  const std::string mark = fmt::format("key.{}", index);
  float azimuth = key.azimuth_deg, elevation = key.elevation_deg;
  HeldNumber& held = session.field_edit.number;
  const double step = double{session.handles.gizmo.options.snap_deg};
  bool moved =
      dragNumber("azimuth##key", azimuth,
                 {.speed = 0.5, .least = -360.0, .most = 360.0, .format = "%.1f°", .step = step}, held);
  asOneStep(session, "turn of key light");
  marks.put(mark + ".azimuth");
  moved |= dragNumber("elevation##key", elevation,
                      {.speed = 0.25, .least = -89.9, .most = 89.9, .format = "%.1f°", .step = step}, held);
  asOneStep(session, "height of key light");
  marks.put(mark + ".elevation");
  if (moved)
    logRefusal(session,
               moveKeyLight(session, index, spec::directionFromAzimuthElevation(azimuth, elevation)));
  if (!key.in_map) {
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextDisabled("Strength and color are those of %s, above.", key.source().c_str());
    ImGui::PopTextWrapPos();
    return;
  }
  // The factor is edited as a colour and a strength, like radiance.
  float strength = std::max({key.factor.r, key.factor.g, key.factor.b});
  glm::vec3 tint = strength > 0.0f ? key.factor / strength : glm::vec3(1.0f);
  bool changed =
      dragNumber("times##key", strength, {.speed = 0.01, .least = 0.0, .most = 1000.0, .step = 0.1}, held);
  asOneStep(session, "strength of key light");
  marks.put(mark + ".strength");
  changed |= ImGui::ColorEdit3("tint##key", &tint.x, ImGuiColorEditFlags_Float);
  asOneStep(session, "color of key light");
  marks.put(mark + ".tint");
  if (changed) logRefusal(session, dimKeyLight(session, index, strength * glm::max(tint, 0.0f)));
  if (!key.edited) return;
  if (ImGui::Button("As found")) logRefusal(session, resetKeyLights(session, index));
  marks.put(mark + ".reset");
}

}  // namespace

void drawKeyLights(Session& session, Marks& marks) {
  const bool open = ImGui::CollapsingHeader("Key lights", ImGuiTreeNodeFlags_DefaultOpen);
  marks.put("environment.keys");
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip(
        "Suns, lamps and windows that were found in the light from outside, and shine by shadow maps.\n"
        "Share: of all light. With the environment selected, those of environment maps have handles on the "
        "sky, too.");
  if (!open) return;
  const std::vector<KeyLight> keys = keyLightsOf(session);
  if (keys.empty()) return ImGui::TextDisabled("None: all light from outside is soft.");
  drawTable(session, marks, keys);
  std::optional<std::size_t>& at_hand = session.viewing.key_at_hand;
  if (at_hand && *at_hand >= keys.size()) at_hand.reset();
  if (at_hand) drawKeyLight(session, marks, *at_hand, keys[*at_hand]);
}

}  // namespace lambent::editor
