// Draws the command palette: a line of words, and the commands that have all of them in their names or help.
#include <algorithm>

#include <imgui.h>
#include <imgui_stdlib.h>
#include <nlohmann/json.hpp>

#include "editor/commands/command.hpp"
#include "editor/panels/panel.hpp"
#include "editor/session/names.hpp"
#include "editor/ui/dear_imgui.hpp"
#include "editor/ui/fitting.hpp"

namespace lambent::editor {

namespace {

bool matches(const Command& command, const std::string& words) {
  return holdsWords(std::string(command.title) + ' ' + command.menu + ' ' + command.help + ' ' + command.id,
                    words);
}

void runAndClose(Session& session, const Command& command) {
  session.window.palette = false;
  ImGui::CloseCurrentPopup();
  runOrLog(session, command.id, {});
}

}  // namespace

void drawPalette(Session& session, Marks& marks) {
  if (!session.window.palette) return;
  constexpr const char* kId = "palette";
  const bool opens = !ImGui::IsPopupOpen(kId);
  if (opens) ImGui::OpenPopup(kId);
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos(ImVec2(0.5f * screen.x, 0.12f * screen.y), ImGuiCond_Always, ImVec2(0.5f, 0.0f));
  ImGui::SetNextWindowSize(ImVec2(std::min(em(34.0f), 0.96f * screen.x), 0.6f * screen.y));
  if (!ImGui::BeginPopup(kId)) {
    session.window.palette = false;  // it was closed by a click elsewhere
    return;
  }
  if (opens) ImGui::SetKeyboardFocusHere();
  ImGui::SetNextItemWidth(-1.0f);
  const bool enter = ImGui::InputTextWithHint("##words", "words of a command", &session.window.palette_words,
                                              ImGuiInputTextFlags_EnterReturnsTrue);
  marks.put("palette.words");
  ImGui::BeginChild("commands");
  bool first = true;
  for (const Command& command : commandList()) {
    if (*command.title == '\0' || *command.title == '-') continue;
    if (command.enabled && !command.enabled(session)) continue;
    if (!matches(command, session.window.palette_words)) continue;
    const bool chosen = (first && enter) || ImGui::Selectable(command.title, first);
    marks.put(std::string("palette.") + command.id);
    tooltip(command.help);
    ImGui::SameLine(em(18.0f));
    ImGui::TextDisabled("%s   %s", command.menu, command.shortcut);
    first = false;
    if (chosen) {
      runAndClose(session, command);
      break;
    }
  }
  ImGui::EndChild();
  if (escapePressed()) {
    session.window.palette = false;
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

}  // namespace lambent::editor
