#include <algorithm>
#include <array>
#include <cfloat>

#include <fmt/format.h>
#include <imgui.h>
#include <nlohmann/json.hpp>

#include "editor/commands/command.hpp"
#include "editor/panels/panel.hpp"
#include "editor/panels/widgets.hpp"
#include "editor/ui/dear_imgui.hpp"
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

}  // namespace

void drawAccuracy(Session& session, Marks& marks) {
  if (ImGui::Button(session.settings.busy() ? "Measuring..." : "Measure in this view"))
    session.settings.measureAll();
  marks.put("accuracy.measure");
  ImGui::SameLine();
  fittedText(
      dimmed(),
      "error against the knob's finest value, same view at rest; times of a frame that shades everything");
  constexpr ImGuiTableFlags kTable = ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerV |
                                     ImGuiTableFlags_ScrollY | ImGuiTableFlags_Resizable |
                                     ImGuiTableFlags_ScrollX;
  if (!ImGui::BeginTable("knobs", 5, kTable, ImVec2(0.0f, 0.0f),
                         std::max(ImGui::GetContentRegionAvail().x, em(32.0f))))
    return;
  ImGui::TableSetupColumn("Knob", ImGuiTableColumnFlags_WidthStretch, 0.24f);
  ImGui::TableSetupColumn("Value", ImGuiTableColumnFlags_WidthStretch, 0.26f);
  ImGui::TableSetupColumn("Error", ImGuiTableColumnFlags_WidthFixed, em(5.0f));
  ImGui::TableSetupColumn("ms now", ImGuiTableColumnFlags_WidthFixed, em(4.0f));
  ImGui::TableSetupColumn("ms finest", ImGuiTableColumnFlags_WidthFixed, em(4.3f));
  ImGui::TableSetupScrollFreeze(0, 1);
  ImGui::TableHeadersRow();
  for (const frame::SettingRow& row : frame::settingRows()) {
    if (!row.finest) continue;
    const auto found = session.settings.costs().find(row.name);
    ImGui::PushID(row.name.data());
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    fittedText(row.label, fmt::format("{}\n{}", row.name, row.help));
    ImGui::TableNextColumn();
    editSetting(session, marks, row, fmt::format("accuracy.{}", row.name));
    if (found != session.settings.costs().end()) {
      const frame::SettingCost& cost = found->second;
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(percentText(cost.now.error).c_str());
      for (const frame::SettingPoint* point : {&cost.now, &cost.finest}) {
        ImGui::TableNextColumn();
        ImGui::Text("%.2f", frameMilliseconds(*point));
      }
    }
    ImGui::PopID();
  }
  ImGui::EndTable();
}

namespace {

const char* stateWord(frame::BundleStatus::State state) {
  constexpr std::array kStateWords = {"closed", "loading", "as far as there is room", "whole", "damaged"};
  return kStateWords[static_cast<std::size_t>(state)];
}

void drawTimes(const frame::FrameTimes& times) {
  const std::vector<std::size_t> bins = times.histogram();
  std::vector<float> heights(bins.begin(), bins.end());
  ImGui::PlotHistogram("##times", heights.data(), static_cast<int>(heights.size()), 0, nullptr, 0.0f, FLT_MAX,
                       ImVec2(ImGui::GetContentRegionAvail().x, em(4.6f)));
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("Frames by their time, in quarters of the median; the last bar: all beyond");
  fittedText(fmt::format("median {:.1f} ms, worst {:.1f} ms, {} of {} over twice the median", times.median(),
                         times.worst(), times.overTwiceMedian(), times.count()));
}

void drawBundles(const frame::StreamingStatus& status, Marks& marks) {
  constexpr ImGuiTableFlags kTable = ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerV |
                                     ImGuiTableFlags_ScrollY | ImGuiTableFlags_ScrollX;
  if (!ImGui::BeginTable("bundles", 4, kTable, ImVec2(0.0f, 0.0f),
                         std::max(ImGui::GetContentRegionAvail().x, em(32.0f))))
    return;
  ImGui::TableSetupColumn("Bundle", ImGuiTableColumnFlags_WidthStretch, 0.3f);
  ImGui::TableSetupColumn("Resident", ImGuiTableColumnFlags_WidthStretch, 0.4f);
  ImGui::TableSetupColumn("Size in view", ImGuiTableColumnFlags_WidthFixed, em(6.0f));
  ImGui::TableSetupColumn("State", ImGuiTableColumnFlags_WidthStretch, 0.3f);
  ImGui::TableSetupScrollFreeze(0, 1);
  ImGui::TableHeadersRow();
  for (const frame::BundleStreaming& bundle : status.bundles) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    fittedText(bundle.name);
    ImGui::TableNextColumn();
    const double whole = static_cast<double>(std::max<std::uint64_t>(bundle.whole_bytes, 1));
    const std::string bytes =
        fmt::format("{} of {}, {} wanted", bytesText(static_cast<double>(bundle.resident_bytes)),
                    bytesText(static_cast<double>(bundle.whole_bytes)),
                    bytesText(static_cast<double>(bundle.wanted_bytes)));
    ImGui::ProgressBar(static_cast<float>(static_cast<double>(bundle.resident_bytes) / whole),
                       ImVec2(-1.0f, 0.0f),
                       ellipsized(bytes, ImGui::GetContentRegionAvail().x - em(0.5f)).c_str());
    tooltip(bytes);
    ImGui::TableNextColumn();
    ImGui::Text("%.2f", static_cast<double>(bundle.size));
    ImGui::TableNextColumn();
    fittedText(stateWord(bundle.state));
  }
  ImGui::EndTable();
  marks.put("streaming.bundles");
}

}  // namespace

void drawStreaming(Session& session, Marks& marks) {
  const frame::StreamingStatus status = session.stage.world().streaming();
  const bool limited = status.budget_bytes != ~std::uint64_t{0};
  const double resident = static_cast<double>(status.resident_bytes);
  ImGui::BeginChild("figures", ImVec2(0.38f * ImGui::GetContentRegionAvail().x, 0.0f));
  if (limited)
    ImGui::ProgressBar(
        static_cast<float>(resident / static_cast<double>(status.budget_bytes)), ImVec2(-1.0f, 0.0f),
        fmt::format("{} of {}", bytesText(resident), bytesText(static_cast<double>(status.budget_bytes)))
            .c_str());
  else
    fittedText(fmt::format("{} on the GPU, without a limit (--max-memory)", bytesText(resident)));
  marks.put("streaming.budget");
  fittedText(fmt::format("{} parts wanted, {} on their way, {:.1f} MB/s", status.queued,
                         bytesText(static_cast<double>(status.in_flight_bytes)), status.megabytes_per_s));
  marks.put("streaming.queue");
  fittedText(fmt::format("{} shown in full, {} partly, {} by proxy levels of detail, {} not",
                         status.count(frame::Shown::Full), status.count(frame::Shown::Partly),
                         status.count(frame::Shown::ProxyLod), status.count(frame::Shown::Nothing)));
  drawTimes(session.picture.times);
  ImGui::EndChild();
  ImGui::SameLine();
  ImGui::BeginChild("list");
  drawBundles(status, marks);
  ImGui::EndChild();
}

}  // namespace lambent::editor
