// Draws what is shown while the world is empty: what the program is, recent files, sample scenes.
#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <imgui.h>
#include <nlohmann/json.hpp>

#include "editor/commands/command.hpp"
#include "editor/panels/panel.hpp"
#include "editor/session/samples.hpp"
#include "editor/ui/fitting.hpp"

namespace lambent::editor {

namespace {

constexpr float kWidthEms = 30.0f;
constexpr std::size_t kMostRecent = 6;

// Draws a list of files; a click opens one.
void drawFiles(Session& session, Marks& marks, const char* title, const std::vector<std::string>& files) {
  if (files.empty()) return;
  ImGui::Spacing();
  ImGui::TextDisabled("%s", title);
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::string name = std::filesystem::path(files[i]).filename().string();
    ImGui::PushID(files[i].c_str());
    const bool clicked = ImGui::Selectable(ellipsized(name, ImGui::GetContentRegionAvail().x).c_str());
    ImGui::PopID();
    marks.put(fmt::format("start.{}", name));
    tooltip(files[i]);
    if (clicked) runOrLog(session, "open", std::array{files[i]});
  }
}

}  // namespace

void drawStartPage(Session& session, Marks& marks) {
  if (!session.empty()) return;  // it would lie over handles
  const float width = std::min(em(kWidthEms), 0.9f * ImGui::GetWindowWidth());
  const float above = std::max(em(1.0f), 0.12f * ImGui::GetWindowHeight());
  ImGui::SetCursorPos(ImVec2(0.5f * (ImGui::GetWindowWidth() - width), above));
  // The view may be of any brightness, so the page has a ground of its own.
  ImGui::PushStyleColor(ImGuiCol_ChildBg, ImGui::GetStyleColorVec4(ImGuiCol_WindowBg));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(em(1.0f), em(0.75f)));
  ImGui::BeginChild("start", ImVec2(width, ImGui::GetWindowHeight() - 2.0f * above), false,
                    ImGuiWindowFlags_AlwaysUseWindowPadding);
  for (const char* line :
       {"Lambent bakes how a scene carries light, once; then any light can move in it at once.",
        "Drop a glTF scene (.gltf, .glb) here: it shows at once, and gets shadows and bounces while it "
        "bakes.",
        "Then turn the sky, add lamps, edit materials, and save it all as a world."}) {
    ImGui::TextWrapped("%s", line);
    ImGui::Spacing();
  }
  if (ImGui::Button("Open...")) runOrLog(session, "open", {});
  marks.put("start.open");
  std::vector<std::string> recent = session.preferences.recent;
  recent.resize(std::min(recent.size(), kMostRecent));
  drawFiles(session, marks, "Recent", recent);
  std::vector<std::string> samples;
  for (const std::filesystem::path& scene : sampleScenes()) samples.push_back(scene.string());
  drawFiles(session, marks, "Samples", samples);
  ImGui::EndChild();
  ImGui::PopStyleVar();
  ImGui::PopStyleColor();
}

}  // namespace lambent::editor
