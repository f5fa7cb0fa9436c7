#include <algorithm>
#include <array>
#include <cfloat>

#include <fmt/format.h>
#include <imgui.h>
#include <nlohmann/json.hpp>

#include "editor/commands/command.hpp"
#include "editor/panels/panel.hpp"
#include "editor/panels/text.hpp"
#include "editor/ui/fitting.hpp"
#include "runtime/effects/volume/volume.hpp"
#include "runtime/frame/frame_settings.hpp"

namespace lambent::editor {

namespace {

void drawMilliseconds(double value) {
  if (value < 0.0)
    ImGui::TextDisabled("-");
  else
    ImGui::Text("%.2f", value);
}

void drawPasses(const std::vector<gpu::PassTime>& passes) {
  constexpr ImGuiTableFlags kTable = ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerV |
                                     ImGuiTableFlags_Resizable | ImGuiTableFlags_ScrollY |
                                     ImGuiTableFlags_ScrollX;
  if (!ImGui::BeginTable("passes", 7, kTable, ImVec2(0.0f, 0.0f),
                         std::max(ImGui::GetContentRegionAvail().x, em(40.0f))))
    return;
  ImGui::TableSetupColumn("Pass", ImGuiTableColumnFlags_WidthFixed, em(6.7f));
  ImGui::TableSetupColumn("CPU ms", ImGuiTableColumnFlags_WidthFixed, em(4.0f));
  ImGui::TableSetupColumn("GPU ms", ImGuiTableColumnFlags_WidthFixed, em(4.0f));
  ImGui::TableSetupColumn("Dispatches", ImGuiTableColumnFlags_WidthFixed, em(5.0f));
  ImGui::TableSetupColumn("Draws", ImGuiTableColumnFlags_WidthFixed, em(3.3f));
  ImGui::TableSetupColumn("Uploaded", ImGuiTableColumnFlags_WidthFixed, em(5.0f));
  ImGui::TableSetupColumn("Why it ran", ImGuiTableColumnFlags_WidthStretch);
  ImGui::TableHeadersRow();
  double cpu = 0.0, gpu = 0.0;
  for (const gpu::PassTime& pass : passes) {
    cpu += pass.cpu_ms, gpu += std::max(0.0, pass.gpu_ms);
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(pass.name.c_str());
    ImGui::TableNextColumn();
    drawMilliseconds(pass.cpu_ms);
    ImGui::TableNextColumn();
    drawMilliseconds(pass.gpu_ms);
    ImGui::TableNextColumn();
    ImGui::Text("%llu", static_cast<unsigned long long>(pass.counters.dispatches));
    ImGui::TableNextColumn();
    ImGui::Text("%llu", static_cast<unsigned long long>(pass.counters.draws));
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(bytesText(static_cast<double>(pass.counters.uploaded_bytes)).c_str());
    ImGui::TableNextColumn();
    if (pass.reason.empty())
      ImGui::TextDisabled("nothing to do");
    else
      ImGui::TextUnformatted(pass.reason.c_str());
  }
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::TextUnformatted("all");
  ImGui::TableNextColumn();
  drawMilliseconds(cpu);
  ImGui::TableNextColumn();
  drawMilliseconds(gpu);
  ImGui::EndTable();
}

}  // namespace

void drawCost(Session& session, Marks& marks) {
  const frame::StepCounts& counts = session.picture.counts;
  const auto number = [](const char* label, std::uint64_t value) {
    sameLineIfFits(fmt::format("{} {}", label, value));
    ImGui::TextDisabled("%s", label);
    ImGui::SameLine();
    ImGui::Text("%llu", static_cast<unsigned long long>(value));
  };
  ImGui::Text("%s on the GPU",
              bytesText(static_cast<double>(session.stage.world().residency().bytesResident() +
                                            session.picture.volume_bytes))
                  .c_str());
  marks.put("cost.bytes");
  number("groups", counts["groups"]), number("light probes written", counts["light_probes_written"]);
  number("captured", counts["light_probes_captured"]), number("cells shaded", counts["cells_shaded"]);
  number("draws shaded", counts["draws_shaded"]), number("shadow cubes", counts["shadow_cubes_drawn"]);
  number("volumes shaded", counts["volumes_shaded"]), number("grids", counts["neighborhood_grids"]);
  number("draws out of view", counts["draws_out_of_view"]);
  number("volumes out of view", counts["volumes_out_of_view"]);
  ImGui::BeginChild("table");
  drawPasses(session.picture.passes);
  ImGui::EndChild();
  marks.put("cost.passes");
}

namespace {

double frameMilliseconds(const frame::SettingPoint& point) {
  return point.gpu_ms > 0.0 ? point.gpu_ms : point.cpu_ms;
}

std::string percentText(double error) {
  return error <= 0.0 ? "none" : fmt::format("{:.2g} %", 100.0 * error);
}

// Plots error over value; the tooltip shows the times.
void drawSweep(const frame::SettingRow& row, const std::vector<frame::SettingPoint>& points) {
  std::vector<float> errors;
  std::string table = fmt::format("{:>10}  {:>10}  {:>8}\n", row.name, "error", "ms");
  for (const frame::SettingPoint& point : points) {
    errors.push_back(static_cast<float>(100.0 * point.error));
    table += fmt::format("{:>10.4g}  {:>10}  {:>8.2f}\n", point.value, percentText(point.error),
                         frameMilliseconds(point));
  }
  ImGui::PlotLines("##sweep", errors.data(), static_cast<int>(errors.size()), 0, nullptr, 0.0f, FLT_MAX,
                   ImVec2(em(8.7f), em(1.6f)));
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", table.c_str());
}

// Draws the widget of the setting itself.
void drawSetting(Session& session, Marks& marks, const frame::SettingRow& row) {
  frame::FrameSettings settings = session.stage.settings();
  const double value = row.get(settings);
  double to = value;
  bool changed = false;
  ImGui::SetNextItemWidth(-1.0f);
  using Kind = frame::SettingRow::Kind;
  if (row.kind == Kind::Switch) {
    bool on = value != 0.0;
    changed = ImGui::Checkbox("##knob", &on);
    to = on ? 1.0 : 0.0;
  } else {
    float shown = static_cast<float>(value);
    changed =
        ImGui::SliderFloat("##knob", &shown, static_cast<float>(row.least), static_cast<float>(row.greatest),
                           frame::settingWord(row, settings).c_str(), ImGuiSliderFlags_AlwaysClamp);
    to = row.kind == Kind::Real ? double{shown} : std::round(double{shown});
  }
  marks.put(fmt::format("accuracy.{}", row.name));
  if (ImGui::IsItemActivated()) session.history.beginDrag(std::string(row.label));
  if (changed && to != value) {
    row.put(settings, to);
    const std::array words = {std::string(row.name), frame::settingWord(row, settings)};
    runOrLog(session, "setting", words);
  }
  if (ImGui::IsItemDeactivated()) session.history.endDrag();
}

}  // namespace

void drawAccuracy(Session& session, Marks& marks) {
  if (ImGui::Button(session.settings.busy() ? "Measuring..." : "Measure in this view"))
    session.settings.measureAll();
  marks.put("accuracy.measure");
  ImGui::SameLine();
  ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyle().Colors[ImGuiCol_TextDisabled]);
  fittedText(
      "error against the knob's finest value, same view at rest; times of a frame that shades everything");
  ImGui::PopStyleColor();
  constexpr ImGuiTableFlags kTable = ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerV |
                                     ImGuiTableFlags_ScrollY | ImGuiTableFlags_Resizable |
                                     ImGuiTableFlags_ScrollX;
  if (!ImGui::BeginTable("knobs", 6, kTable, ImVec2(0.0f, 0.0f),
                         std::max(ImGui::GetContentRegionAvail().x, em(44.0f))))
    return;
  ImGui::TableSetupColumn("Knob", ImGuiTableColumnFlags_WidthStretch, 0.24f);
  ImGui::TableSetupColumn("Value", ImGuiTableColumnFlags_WidthStretch, 0.26f);
  ImGui::TableSetupColumn("Error", ImGuiTableColumnFlags_WidthFixed, em(5.0f));
  ImGui::TableSetupColumn("ms now", ImGuiTableColumnFlags_WidthFixed, em(4.0f));
  ImGui::TableSetupColumn("ms finest", ImGuiTableColumnFlags_WidthFixed, em(4.3f));
  ImGui::TableSetupColumn("Error over values", ImGuiTableColumnFlags_WidthFixed, em(12.7f));
  ImGui::TableSetupScrollFreeze(0, 1);
  ImGui::TableHeadersRow();
  for (const frame::SettingRow& row : frame::settingRows()) {
    if (!row.finest) continue;
    const auto found = session.settings.rows().find(row.name);
    ImGui::PushID(row.name.data());
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    fittedText(row.label, fmt::format("{}\n{}", row.name, row.help));
    ImGui::TableNextColumn();
    drawSetting(session, marks, row);
    const bool known = found != session.settings.rows().end() && !found->second.cost.now.passes.empty();
    ImGui::TableNextColumn();
    if (known) ImGui::TextUnformatted(percentText(found->second.cost.now.error).c_str());
    ImGui::TableNextColumn();
    if (known) ImGui::Text("%.2f", frameMilliseconds(found->second.cost.now));
    ImGui::TableNextColumn();
    if (known) ImGui::Text("%.2f", frameMilliseconds(found->second.cost.finest));
    ImGui::TableNextColumn();
    if (found != session.settings.rows().end() && !found->second.sweep.empty()) {
      drawSweep(row, found->second.sweep);
      ImGui::SameLine();
    }
    if (ImGui::SmallButton("Sweep")) session.settings.sweep(std::string(row.name));
    marks.put(fmt::format("accuracy.sweep.{}", row.name));
    ImGui::PopID();
  }
  ImGui::EndTable();
}

}  // namespace lambent::editor
