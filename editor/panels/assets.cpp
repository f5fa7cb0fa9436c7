// Draws the Assets panel: what can be opened or used as light, with pictures.
#include <array>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>
#include <nlohmann/json.hpp>

#include "editor/commands/command.hpp"
#include "editor/panels/asset_tile.hpp"
#include "editor/panels/panel.hpp"
#include "editor/ui/dear_imgui.hpp"
#include "editor/ui/fitting.hpp"

namespace lambent::editor {

namespace {

const char* useOf(AssetKind kind) {
  return kind == AssetKind::EnvironmentMap ? "Use as environment" : "Open";
}

void use(Session& session, const Asset& asset) {
  runOrLog(session, "use-asset", std::array{asset.file.string()});
}

void drawTile(Session& session, Marks& marks, const Asset& asset) {
  AssetBrowser& browser = session.assets;
  const bool clicked =
      drawAssetTile(session, asset, browser.large ? kLargeTileEms : kTileEms, browser.selected == asset.file);
  marks.put("assets." + asset.file.filename().string());
  if (clicked) browser.selected = asset.file;
  if (ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) use(session, asset);
  if (ImGui::IsItemHovered())
    tooltip(fmt::format(
        "{}\nDouble click, or drag into the view: {}", describe(session, asset),
        asset.kind == AssetKind::EnvironmentMap ? "the light from outside is this one" : "open it"));
  if (ImGui::BeginDragDropSource()) {
    const std::string file = asset.file.string();
    ImGui::SetDragDropPayload(kDraggedAsset, file.c_str(), file.size() + 1);
    ImGui::TextUnformatted(asset.file.filename().c_str());
    ImGui::EndDragDropSource();
  }
  if (ImGui::BeginPopupContextItem()) {
    browser.selected = asset.file;
    if (ImGui::MenuItem(useOf(asset.kind))) use(session, asset);
    marks.put("assets.use");
    ImGui::EndPopup();
  }
}

}  // namespace

void drawAssets(Session& session, Marks& marks) {
  AssetBrowser& browser = session.assets;
  browser.update(session);
  bool enter =
      ImGui::IsWindowFocused(ImGuiFocusedFlags_ChildWindows) && !ImGui::IsAnyItemActive() && enterPressed();
  ImGui::SetNextItemWidth(std::min(em(16.0f), ImGui::GetContentRegionAvail().x));
  enter |=
      ImGui::InputTextWithHint("##search", "search", &browser.search, ImGuiInputTextFlags_EnterReturnsTrue);
  marks.put("assets.search");
  tooltip("Parts of a name or a kind, as sky, scene, bundle or world");
  sameLineIfFits("large pictures");
  ImGui::Checkbox("large pictures", &browser.large);
  marks.put("assets.large");
  ImGui::BeginChild("tiles");
  const Asset* first = nullptr;
  const Asset* selected = nullptr;
  for (const AssetGroup& group : browser.groups()) {
    bool titled = false;
    for (const Asset& asset : group.assets) {
      if (!matches(asset, browser.search)) continue;
      if (titled) {
        sameLineIfFits(em(browser.large ? kLargeTileEms : kTileEms));
      } else {
        ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
        fittedText(group.title);
        ImGui::PopStyleColor();
      }
      titled = true;
      drawTile(session, marks, asset);
      if (!first) first = &asset;
      if (asset.file == browser.selected) selected = &asset;
    }
  }
  if (!first) ImGui::TextDisabled("%s", browser.busy() ? "Reading the folders..." : "Nothing is found.");
  ImGui::EndChild();
  if (!enter || !first) return;
  // Enter uses what is selected. While nothing of what was found is, it uses the first.
  const Asset chosen = selected ? *selected : *first;
  use(session, chosen);
}

}  // namespace lambent::editor
