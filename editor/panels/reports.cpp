#include <algorithm>
#include <array>
#include <cfloat>
#include <ctime>
#include <span>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <imgui.h>

#include "editor/panels/panel.hpp"
#include "editor/ui/dear_imgui.hpp"

namespace lambent::editor {

namespace {

struct Column {
  const char* title;
  float width;  // in ems, or below 1 as a share of the rest
};

// Begins a table that scrolls where its panel is narrower than this. Returns whether it is shown.
bool beginReport(const char* id, float least_ems, std::span<const Column> columns) {
  constexpr ImGuiTableFlags kTable = ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerV |
                                     ImGuiTableFlags_Resizable | ImGuiTableFlags_ScrollY |
                                     ImGuiTableFlags_ScrollX;
  if (!ImGui::BeginTable(id, static_cast<int>(columns.size()), kTable, ImVec2(0.0f, 0.0f),
                         std::max(ImGui::GetContentRegionAvail().x, em(least_ems))))
    return false;
  for (const auto& [title, width] : columns)
    if (width < 1.0f)
      ImGui::TableSetupColumn(title, ImGuiTableColumnFlags_WidthStretch, width);
    else
      ImGui::TableSetupColumn(title, ImGuiTableColumnFlags_WidthFixed, em(width));
  ImGui::TableSetupScrollFreeze(0, 1);
  ImGui::TableHeadersRow();
  return true;
}

void drawMilliseconds(double value) {
  if (value < 0.0)
    ImGui::TextDisabled("-");
  else
    ImGui::Text("%.2f", value);
}

void drawPasses(const std::vector<gpu::PassTime>& passes) {
  constexpr std::array kColumns = {
      Column{"Pass", 6.7f},  Column{"CPU ms", 4.0f},   Column{"GPU ms", 4.0f},    Column{"Dispatches", 5.0f},
      Column{"Draws", 3.3f}, Column{"Uploaded", 5.0f}, Column{"Why it ran", 0.9f}};
  if (!beginReport("passes", 40.0f, kColumns)) return;
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

const char* stateWord(frame::BundleStatus::State state) {
  constexpr std::array kStateWords = {"closed", "loading", "as far as there is room", "whole", "damaged"};
  return kStateWords[static_cast<std::size_t>(state)];
}

void drawTimes(const frame::FrameTimes& times) {
  const std::vector<std::size_t> bins = times.histogram();
  std::vector<float> heights(bins.begin(), bins.end());
  ImGui::PlotHistogram("##times", heights.data(), static_cast<int>(heights.size()), 0, nullptr, 0.0f, FLT_MAX,
                       ImVec2(ImGui::GetContentRegionAvail().x, em(4.6f)));
  tooltip("Frames by their time, in quarters of the median; the last bar: all beyond");
  fittedText(fmt::format("median {:.1f} ms, worst {:.1f} ms, {} of {} over twice the median", times.median(),
                         times.worst(), times.overTwiceMedian(), times.count()));
}

void drawBundles(const frame::StreamingStatus& status, Marks& marks) {
  constexpr std::array kColumns = {Column{"Bundle", 0.3f}, Column{"Resident", 0.4f},
                                   Column{"Size in view", 6.0f}, Column{"State", 0.3f}};
  if (!beginReport("bundles", 32.0f, kColumns)) return;
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

namespace {

// Toasts are no wider than the view.
constexpr float kToastEms = 28.0f, kToastGap = 12.0f;

}  // namespace

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

void drawToasts(Session& session, Marks& marks, const Rectangle& view) {
  const std::vector<LogEntry> recent = session.log.toasts(std::chrono::steady_clock::now());
  const float room = view.max.x - view.min.x - 2.0f * kToastGap, right = view.max.x - kToastGap;
  const float width = std::max(std::min(em(kToastEms), room), 1.0f);
  float bottom = view.max.y - kToastGap;
  for (std::size_t i = recent.size(); i-- > 0;) {
    const LogEntry& entry = recent[i];
    ImGui::SetNextWindowPos(ImVec2(right, bottom), ImGuiCond_Always, ImVec2(1.0f, 1.0f));
    ImGui::SetNextWindowSize(ImVec2(width, 0.0f));
    ImGui::SetNextWindowBgAlpha(0.94f);
    ImGui::PushStyleColor(ImGuiCol_Border, severityColor(entry.severity));
    const std::string id = fmt::format("##toast{}", entry.number);
    ImGui::Begin(id.c_str(), nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoFocusOnAppearing |
                     ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoInputs);
    ImGui::TextWrapped("%s", entry.text.c_str());
    bottom -= ImGui::GetWindowHeight() + 8.0f;
    ImGui::End();
    ImGui::PopStyleColor();
  }
  if (!recent.empty()) marks.put("toasts", {{right - width, bottom}, {right, view.max.y}});
}

void drawHistory(Session& session, Marks& marks) {
  History& history = session.history;
  const std::vector<std::string> names = history.stepNames();
  const std::size_t done = history.stepsDone();
  std::size_t wanted = done;
  const std::string first = ellipsized("The world as it was opened", ImGui::GetContentRegionAvail().x);
  if (ImGui::Selectable(first.c_str(), done == 0)) wanted = 0;
  marks.put("history.0");
  for (std::size_t i = 0; i < names.size(); ++i) {
    ImGui::PushID(static_cast<int>(i));
    const bool undone = i >= done;
    if (undone) ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyle().Colors[ImGuiCol_TextDisabled]);
    const std::string shown = ellipsized(names[i], ImGui::GetContentRegionAvail().x);
    if (ImGui::Selectable(shown.c_str(), i + 1 == done)) wanted = i + 1;
    if (undone) ImGui::PopStyleColor();
    if (shown != names[i]) tooltip(names[i]);
    marks.put("history." + std::to_string(i + 1));
    ImGui::PopID();
  }
  std::vector<std::string> missing;
  while (history.stepsDone() > wanted && history.canUndo())
    for (std::string& gone : history.undo().missing) missing.push_back(std::move(gone));
  while (history.stepsDone() < wanted && history.canRedo())
    for (std::string& gone : history.redo().missing) missing.push_back(std::move(gone));
  for (const std::string& gone : missing) session.log.warn(gone + " is not there now; it was passed over");
}

}  // namespace lambent::editor
