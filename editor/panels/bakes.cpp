#include <array>

#include <fmt/format.h>
#include <imgui.h>
#include <nlohmann/json.hpp>

#include "editor/commands/command.hpp"
#include "editor/panels/colors.hpp"
#include "editor/panels/panel.hpp"
#include "editor/panels/text.hpp"

namespace lambent::editor {

namespace {

void report(Session& session, const Result<nlohmann::json>& done) {
  if (!done) session.log.error(done.error());
}

std::string stageText(const baker::JobState& job) {
  if (job.stage.name.empty()) return {};
  std::string text = fmt::format(
      "{}: {}", job.preview_level ? baker::previewLevelName(*job.preview_level) : "", job.stage.name);
  if (job.stage.total > 0)
    text += fmt::format(" {} of {} {}", countText(static_cast<double>(job.stage.done)),
                        countText(static_cast<double>(job.stage.total)), job.stage.unit);
  if (job.units_per_s > 0.0) text += fmt::format(", {} a second", countText(job.units_per_s));
  return text;
}

void drawProgress(const baker::JobState& job) {
  using Phase = baker::JobPhase;
  const ImVec2 size(-1.0f, 0.0f);
  switch (job.phase) {
    case Phase::Done: {
      ImGui::PushStyleColor(ImGuiCol_Text, kGoodColor);
      ImGui::TextUnformatted(job.up_to_date ? "up to date"
                                            : fmt::format("done in {}", timeText(job.seconds)).c_str());
      ImGui::PopStyleColor();
      break;
    }
    case Phase::Failed:
      ImGui::PushStyleColor(ImGuiCol_Text, kErrorColor);
      ImGui::TextWrapped("%s", job.error ? job.error->line().c_str() : "failed");
      ImGui::PopStyleColor();
      break;
    case Phase::Cancelled:
      ImGui::TextDisabled("cancelled");
      break;
    case Phase::Waiting:
      ImGui::ProgressBar(static_cast<float>(job.fraction), size, "waits");
      break;
    case Phase::Importing:
    case Phase::Baking: {
      const std::string left =
          job.seconds_left ? ", " + timeText(*job.seconds_left) + " left" : std::string();
      ImGui::ProgressBar(static_cast<float>(job.fraction), size,
                         fmt::format("{:.0f} %{}", 100.0 * job.fraction, left).c_str());
    }
  }
}

std::string reportText(const baker::BakeReport& r) {
  std::string text = fmt::format("{} vertices, {} rays", countText(static_cast<double>(r.vertices)),
                                 countText(static_cast<double>(r.rays)));
  if (r.file_bytes > 0) text += ", " + bytesText(static_cast<double>(r.file_bytes));
  if (r.worst_error > 0.0) text += fmt::format(", coding {:.2f} %", 100.0 * r.worst_error);
  return text;
}

}  // namespace

void drawBakes(Session& session, Marks& marks) {
  const auto& entries = session.scenes.entries();
  if (entries.empty()) {
    ImGui::TextDisabled(
        "Nothing is open. Drop a .gltf, .glb or .lmb.glb file onto the window, or File > Open.");
    return;
  }
  constexpr ImGuiTableFlags kTable = ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerV |
                                     ImGuiTableFlags_Resizable | ImGuiTableFlags_ScrollY;
  if (!ImGui::BeginTable("bakes", 5, kTable)) return;
  ImGui::TableSetupColumn("Scene", ImGuiTableColumnFlags_WidthStretch, 0.2f);
  ImGui::TableSetupColumn("Shown", ImGuiTableColumnFlags_WidthFixed, 90.0f);
  ImGui::TableSetupColumn("Bake", ImGuiTableColumnFlags_WidthStretch, 0.3f);
  ImGui::TableSetupColumn("Now, or what came of it", ImGuiTableColumnFlags_WidthStretch, 0.5f);
  ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed, 230.0f);
  ImGui::TableSetupScrollFreeze(0, 1);
  ImGui::TableHeadersRow();
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const SceneEntry& entry = entries[i];
    const auto job = session.scenes.jobOf(i);
    const std::string number = std::to_string(i), mark = fmt::format("bakes.{}.", entry.id);
    ImGui::PushID(static_cast<int>(i));
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(entry.id.c_str());
    if (ImGui::IsItemHovered())
      ImGui::SetTooltip("%s\n%s", entry.source.string().c_str(), entry.bundle.string().c_str());
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(job && job->reached      ? baker::previewLevelName(*job->reached)
                           : entry.slot.has_value() ? "bundle"
                                                    : "nothing yet");
    ImGui::TableNextColumn();
    if (job)
      drawProgress(*job);
    else
      ImGui::TextDisabled(entry.source.empty() ? "no source" : "not asked for");
    marks.put(mark + "progress");
    ImGui::TableNextColumn();
    if (job) {
      const std::string now = stageText(*job);
      ImGui::TextUnformatted(!now.empty()  ? now.c_str()
                             : job->report ? reportText(*job->report).c_str()
                                           : "");
    }
    ImGui::TableNextColumn();
    const bool working =
        job && (job->phase == baker::JobPhase::Waiting || job->phase == baker::JobPhase::Importing ||
                job->phase == baker::JobPhase::Baking);
    if (working) {
      if (ImGui::SmallButton("Cancel")) report(session, runCommand(session, "cancel", std::array{number}));
      marks.put(mark + "cancel");
    } else if (!entry.source.empty()) {
      if (ImGui::SmallButton("Bake")) report(session, runCommand(session, "bake", std::array{number}));
      marks.put(mark + "bake");
    }
    ImGui::SameLine();
    if (!entry.source.empty()) {
      if (ImGui::SmallButton("Options")) ImGui::OpenPopup("options");
      marks.put(mark + "options");
      if (ImGui::BeginPopup("options")) {
        drawBakeOptions(session, marks, i);
        ImGui::EndPopup();
      }
      ImGui::SameLine();
    }
    if (ImGui::SmallButton("Close")) {
      report(session, runCommand(session, "close", std::array{number}));
      ImGui::PopID();
      break;
    }
    marks.put(mark + "close");
    ImGui::PopID();
  }
  ImGui::EndTable();
}

}  // namespace lambent::editor
