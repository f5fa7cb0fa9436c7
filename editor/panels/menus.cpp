#include <array>
#include <cstring>

#include <imgui.h>
#include <nlohmann/json.hpp>

#include "editor/commands/command.hpp"
#include "editor/panels/panel.hpp"
#include "editor/session/status.hpp"

namespace lambent::editor {

namespace {

void report(Session& session, const Result<nlohmann::json>& done) {
  if (!done) session.log.error(done.error());
}

void drawItem(Session& session, Marks& marks, const Command& command) {
  const bool enabled = !command.enabled || command.enabled(session);
  const bool checked = command.checked && command.checked(session);
  if (ImGui::MenuItem(command.title, command.shortcut, checked, enabled))
    report(session, runCommand(session, command.id, {}));
  marks.put(std::string("menu.") + command.id);
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", command.help);
}

// Runs shortcuts, except while text is being typed.
void runShortcuts(Session& session) {
  const ImGuiIO& io = ImGui::GetIO();
  // W, A, S and D fly the camera while the right button is held.
  if (io.WantTextInput || ImGui::IsMouseDown(ImGuiMouseButton_Right) ||
      ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId))
    return;
  for (const Command& command : commandList()) {
    if (*command.shortcut == '\0') continue;
    const auto keys = parseShortcut(command.shortcut);
    if (!keys || io.KeyCtrl != keys->ctrl || io.KeyShift != keys->shift || io.KeyAlt != keys->alt) continue;
    if (!ImGui::IsKeyPressed(keys->key, /*repeat=*/false)) continue;
    if (command.enabled && !command.enabled(session)) continue;
    report(session, runCommand(session, command.id, {}));
  }
}

void drawRecent(Session& session, Marks& marks) {
  if (!ImGui::BeginMenu("Recent", !session.preferences.recent.empty())) return;
  for (const std::string& file : std::vector(session.preferences.recent))
    if (ImGui::MenuItem(file.c_str())) report(session, runCommand(session, "open", std::array{file}));
  ImGui::EndMenu();
  marks.put("menu.recent");
}

void drawPanelItems(Session& session) {
  ImGui::Separator();
  for (const Panel& panel : panelList())
    if (ImGui::MenuItem(panel.name)) session.window.wanted_panels.emplace_back(panel.name);
}

}  // namespace

void drawMenus(Session& session, Marks& marks) {
  runShortcuts(session);
  if (!ImGui::BeginMainMenuBar()) return;
  constexpr std::array kMenus = {"File", "Edit", "Create", "View", "Bake", "Help"};
  for (const char* menu : kMenus) {
    const bool open = ImGui::BeginMenu(menu);
    marks.put(std::string("menu.") + menu);
    if (!open) continue;
    for (const Command& command : commandList()) {
      if (std::strcmp(command.menu, menu) != 0) continue;
      if (*command.title == '-')
        ImGui::Separator();
      else if (*command.title != '\0')
        drawItem(session, marks, command);
      if (std::strcmp(command.id, "open") == 0) drawRecent(session, marks);
    }
    if (std::strcmp(menu, "View") == 0) drawPanelItems(session);
    ImGui::EndMenu();
  }
  const std::string status = statusOf(session);
  const float width = ImGui::CalcTextSize(status.c_str()).x;
  ImGui::SameLine(ImGui::GetWindowWidth() - width - 16.0f);
  ImGui::TextDisabled("%s", status.c_str());
  marks.put("status");
  ImGui::EndMainMenuBar();
}

}  // namespace lambent::editor
