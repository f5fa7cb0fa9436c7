#include <algorithm>
#include <ctime>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <imgui.h>

#include "editor/panels/panel.hpp"
#include "editor/panels/widgets.hpp"
#include "editor/ui/dear_imgui.hpp"

namespace lambent::editor {

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
