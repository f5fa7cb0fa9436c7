// Draws the two lists of commands: all keys, with what the pointer does in the view, in as many columns as
// fit, and the command palette, a line of words and the commands that have all of them in their names or
// help.
#include <algorithm>
#include <array>
#include <utility>

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

using KeyRow = std::pair<const char*, const char*>;

constexpr std::array kPointer = {
    KeyRow{"Middle drag", "Orbit; also Alt and the left button"},
    KeyRow{"Shift+middle", "Pan"},
    KeyRow{"Wheel", "Nearer, farther"},
    KeyRow{"Right drag", "Look around"},
    KeyRow{"Right+WASDQE", "Fly; with Shift faster"},
    KeyRow{"Right click", "Menu of the selection"},
    KeyRow{"Click", "Select; with Ctrl or Shift several"},
    KeyRow{"Shift+drag", "Finer: numbers, handles"},
    KeyRow{"Ctrl+drag", "In steps, or freely"},
    KeyRow{"Alt+drag", "Coarser: numbers"},
    KeyRow{"Double click", "In the tree: frame"},
};

constexpr float kColumnEms = 22.0f, kKeyEms = 7.5f;

}  // namespace

void drawKeys(Session& session, Marks& marks) {
  if (!session.window.keys) return;
  constexpr const char* kTitle = "Keys and pointer";
  if (!ImGui::IsPopupOpen(kTitle)) ImGui::OpenPopup(kTitle);
  std::vector<KeyRow> rows;
  for (const Command& command : commandList())
    if (*command.shortcut != '\0') rows.emplace_back(command.shortcut, command.title);
  rows.insert(rows.end(), kPointer.begin(), kPointer.end());
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  const ImVec2 most(0.96f * screen.x, 0.92f * screen.y);
  const int columns = std::clamp(static_cast<int>(most.x / em(kColumnEms)), 1, 3);
  const auto lines = static_cast<float>((static_cast<int>(rows.size()) + columns - 1) / columns);
  ImGui::SetNextWindowSize(ImVec2(std::min(most.x, static_cast<float>(columns) * em(kColumnEms)),
                                  std::min(most.y, (lines + 5.0f) * ImGui::GetTextLineHeightWithSpacing())));
  ImGui::SetNextWindowPos(ImVec2(0.5f * screen.x, 0.5f * screen.y), ImGuiCond_Always, ImVec2(0.5f, 0.5f));
  bool open = true;
  if (!ImGui::BeginPopupModal(kTitle, &open, ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoResize))
    return;
  ImGui::BeginChild("keys", ImVec2(0.0f, -1.5f * ImGui::GetFrameHeight()));
  if (ImGui::BeginTable("keys", 2 * columns)) {
    for (int column = 0; column < columns; ++column) {
      ImGui::TableSetupColumn("key", ImGuiTableColumnFlags_WidthFixed, em(kKeyEms));
      ImGui::TableSetupColumn("command", ImGuiTableColumnFlags_WidthStretch);
    }
    for (std::size_t line = 0; line < static_cast<std::size_t>(lines); ++line) {
      ImGui::TableNextRow();
      for (std::size_t i = line; i < rows.size(); i += static_cast<std::size_t>(lines)) {
        ImGui::TableNextColumn();
        fittedText(rows[i].first);
        ImGui::TableNextColumn();
        fittedText(rows[i].second);
      }
    }
    ImGui::EndTable();
  }
  ImGui::EndChild();
  const bool close = ImGui::Button("Close", ImVec2(em(7.4f), 0.0f)) || escapePressed();
  marks.put("keys.close");
  if (close || !open) {
    session.window.keys = false;
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

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
