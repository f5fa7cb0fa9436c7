#include <algorithm>
#include <array>
#include <cfloat>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>
#include <nlohmann/json.hpp>

#include "editor/commands/command.hpp"
#include "editor/panels/panel.hpp"
#include "editor/ui/dear_imgui.hpp"

namespace lambent::editor {

namespace {

constexpr float kShape = 16.0f / 9.0f;  // of the picture
constexpr float kTileEms = 7.0f;        // width of a tile

ImU32 colorOf(AssetKind kind) {
  constexpr std::array kColors = {IM_COL32(70, 105, 150, 255), IM_COL32(95, 95, 100, 255),
                                  IM_COL32(140, 100, 50, 255), IM_COL32(70, 120, 75, 255)};
  return kColors[static_cast<std::size_t>(kind)];
}

ImVec2 sizeOfText(const std::string& text) {
  return ImGui::CalcTextSize(text.c_str());
}

// Fills the rectangle with the middle of the picture.
void drawAssetPicture(const AssetPictures::Picture& picture, const ImVec2& low, const ImVec2& high) {
  ImVec2 cut(0.0f, 0.0f);
  if (picture.aspect > kShape)
    cut.x = 0.5f * (1.0f - kShape / picture.aspect);
  else
    cut.y = 0.5f * (1.0f - picture.aspect / kShape);
  ImGui::GetWindowDrawList()->AddImage(textureOf(picture.texture), low, high, cut,
                                       ImVec2(1.0f - cut.x, 1.0f - cut.y));
}

// Writes a word over the lower left corner of a picture.
void drawCornerSign(const std::string& word, const ImVec2& corner) {
  const ImVec2 text = sizeOfText(word);
  const ImVec2 at(corner.x + em(0.25f), corner.y - text.y - em(0.1f));
  ImDrawList* canvas = ImGui::GetWindowDrawList();
  canvas->AddRectFilled(ImVec2(corner.x, at.y - em(0.1f)), ImVec2(at.x + text.x + em(0.25f), corner.y),
                        IM_COL32(0, 0, 0, 150));
  canvas->AddText(at, IM_COL32(225, 225, 225, 255), word.c_str());
}

// Draws a tile as one widget, which is the last one afterwards. While there is no picture, the tile has the
// word of the asset's kind. Returns whether it was clicked.
bool drawAssetTile(Session& session, const Asset& asset, bool selected) {
  const float width = std::max(em(2.0f), std::min(em(kTileEms), ImGui::GetContentRegionAvail().x));
  const float height = width / kShape, line = ImGui::GetTextLineHeight();
  const ImVec2 low = ImGui::GetCursorScreenPos(), high(low.x + width, low.y + height);
  const bool clicked = ImGui::InvisibleButton(asset.file.c_str(), ImVec2(width, height + line + em(0.2f)));
  if (!ImGui::IsItemVisible()) return clicked;
  ImDrawList* canvas = ImGui::GetWindowDrawList();
  const AssetPictures::Picture& picture = session.asset_pictures.of(asset);
  const std::string kind(kindWord(asset.kind));
  if (picture.texture != 0) {
    drawAssetPicture(picture, low, high);
    // A picture shows by itself that it is an environment map.
    if (asset.kind != AssetKind::EnvironmentMap) drawCornerSign(kind, ImVec2(low.x, high.y));
  } else {
    canvas->AddRectFilled(low, high, colorOf(asset.kind));
    const std::string words = ellipsized(picture.error.empty() ? kind : "cannot be read", width - em(0.4f));
    const ImVec2 text = sizeOfText(words);
    canvas->AddText(ImVec2(low.x + 0.5f * (width - text.x), low.y + 0.5f * (height - text.y)),
                    IM_COL32(235, 235, 235, 255), words.c_str());
  }
  if (selected || ImGui::IsItemHovered())
    canvas->AddRect(low, high, ImGui::GetColorU32(selected ? kColorOfKeyboardCursor : ImGuiCol_SliderGrab),
                    0.0f, 0, em(0.15f));
  canvas->AddText(ImVec2(low.x, high.y + em(0.1f)), ImGui::GetColorU32(ImGuiCol_Text),
                  ellipsized(nameOf(asset), width).c_str());
  return clicked;
}

// Returns path, kind, size and, if the asset cannot be read, why.
std::string describe(Session& session, const Asset& asset) {
  const std::string& error = session.asset_pictures.of(asset).error;
  return fmt::format("{}\n{}, {}{}{}", asset.file.string(), kindWord(asset.kind),
                     bytesText(static_cast<double>(asset.bytes)), error.empty() ? "" : "\n", error);
}

void use(Session& session, const Asset& asset) {
  runOrLog(session, "use-asset", std::array{asset.file.string()});
}

void drawTile(Session& session, Marks& marks, const Asset& asset) {
  AssetBrowser& browser = session.assets;
  const bool clicked = drawAssetTile(session, asset, browser.selected == asset.file);
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
  ImGui::BeginChild("tiles");
  const Asset* first = nullptr;
  const Asset* selected = nullptr;
  for (const AssetGroup& group : browser.groups()) {
    bool titled = false;
    for (const Asset& asset : group.assets) {
      if (!matches(asset, browser.search)) continue;
      if (titled) {
        sameLineIfFits(em(kTileEms));
      } else {
        fittedText(dimmed(), group.title);
      }
      titled = true;
      drawTile(session, marks, asset);
      if (!first) first = &asset;
      if (asset.file == browser.selected) selected = &asset;
    }
  }
  if (!first) ImGui::TextDisabled("Nothing is found.");
  ImGui::EndChild();
  if (!enter || !first) return;
  // Enter uses what is selected. While nothing of what was found is, it uses the first.
  const Asset chosen = selected ? *selected : *first;
  use(session, chosen);
}

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
    const bool clicked = drawAssetTile(session, assets[i], /*selected=*/false);
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
