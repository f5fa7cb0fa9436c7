#include <algorithm>

#include <fmt/format.h>
#include <imgui.h>

#include "editor/panels/panel.hpp"
#include "editor/panels/text.hpp"
#include "editor/ui/fitting.hpp"

namespace lambent::editor {

namespace {

const char* stateWord(frame::BundleStatus::State state) {
  using State = frame::BundleStatus::State;
  switch (state) {
    case State::Closed:
      return "closed";
    case State::Loading:
      return "loading";
    case State::Partial:
      return "as far as there is room";
    case State::Whole:
      return "whole";
    case State::Damaged:
      return "damaged";
  }
  return "";
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
