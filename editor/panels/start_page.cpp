#include <algorithm>
#include <array>
#include <cfloat>
#include <iterator>

#include <fmt/format.h>
#include <imgui.h>
#include <nlohmann/json.hpp>

#include "baker/pipeline/source_watch.hpp"
#include "editor/commands/command.hpp"
#include "editor/panels/panel.hpp"
#include "editor/ui/dear_imgui.hpp"
#include "runtime/base/process.hpp"

namespace lambent::editor {

namespace {

constexpr float kWidthEms = 33.0f;
constexpr std::size_t kMostRecent = 6;

// Returns the sample scenes that came with the program.
std::vector<std::filesystem::path> sampleScenes() {
  std::vector<std::filesystem::path> scenes;
  for (const std::filesystem::path& folder : sampleFolders())
    std::ranges::copy(baker::scenesIn(folder), std::back_inserter(scenes));
  return scenes;
}

// Draws a list of files by their names; a click opens one.
void drawFiles(Session& session, Marks& marks, const char* title,
               const std::vector<std::filesystem::path>& files) {
  if (files.empty()) return;
  ImGui::Spacing();
  ImGui::TextDisabled("%s", title);
  ImGui::PushID(title);
  for (const std::filesystem::path& file : files) {
    const std::string name = file.filename().string();
    ImGui::PushID(file.c_str());
    const bool clicked = ImGui::Selectable(ellipsized(name, ImGui::GetContentRegionAvail().x).c_str());
    ImGui::PopID();
    marks.put(fmt::format("start.{}", name));
    tooltip(file.string());
    if (clicked) runOrLog(session, "open", std::array{file.string()});
  }
  ImGui::PopID();
}

}  // namespace

void drawStartPage(Session& session, Marks& marks) {
  if (!session.empty()) return;  // it would lie over handles
  const float width = std::min(em(kWidthEms), 0.9f * ImGui::GetWindowWidth());
  const float top = ImGui::GetCursorPosY(), room = ImGui::GetWindowHeight() - top;  // below the tool bar
  const float above = std::max(em(0.5f), 0.05f * room);
  ImGui::SetCursorPos(ImVec2(0.5f * (ImGui::GetWindowWidth() - width), top + above));
  // The view may be of any brightness, so the page has a ground of its own.
  ImGui::PushStyleColor(ImGuiCol_ChildBg, ImGui::GetStyleColorVec4(ImGuiCol_WindowBg));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(em(1.0f), em(0.75f)));
  // The page is as high as what it showed in the frame before, or scrolls.
  float& content = *ImGui::GetStateStorage()->GetFloatRef(ImGui::GetID("start height"), FLT_MAX);
  const float height = std::min(content, room - 2.0f * above);
  ImGui::BeginChild("start", ImVec2(width, height), false, ImGuiWindowFlags_AlwaysUseWindowPadding);
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
  const std::vector<std::string>& recent = session.preferences.recent;
  const auto end = recent.begin() + static_cast<std::ptrdiff_t>(std::min(recent.size(), kMostRecent));
  drawFiles(session, marks, "Recent", {recent.begin(), end});
  drawFiles(session, marks, "Samples", sampleScenes());
  content = ImGui::GetCursorPosY() + ImGui::GetStyle().WindowPadding.y;
  ImGui::EndChild();
  marks.put("start");
  ImGui::PopStyleVar();
  ImGui::PopStyleColor();
}

}  // namespace lambent::editor
