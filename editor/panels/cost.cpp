#include <algorithm>

#include <fmt/format.h>
#include <imgui.h>

#include "editor/panels/panel.hpp"
#include "editor/panels/text.hpp"
#include "editor/ui/fitting.hpp"
#include "runtime/effects/volume/volume.hpp"

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

}  // namespace lambent::editor
