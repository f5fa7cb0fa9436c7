#include <algorithm>
#include <array>
#include <ctime>
#include <utility>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <imgui.h>

#include "editor/panels/panel.hpp"
#include "editor/ui/dear_imgui.hpp"

namespace lambent::editor {

namespace {

void drawMilliseconds(double value) {
  if (value < 0.0)
    ImGui::TextDisabled("-");
  else
    ImGui::Text("%.2f", value);
}

void drawPasses(const std::vector<gpu::PassTime>& passes) {
  constexpr std::array kColumns = {// with their widths in ems
                                   std::pair{"Pass", 6.7f},   std::pair{"CPU ms", 4.0f},
                                   std::pair{"GPU ms", 4.0f}, std::pair{"Dispatches", 5.0f},
                                   std::pair{"Draws", 3.3f},  std::pair{"Uploaded", 5.0f}};
  constexpr ImGuiTableFlags kTable = ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerV |
                                     ImGuiTableFlags_Resizable | ImGuiTableFlags_ScrollY |
                                     ImGuiTableFlags_ScrollX;
  const float width = std::max(ImGui::GetContentRegionAvail().x, em(40.0f));
  if (!ImGui::BeginTable("passes", static_cast<int>(kColumns.size()) + 1, kTable, ImVec2(0.0f, 0.0f), width))
    return;
  for (const auto& [title, ems] : kColumns)
    ImGui::TableSetupColumn(title, ImGuiTableColumnFlags_WidthFixed, em(ems));
  ImGui::TableSetupColumn("Why it ran", ImGuiTableColumnFlags_WidthStretch);
  ImGui::TableSetupScrollFreeze(0, 1);
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
  const frame::StreamingStatus streaming = session.stage.world().streaming();
  const bool limited = streaming.budget_bytes != ~std::uint64_t{0};
  ImGui::TextUnformatted(
      fmt::format("{}{} on the GPU, {} on their way",
                  bytesText(static_cast<double>(streaming.resident_bytes + session.picture.volume_bytes)),
                  limited ? " of " + bytesText(static_cast<double>(streaming.budget_bytes)) : std::string(),
                  bytesText(static_cast<double>(streaming.in_flight_bytes)))
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

void drawLog(Session& session, Marks& marks) {
  const auto entries = session.log.entries();
  if (ImGui::Button("Clear")) session.log.clear();
  marks.put("log.clear");
  ImGui::SameLine();
  if (ImGui::Button("Copy all")) {
    std::string text;
    for (const LogEntry& entry : entries) text += entry.text + "\n";
    ImGui::SetClipboardText(text.c_str());
  }
  marks.put("log.copy");
  ImGui::BeginChild("entries");
  for (const LogEntry& entry : entries) {
    const std::time_t when = std::chrono::system_clock::to_time_t(entry.when);
    ImGui::TextDisabled("%s", fmt::format("{:%H:%M:%S}", fmt::localtime(when)).c_str());
    ImGui::SameLine();
    ImGui::PushStyleColor(ImGuiCol_Text, severityColor(entry.severity));
    const std::string times = entry.times > 1 ? fmt::format(" ({} times)", entry.times) : std::string();
    ImGui::TextWrapped("%s%s", entry.text.c_str(), times.c_str());
    ImGui::PopStyleColor();
  }
  if (ImGui::GetScrollY() >= ImGui::GetScrollMaxY()) ImGui::SetScrollHereY(1.0f);
  ImGui::EndChild();
}

}  // namespace lambent::editor
