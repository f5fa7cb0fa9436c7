#include <algorithm>
#include <array>
#include <string>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>
#include <nlohmann/json.hpp>

#include "baker/bake/options.hpp"
#include "editor/commands/command.hpp"
#include "editor/panels/panel.hpp"
#include "editor/session/scene_changes.hpp"
#include "editor/ui/dear_imgui.hpp"

namespace lambent::editor {

namespace {

// Shows a tooltip for the last widget.
void tellHelp(const baker::OptionRow& row) {
  tooltip(std::string(row.kind) + ": " + row.help);
}

// Returns true when another word was chosen or typed.
bool editOptionWord(Marks& marks, const baker::OptionRow& row, const std::string& mark, std::string& word) {
  ImGui::SetNextItemWidth(em(10.7f));
  if (!row.only_words) {
    const bool changed = ImGui::InputText(
        "##word", &word, ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll);
    marks.put(mark);
    tellHelp(row);
    return changed;
  }
  const bool open = ImGui::BeginCombo("##word", word.c_str());
  marks.put(mark);
  tellHelp(row);
  if (!open) return false;
  bool changed = false;
  for (const auto& [choice, value] : row.words) {
    const std::string text(choice);
    if (ImGui::Selectable(text.c_str(), text == word)) word = text, changed = true;
    marks.put(mark + "." + text);
  }
  ImGui::EndCombo();
  return changed;
}

void drawBakeOptions(Session& session, Marks& marks, std::size_t scene) {
  if (!ImGui::BeginTable("options", 2, ImGuiTableFlags_SizingFixedFit)) return;
  for (const baker::OptionRow& row : baker::optionRows()) {
    const std::string name(row.name);
    std::string word = row.word(session.scenes.entries()[scene].options);
    ImGui::PushID(name.c_str());
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(name.c_str());
    tellHelp(row);
    ImGui::TableNextColumn();
    if (editOptionWord(marks, row, "bake-option." + name, word)) {
      const std::array words = {name, word, std::to_string(scene)};
      runOrLog(session, "bake-option", words);
    }
    ImGui::PopID();
  }
  ImGui::EndTable();
  ImGui::TextDisabled("Return takes a word over; they hold from the next bake on.");
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

bool works(const baker::JobState& job) {
  using Phase = baker::JobPhase;
  return job.phase == Phase::Waiting || job.phase == Phase::Importing || job.phase == Phase::Baking;
}

void drawProgress(const baker::JobState& job) {
  const std::string left = job.seconds_left ? ", " + timeText(*job.seconds_left) + " left" : std::string();
  const std::string text =
      job.phase == baker::JobPhase::Waiting ? "waits" : fmt::format("{:.0f} %{}", 100.0 * job.fraction, left);
  ImGui::ProgressBar(static_cast<float>(job.fraction), ImVec2(-1.0f, 0.0f), text.c_str());
}

std::string reportText(const baker::BakeReport& r) {
  std::string text = fmt::format("{} vertices, {} rays", countText(static_cast<double>(r.vertices)),
                                 countText(static_cast<double>(r.rays)));
  if (r.file_bytes > 0) text += ", " + bytesText(static_cast<double>(r.file_bytes));
  if (r.worst_error > 0.0) text += fmt::format(", coding {:.2f} %", 100.0 * r.worst_error);
  return text;
}

// Returns what the bake does now, or what came of it.
std::string newsOf(const baker::JobState& job) {
  if (std::string now = stageText(job); !now.empty()) return now;
  if (job.phase == baker::JobPhase::Done && job.report)
    return fmt::format("{}, {}", timeText(job.seconds), reportText(*job.report));
  return {};
}

// Returns how wrong the pictures of the shown bundle are by what its bake measured, in percent.
std::string pictureErrorText(const Session& session, const SceneEntry& entry) {
  if (!entry.slot) return {};
  double worst = -1.0;
  for (const bundle::Group& group : session.stage.world().description(*entry.slot).groups)
    if (group.picture_error) worst = std::max(worst, double{group.picture_error->all});
  return worst < 0.0 ? std::string() : fmt::format("pictures err by {:.1f} %", 100.0 * worst);
}

void drawState(const SceneStatus& status) {
  fittedText(standingColor(status.standing), status.text, status.detail);
}

// Draws a button with a mark, in the line of the last one if it fits there.
bool smallButton(Marks& marks, const char* text, const std::string& mark, const char* help = "",
                 bool first = false) {
  if (!first) sameLineIfFits(text);
  const bool pressed = ImGui::SmallButton(text);
  marks.put(mark);
  tooltip(help);
  return pressed;
}

// Draws the buttons of an open scene. Returns false if it was closed.
bool drawButtons(Session& session, Marks& marks, std::size_t i, bool working) {
  const SceneEntry& entry = session.scenes.entries()[i];
  const bool has_source = !entry.source.empty();
  const std::string number = std::to_string(i), mark = fmt::format("bakes.{}.", entry.id);
  if (working) {
    if (smallButton(marks, "Cancel", mark + "cancel", "", /*first=*/true))
      runOrLog(session, "cancel", std::array{number});
  } else if (has_source && smallButton(marks, "Bake", mark + "bake", "", /*first=*/true)) {
    runOrLog(session, "bake", std::array{number});
  }
  if (has_source && smallButton(marks, "Options", mark + "options")) ImGui::OpenPopup("options");
  if (ImGui::BeginPopup("options")) {
    drawBakeOptions(session, marks, i);
    ImGui::EndPopup();
  }
  const bool close = smallButton(marks, "Close", mark + "close", "", /*first=*/!working && !has_source);
  if (close) runOrLog(session, "close", std::array{number});
  return !close;
}

// Draws the row of an open scene. Returns false if it was closed.
bool drawScene(Session& session, Marks& marks, std::size_t i) {
  const SceneEntry& entry = session.scenes.entries()[i];
  const auto job = session.scenes.jobOf(i);
  const bool working = job && works(*job);
  const std::string mark = fmt::format("bakes.{}.", entry.id);
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  fittedText(entry.id, fmt::format("{}\n{}", entry.source.string(), entry.bundle.string()));
  ImGui::TableNextColumn();
  drawState(statusOf(session, i));
  marks.put(mark + "state");
  ImGui::TableNextColumn();
  if (working) drawProgress(*job);
  marks.put(mark + "progress");
  std::string news = job ? newsOf(*job) : std::string();
  if (const std::string error = pictureErrorText(session, entry); !working && !error.empty())
    news = news.empty() ? error : error + "; " + news;
  fittedText(news);
  ImGui::TableNextColumn();
  return drawButtons(session, marks, i, working);
}

// Returns the width of the column of buttons: of the widest row, or in a narrow table of the widest button,
// because buttons beyond the border would have to be looked for.
float buttonsWidth(bool narrow) {
  const ImGuiStyle& style = ImGui::GetStyle();
  float row = 2.0f * style.ItemSpacing.x, widest = 0.0f;
  for (const char* text : {"Cancel", "Options", "Close"}) {
    const float width = ImGui::CalcTextSize(text).x + 2.0f * style.FramePadding.x;
    row += width;
    widest = std::max(widest, width);
  }
  return (narrow ? widest : row) + style.CellPadding.x;
}

}  // namespace

void drawBakes(Session& session, Marks& marks) {
  if (session.scenes.entries().empty()) {
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextDisabled(
        "Nothing is open. Drop a .gltf, .glb or .lmb.glb file onto the window, or File > Open.");
    ImGui::PopTextWrapPos();
    return;
  }
  constexpr ImGuiTableFlags kTable = ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerV |
                                     ImGuiTableFlags_Resizable | ImGuiTableFlags_ScrollY |
                                     ImGuiTableFlags_ScrollX;
  const float room = ImGui::GetContentRegionAvail().x;
  const bool narrow = room < em(34.0f);
  // Dear ImGui keeps the widths of columns by the table's name.
  if (!ImGui::BeginTable(narrow ? "narrow bakes" : "bakes", 4, kTable, ImVec2(0.0f, 0.0f),
                         std::max(room, em(20.0f))))
    return;
  ImGui::TableSetupColumn("Scene", ImGuiTableColumnFlags_WidthStretch, 0.2f);
  ImGui::TableSetupColumn("State", ImGuiTableColumnFlags_WidthStretch, 0.25f);
  ImGui::TableSetupColumn("Bake", ImGuiTableColumnFlags_WidthStretch, 0.55f);
  ImGui::TableSetupColumn("##buttons", ImGuiTableColumnFlags_WidthFixed, buttonsWidth(narrow));
  ImGui::TableSetupScrollFreeze(0, 1);
  ImGui::TableHeadersRow();
  for (std::size_t i = 0; i < session.scenes.entries().size(); ++i) {
    ImGui::PushID(static_cast<int>(i));
    const bool stays = drawScene(session, marks, i);
    ImGui::PopID();
    if (!stays) break;
  }
  ImGui::EndTable();
}

}  // namespace lambent::editor
