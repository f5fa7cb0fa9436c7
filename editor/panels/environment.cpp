#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

#include <fmt/format.h>
#include <imgui.h>
#include <nlohmann/json.hpp>

#include "editor/commands/command.hpp"
#include "editor/panels/panel.hpp"
#include "editor/session/key_lights.hpp"
#include "editor/ui/dear_imgui.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::editor {

void drawExposure(Session& session, Marks& marks, const std::string& mark) {
  const std::optional<float> exposure = session.document.world().exposure_ev;
  bool automatic = !exposure.has_value();
  if (ImGui::Checkbox("auto", &automatic))
    session.history.editWorld("exposure", [&](WorldState& world) {
      world.exposure_ev = automatic ? std::nullopt : std::optional(session.picture.exposure_ev);
    });
  marks.put(mark + ".automatic");
  tooltip("Meters the exposure from the picture, so a brighter lamp may not look brighter");
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1.0f);
  float ev = exposure.value_or(session.picture.exposure_ev);
  // A drag of the slider takes the exposure from the meter.
  const bool changed = ImGui::SliderFloat("##exposure", &ev, -12.0f, 12.0f, "%.2f EV");
  if (ImGui::IsItemActivated()) session.history.beginDrag("exposure");
  if (changed) session.history.editWorld("exposure", [&](WorldState& world) { world.exposure_ev = ev; });
  if (ImGui::IsItemDeactivated()) session.history.endDrag();
  marks.put(mark + ".exposure");
  tooltip("Stops by which the picture is brightened; at 0, radiance 1 is white");
}

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

// Draws a number of a light as a step of its own. Returns whether it changed.
bool dragOfLight(Session& session, Marks& marks, const char* label, float& number, const NumberLook& look,
                 const char* step, const std::string& mark) {
  const bool changed = dragNumber(label, number, look);
  tooltip(kNumberHelp);
  asOneStep(session, step);
  marks.put(mark);
  return changed;
}

// Draws the position of a light on the sky. Returns whether it changed.
bool dragOnSky(Session& session, Marks& marks, float& azimuth_deg, float& elevation_deg, double highest_deg,
               const std::string& light, const std::string& mark) {
  const bool turned = dragOfLight(session, marks, "azimuth", azimuth_deg,
                                  {.speed = 0.5, .least = -360.0, .most = 360.0, .format = "%.1f°"},
                                  ("turn of " + light).c_str(), mark + ".azimuth");
  return dragOfLight(session, marks, "elevation", elevation_deg,
                     {.speed = 0.25, .least = -highest_deg, .most = highest_deg, .format = "%.1f°"},
                     ("height of " + light).c_str(), mark + ".elevation") ||
         turned;
}

void drawKeyLight(Session& session, Marks& marks, std::size_t index, const KeyLight& key) {
  const std::string mark = fmt::format("key.{}", index);
  float azimuth = key.azimuth_deg, elevation = key.elevation_deg;
  if (dragOnSky(session, marks, azimuth, elevation, 89.9, "key light", mark))
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
  bool changed = dragOfLight(session, marks, "times", strength, {.speed = 0.01, .least = 0.0, .most = 1000.0},
                             "strength of key light", mark + ".strength");
  changed |= ImGui::ColorEdit3("tint", &tint.x, ImGuiColorEditFlags_Float);
  asOneStep(session, "color of key light");
  marks.put(mark + ".tint");
  if (changed) logRefusal(session, dimKeyLight(session, index, strength * glm::max(tint, 0.0f)));
  if (!key.edited) return;
  if (ImGui::Button("As found")) logRefusal(session, resetKeyLights(session, index));
  marks.put(mark + ".reset");
}

void drawKeyLights(Session& session, Marks& marks) {
  const bool open = ImGui::CollapsingHeader("Key lights", ImGuiTreeNodeFlags_DefaultOpen);
  marks.put("environment.keys");
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip(
        "Suns, lamps and windows that were found in the light from outside, and shine by shadow maps.\n"
        "Share: of all light.");
  if (!open) return;
  const std::vector<KeyLight> keys = keyLightsOf(session);
  if (keys.empty()) return ImGui::TextDisabled("None: all light from outside is soft.");
  drawTable(session, marks, keys);
  std::optional<std::size_t>& at_hand = session.viewing.key_at_hand;
  if (at_hand && *at_hand >= keys.size()) at_hand.reset();
  if (!at_hand) return;
  ImGui::PushID("key");
  drawKeyLight(session, marks, *at_hand, keys[*at_hand]);
  ImGui::PopID();
}

constexpr float kLabelEms = 5.0f;  // room for the labels behind widgets

void setWord(Session& session, std::size_t index, std::string word) {
  session.history.editWorld("light from outside",
                            [&](WorldState& world) { world.lights[index] = std::move(word); });
}

std::string constantWord(const glm::vec3& radiance) {
  return fmt::format("constant:{:.7g},{:.7g},{:.7g}", radiance.r, radiance.g, radiance.b);
}

