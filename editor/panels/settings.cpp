#include <array>
#include <cctype>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <imgui.h>
#include <nlohmann/json.hpp>

#include "editor/commands/command.hpp"
#include "editor/panels/panel.hpp"
#include "editor/ui/dear_imgui.hpp"
#include "runtime/frame/frame_settings.hpp"

namespace lambent::editor {

namespace {

std::string capitalized(std::string_view label) {
  std::string text(label);
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

void editSetting(Session& session, Marks& marks, const frame::SettingRow& row, const std::string& mark) {
  using SettingKind = frame::SettingRow::Kind;
  frame::FrameSettings settings = session.stage.settings();
  const double value = row.get(settings);
  const std::string shown = frame::settingWord(row, settings);
  bool changed = false;
  double to = value;
  ImGui::SetNextItemWidth(-1.0f);
  if (row.kind == SettingKind::Switch) {
    bool on = value != 0.0;
    changed = ImGui::Checkbox("##value", &on);
    to = on ? 1.0 : 0.0;
  } else if (row.kind == SettingKind::Choice) {
    if (ImGui::BeginCombo("##value", shown.c_str())) {
      for (std::size_t i = 0; i < row.words.size(); ++i)
        if (ImGui::Selectable(std::string(row.words[i]).c_str(), static_cast<double>(i) == value))
          to = static_cast<double>(i), changed = true;
      ImGui::EndCombo();
    }
  } else if (row.kind == SettingKind::Whole) {
    // A word such as "auto", which stands for no number, lies left of the least number.
    const int least = static_cast<int>(row.least), word = row.not_a_number.empty() ? least : least - 1;
    int whole = std::isnan(value) ? word : static_cast<int>(value);
    changed = ImGui::SliderInt("##value", &whole, word, static_cast<int>(row.greatest), shown.c_str(),
                               ImGuiSliderFlags_AlwaysClamp);
    to = whole < least ? std::numeric_limits<double>::quiet_NaN() : whole;
  } else {
    float real = static_cast<float>(value);
    changed = ImGui::SliderFloat("##value", &real, static_cast<float>(row.least),
                                 static_cast<float>(row.greatest), "%.3g", ImGuiSliderFlags_AlwaysClamp);
    to = double{real};
  }
  marks.put(mark);
  tooltip(row.help);
  if (ImGui::IsItemActivated()) session.history.beginDrag(std::string(row.label));
  if (changed) {
    row.put(settings, to);
    runOrLog(session, "setting", std::array{std::string(row.name), frame::settingWord(row, settings)});
  }
  if (ImGui::IsItemDeactivated()) session.history.endDrag();
}

// Draws the choice of quality, which sets the number of key lights and their shadow resolution.
void drawQuality(Session& session, Marks& marks) {
  const std::string now(frame::qualityOf(session.stage.settings()));
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted("Quality");
  ImGui::SameLine();
  ImGui::SetNextItemWidth(em(6.5f));
  const bool open = ImGui::BeginCombo("##quality", now.empty() ? "own" : now.c_str());
  marks.put("quality");
  tooltip("How many key lights there are and how finely they shadow: time against error");
  if (open) {
    for (const std::string_view name : frame::qualityNames()) {
      const std::string word(name);
      if (ImGui::Selectable(word.c_str(), word == now)) runOrLog(session, "quality", std::array{word});
      marks.put("quality." + word);
    }
    ImGui::EndCombo();
  }
}

// Returns what a setting costs at its present value and at its finest.
std::string costText(const frame::SettingCost& cost) {
  const auto milliseconds = [](const frame::SettingPoint& point) {
    return point.gpu_ms > 0.0 ? point.gpu_ms : point.cpu_ms;
  };
  const std::string error =
      cost.now.error <= 0.0 ? "no error" : fmt::format("error {:.2g} %", 100.0 * cost.now.error);
  return fmt::format("{}, {:.2f} ms; finest {:.2f} ms", error, milliseconds(cost.now),
                     milliseconds(cost.finest));
}

void drawRows(Session& session, Marks& marks) {
  for (const frame::SettingRow& row : frame::settingRows()) {
    if (row.name == "exposure") continue;  // the environment's panel shows it
    const std::string name(row.name);
    ImGui::PushID(name.c_str());
    beginFieldRow(capitalized(row.label), fmt::format("{}\n{}", name, row.help));
    editSetting(session, marks, row, "setting." + name);
    if (const auto found = session.settings.costs().find(row.name); found != session.settings.costs().end())
      fittedText(dimmed(), costText(found->second));
    ImGui::PopID();
  }
  beginFieldRow("Pixels", "Pixels of the picture for each of the window along an edge: less is faster");
  ImGui::SetNextItemWidth(-1.0f);
  if (ImGui::SliderFloat("##pixels", &session.viewing.scale.whole, 0.25f, 2.0f, "%.2f",
                         ImGuiSliderFlags_AlwaysClamp))
    session.viewing.changed = true;
  marks.put("setting.pixels");
}

}  // namespace

void drawSettings(Session& session, Marks& marks) {
  drawQuality(session, marks);
  if (ImGui::Button(session.settings.busy() ? "Measuring..." : "Measure in this view"))
    session.settings.measureAll();
  marks.put("setting.measure");
  tooltip(
      "Error against each setting's finest value, same view at rest; times of a frame that shades "
      "everything");
  ImGui::Separator();
  if (beginFieldTable("settings", 0.56f)) {
    drawRows(session, marks);
    ImGui::EndTable();
  }
  if (ImGui::Button("All to their defaults"))
    session.history.editWorld("settings to default", [](WorldState& world) { world.settings.clear(); });
  marks.put("setting.defaults");
}

}  // namespace lambent::editor
