// Draws the steps of the history, oldest first. A click undoes or redoes up to that step.
#include <imgui.h>

#include "editor/panels/panel.hpp"
#include "editor/ui/fitting.hpp"

namespace lambent::editor {

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