// Edits radiance as a colour and a strength, because suns are far brighter than a colour picker's range.
bool editRadiance(Session& session, Marks& marks, const std::string& mark, glm::vec3& radiance) {
  float strength = std::max({radiance.r, radiance.g, radiance.b, 1e-6f});
  glm::vec3 color = radiance / strength;
  bool changed = ImGui::ColorEdit3("color", &color.x, ImGuiColorEditFlags_Float);
  asOneStep(session, "color of light");
  marks.put(mark + ".color");
  changed |= dragOfLight(
      session, marks, "radiance", strength,
      {.speed = 0.01 * std::max(0.1, double{strength}), .least = 0.0, .most = 1e7, .format = "%.4g"},
      "strength of light", mark + ".radiance");
  if (changed) radiance = strength * color;
  return changed;
}

void drawSun(Session& session, Marks& marks, std::size_t index, spec::SunLight sun) {
  const std::string mark = fmt::format("environment.{}", index);
  bool changed = dragOnSky(session, marks, sun.azimuth_deg, sun.elevation_deg, 90.0, "sun", mark);
  changed |= dragOfLight(session, marks, "radius", sun.angle_deg,
                         {.speed = 0.05, .least = 0.05, .most = 180.0, .format = "%.2f°"}, "size of sun",
                         mark + ".radius");
  changed |= editRadiance(session, marks, mark, sun.radiance);
  if (changed) setWord(session, index, sunWord(sun));
}

void drawLight(Session& session, Marks& marks, std::size_t index, const std::string& word) {
  const auto light = spec::parseLight(word);
  const std::string mark = fmt::format("environment.{}", index);
  const std::string title = !light                                           ? word
                            : std::holds_alternative<spec::SunLight>(*light) ? "Sun"
                            : std::holds_alternative<spec::ConstantLight>(*light)
                                ? "Constant"
                                : "Environment map " + std::filesystem::path(word).filename().string();
  ImGui::PushID(static_cast<int>(index));
  const bool open =
      ImGui::CollapsingHeader(title.c_str(), ImGuiTreeNodeFlags_DefaultOpen | kTreeNodeAllowOverlap);
  marks.put(mark);
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - em(1.2f));
  if (ImGui::SmallButton("x")) runOrLog(session, "remove-light", std::array{std::to_string(index)});
  marks.put(mark + ".remove");
  tooltip("Take this light away");
  if (open && light) {
    if (const auto* sun = std::get_if<spec::SunLight>(&*light)) drawSun(session, marks, index, *sun);
    if (const auto* constant = std::get_if<spec::ConstantLight>(&*light)) {
      glm::vec3 radiance = constant->radiance;
      if (editRadiance(session, marks, mark, radiance)) setWord(session, index, constantWord(radiance));
    }
    if (std::holds_alternative<spec::EnvironmentMapLight>(*light)) ImGui::TextWrapped("%s", word.c_str());
  }
  ImGui::PopID();
}

void drawStand(Session& session, Marks& marks) {
  const ecs::Entity entity = session.stage.environmentEntity();
  const ecs::Registry& registry = session.document.registry();
  const auto number = [&](const char* field, const char* label, float least, float most, const char* format) {
    const auto found = scene::findField("Environment", field);
    if (!found) return;
    float value = std::get<float>((*found)->get(registry, entity));
    if (ImGui::SliderFloat(label, &value, least, most, format))
      logRefusal(session, session.history.setField(entity, "Environment", field, value));
    asOneStep(session, label);
    marks.put(fmt::format("environment.{}", field));
  };
  number("rotation", "turn", -180.0f, 180.0f, "%.1f°");
  number("intensity", "intensity", 0.0f, 4.0f, "%.3f");
  if (!session.document.world().fade_lights.empty()) number("fade", "fade", 0.0f, 1.0f, "%.3f");
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted("exposure");
  ImGui::SameLine();
  drawExposure(session, marks, "environment");
}

}  // namespace

void drawEnvironment(Session& session, Marks& marks) {
  ImGui::PushItemWidth(-em(kLabelEms));
  drawStand(session, marks);
  ImGui::Separator();
  const std::vector<std::string> lights = session.document.world().lights;
  for (std::size_t i = 0; i < lights.size(); ++i) drawLight(session, marks, i, lights[i]);
  if (ImGui::Button("Add sun"))
    runOrLog(session, "add-light", std::array{std::string("sun:35,45,6,30,28,25")});
  marks.put("environment.add-sun");
  sameLineIfFits("Add constant");
  if (ImGui::Button("Add constant"))
    runOrLog(session, "add-light", std::array{std::string("constant:0.3,0.35,0.45")});
  marks.put("environment.add-constant");
  sameLineIfFits("Add environment map...");
  if (ImGui::Button("Add environment map...")) runOrLog(session, "environment-map", {});
  marks.put("environment.add-map");
  drawKeyLights(session, marks);
  ImGui::PopItemWidth();
}

}  // namespace lambent::editor
