// Draws what is shown while the world is empty: what the program is, recent files, sample scenes.
#include <algorithm>
#include <array>
#include <cfloat>

#include <fmt/format.h>
#include <imgui.h>
#include <nlohmann/json.hpp>

#include "editor/commands/command.hpp"
#include "editor/panels/assets.hpp"
#include "editor/panels/panel.hpp"
#include "editor/ui/fitting.hpp"

namespace lambent::editor {

namespace {

constexpr float kWidthEms = 33.0f;
constexpr std::size_t kMostRecent = 6;

void open(Session& session, const std::string& file) {
  runOrLog(session, "open", std::array{file});
}

void drawTitle(const char* title) {
  ImGui::Spacing();
  ImGui::TextDisabled("%s", title);
}

// Draws a row of pictures; a click opens one.
void drawAssetTiles(Session& session, Marks& marks, const std::vector<Asset>& assets) {
  for (std::size_t i = 0; i < assets.size(); ++i) {
    if (i > 0) sameLineIfFits(em(kTileEms));
    const bool clicked = drawAssetTile(session, assets[i], kTileEms, /*selected=*/false);
    marks.put(fmt::format("start.{}", assets[i].file.filename().string()));
    if (ImGui::IsItemHovered()) tooltip(describe(session, assets[i]));
    if (clicked) open(session, assets[i].file.string());
  }
}

// Draws what was opened last: files as pictures, and below them the names of folders and of files that are
// not there any more.
void drawRecentFiles(Session& session, Marks& marks) {
  std::vector<std::string> recent = session.preferences.recent;
  recent.resize(std::min(recent.size(), kMostRecent));
  if (recent.empty()) return;
  drawTitle("Recent");
  std::vector<Asset> assets;
  std::vector<std::string> others;
  for (const std::string& file : recent)
    if (auto asset = assetAt(file))
      assets.push_back(std::move(*asset));
    else
      others.push_back(file);
  ImGui::PushID("recent");
  drawAssetTiles(session, marks, assets);
  for (const std::string& file : others) {
    const std::string name = std::filesystem::path(file).filename().string();
    ImGui::PushID(file.c_str());
    const bool clicked = ImGui::Selectable(ellipsized(name, ImGui::GetContentRegionAvail().x).c_str());
    ImGui::PopID();
    marks.put(fmt::format("start.{}", name));
    tooltip(file);
    if (clicked) open(session, file);
  }
  ImGui::PopID();
}

void drawSamples(Session& session, Marks& marks) {
  session.assets.update(session);
  std::vector<Asset> scenes;
  if (const AssetGroup* samples = session.assets.samples())
    for (const Asset& asset : samples->assets)
      if (asset.kind != AssetKind::EnvironmentMap) scenes.push_back(asset);
  if (scenes.empty()) return;
  drawTitle("Samples");
  drawAssetTiles(session, marks, scenes);
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
  drawRecentFiles(session, marks);
  drawSamples(session, marks);
  content = ImGui::GetCursorPosY() + ImGui::GetStyle().WindowPadding.y;
  ImGui::EndChild();
  marks.put("start");
  ImGui::PopStyleVar();
  ImGui::PopStyleColor();
}

}  // namespace lambent::editor
