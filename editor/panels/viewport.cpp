#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <imgui.h>
#include <nlohmann/json.hpp>

#include "editor/commands/command.hpp"
#include "editor/panels/panel.hpp"
#include "editor/panels/widgets.hpp"
#include "editor/render/renderer.hpp"
#include "editor/session/viewing.hpp"
#include "editor/ui/dear_imgui.hpp"

namespace lambent::editor {

namespace {

constexpr float kBarWidth = 3.0f;
constexpr float kFlyFast = 4.0f;

ImTextureID handleOf(const gpu::Texture& texture) {
  return textureOf(texture.id());
}

// Applies the pointer and the keys to the camera.
void moveEye(Session& session, const Viewport& viewport, bool hovered) {
  const ImGuiIO& io = ImGui::GetIO();
  CameraInput input;
  input.height_px = viewport.height;
  input.seconds = io.DeltaTime;
  const glm::vec2 delta(io.MouseDelta.x, io.MouseDelta.y);
  const bool active = ImGui::IsItemActive();
  session.viewing.flying = false;
  if (active && ImGui::IsMouseDown(ImGuiMouseButton_Middle)) {
    (io.KeyShift ? input.pan_px : input.orbit_px) = delta;
  } else if (active && io.KeyAlt && ImGui::IsMouseDown(ImGuiMouseButton_Left)) {
    (io.KeyShift ? input.pan_px : input.orbit_px) = delta;
  } else if (active && ImGui::IsMouseDown(ImGuiMouseButton_Right)) {
    input.look_px = delta;
    const auto held = [](int letter) { return keyHeld(letter) ? 1.0f : 0.0f; };
    input.fly = {held('D') - held('A'), held('E') - held('Q'), held('W') - held('S')};
    input.fly_speed = io.KeyShift ? kFlyFast : 1.0f;
    session.viewing.flying = input.fly != glm::vec3(0.0f);
  }
  if (hovered) input.dolly = io.MouseWheel;
  const bool any = input.orbit_px != glm::vec2(0.0f) || input.look_px != glm::vec2(0.0f) ||
                   input.pan_px != glm::vec2(0.0f) || input.dolly != 0.0f || session.viewing.flying;
  if (any) session.viewing.move(session.document, input);
}

void drawFrame(const Session& session, const Renderer& renderer, const ImVec2& low, const ImVec2& high) {
  ImDrawList* canvas = ImGui::GetWindowDrawList();
  // Row 0 of the frame's pictures is the bottom.
  canvas->AddImage(handleOf(renderer.picture.texture()), low, high, ImVec2(0.0f, 1.0f), ImVec2(1.0f, 0.0f));
  const ReferenceView& reference = session.reference;
  if (!reference.on()) return;
  const gpu::Texture& beside = renderer.reference.texture(reference.split);
  const float at = low.x + reference.split_at * (high.x - low.x);
  if (!beside || !reference.shows()) {
    // The plain picture must not pass for a reference or a difference.
    canvas->AddRectFilled(ImVec2(at, low.y), high, IM_COL32(38, 38, 40, 255));
    canvas->AddLine(ImVec2(at, low.y), ImVec2(at, high.y), IM_COL32(255, 255, 255, 200), kBarWidth);
    return;
  }
  canvas->AddImage(handleOf(beside), ImVec2(at, low.y), high, ImVec2(reference.split_at, 0.0f),
                   ImVec2(1.0f, 1.0f));
  canvas->AddLine(ImVec2(at, low.y), ImVec2(at, high.y), IM_COL32(255, 255, 255, 200), kBarWidth);
}

// Draws the edge between both pictures, which can be dragged.
bool dragSplit(Session& session, Marks& marks, const ImVec2& low, const ImVec2& high) {
  if (!session.reference.on()) return false;
  const float width = high.x - low.x, at = low.x + session.reference.split_at * width;
  ImGui::SetCursorScreenPos(ImVec2(at - 5.0f, low.y));
  ImGui::InvisibleButton("split", ImVec2(10.0f, high.y - low.y));
  marks.put("split");
  const bool active = ImGui::IsItemActive(), hovered = ImGui::IsItemHovered();
  if (active || hovered) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
  if (active)
    session.reference.split_at = std::clamp((ImGui::GetIO().MousePos.x - low.x) / width, 0.0f, 1.0f);
  return active || hovered;
}

void textOver(const ImVec2& at, const std::string& text, ImU32 color = IM_COL32(235, 235, 235, 255)) {
  ImDrawList* canvas = ImGui::GetWindowDrawList();
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  canvas->AddRectFilled(ImVec2(at.x - 5.0f, at.y - 2.0f), ImVec2(at.x + size.x + 5.0f, at.y + size.y + 2.0f),
                        IM_COL32(0, 0, 0, 150), 3.0f);
  canvas->AddText(at, color, text.c_str());
}

// Draws what the selected camera sees into a corner. Returns whether the pointer is over it.
bool drawPreview(Session& session, const Renderer& renderer, Marks& marks, const ImVec2& low,
                 const ImVec2& high) {
  const gpu::Texture& preview = renderer.picture.preview();
  if (!preview) return false;
  constexpr float kShare = 0.3f, kGap = 12.0f;
  const auto texels =
      ImVec2(static_cast<float>(preview.desc().width), static_cast<float>(preview.desc().height));
  const float zoom =
      std::min(kShare * (high.x - low.x) / texels.x, 1.5f * kShare * (high.y - low.y) / texels.y);
  const ImVec2 size(zoom * texels.x, zoom * texels.y);
  const ImVec2 at(high.x - kGap - size.x, high.y - kGap - size.y);
  const ImVec2 end(at.x + size.x, at.y + size.y);
  ImDrawList* canvas = ImGui::GetWindowDrawList();
  canvas->AddImage(handleOf(preview), at, end, ImVec2(0.0f, 1.0f), ImVec2(1.0f, 0.0f));
  canvas->AddRect(ImVec2(at.x - 1.0f, at.y - 1.0f), ImVec2(end.x + 1.0f, end.y + 1.0f),
                  IM_COL32(235, 235, 235, 255));
  const std::string name = session.document.nameOf(selectedCamera(session));
  textOver(ImVec2(at.x + 8.0f, at.y + 5.0f), ellipsized(name, size.x - 16.0f));
  ImGui::SetCursorScreenPos(at);
  if (ImGui::InvisibleButton("camera preview", size)) runOrLog(session, "look-through", {});
  marks.put("camera-preview");
  tooltip("What this camera sees\nClick: look through it (C). Shift+C: place it where the view is.");
  return ImGui::IsItemHovered() || ImGui::IsItemActive();
}

void drawLegends(Session& session, Marks& marks, const ImVec2& low, const ImVec2& high) {
  const auto& view = session.viewing.surfaces;
  std::string left = std::string(frame::rowOf(view.view).label);
  const frame::ViewLegend& legend = session.picture.legend;
  if (legend.colors == frame::ViewColors::Scale)
    left = fmt::format("{}: {:.3g} (dark) to {:.3g} (bright) {}", legend.name, legend.min, legend.max,
                       legend.unit);
  if (view.view != frame::SurfaceView::Final || session.reference.on())
    textOver(ImVec2(low.x + 12.0f, low.y + 10.0f), left);
  if (!session.reference.on()) return;
  const ReferenceView& reference = session.reference;
  std::string right = reference.split == SplitView::Heat ? "Difference" : "Reference";
  right += ": ";
  if (!reference.shows()) {
    right += reference.split == SplitView::Heat ? "it comes with the first full pass" : "not there yet";
    if (!reference.notice().empty()) right += "; now ";
  }
  right += reference.notice();
  const float begins = low.x + reference.split_at * (high.x - low.x) + 12.0f;
  textOver(ImVec2(begins, low.y + 10.0f), ellipsized(right, std::max(0.0f, high.x - begins - 12.0f)));
  if (const auto& difference = reference.difference()) {
    const baker::PictureError& e = difference->figures;
    std::string figures =
        fmt::format("relative RMS {:.2f} %   bias {:+.2f} {:+.2f} {:+.2f} %   99th percentile {:.1f} %",
                    100.0 * e.relative_rms, 100.0 * e.bias[0], 100.0 * e.bias[1], 100.0 * e.bias[2],
                    100.0 * e.percentile_99);
    if (reference.split == SplitView::Heat)
      figures += fmt::format("   colors to ±{:.0f} %", 100.0 * difference->range);
    const float line = em(1.75f);
    textOver(ImVec2(low.x + 12.0f, high.y - line), ellipsized(figures, high.x - low.x - 24.0f));
    marks.put("difference", {{low.x, high.y - line}, {high.x, high.y}});
  }
}

// Selects what is at a pixel of the picture, or adds it to the selection with Ctrl or Shift.
void pick(Session& session, Renderer& renderer, const glm::vec2& pixel) {
  const auto picked = renderer.picture.pick(session, pixel.x, pixel.y);
  if (!picked) return session.log.error(picked.error());
  const ImGuiIO& io = ImGui::GetIO();
  const bool beside = io.KeyCtrl || io.KeyShift;
  if (!*picked) {
    if (!beside) session.selection.clear();
    return;
  }
  const StableId id = session.document.idOf((*picked)->node);
  if (beside)
    session.selection.toggle(id);
  else
    session.selection.set(id);
}

// Takes an asset that is dropped onto the last widget.
void takeAsset(Session& session) {
  if (!ImGui::BeginDragDropTarget()) return;
  if (const ImGuiPayload* payload = ImGui::AcceptDragDropPayload(kDraggedAsset))
    runOrLog(session, "use-asset", std::array{std::string(static_cast<const char*>(payload->Data))});
  ImGui::EndDragDropTarget();
}

// Draws the menu that a right click in the view opens. A drag with that button looks around and opens none.
void drawViewMenu(Session& session, Marks& marks) {
  const bool clicked = ImGui::IsMouseReleased(ImGuiMouseButton_Right) && session.viewing.hovered &&
                       ImGui::GetIO().MouseDragMaxDistanceSqr[1] < kClickPixels * kClickPixels;
  if (clicked) ImGui::OpenPopup("view menu");
  if (!ImGui::BeginPopup("view menu")) return;
  drawSelectionMenu(session, marks);
  ImGui::EndPopup();
}

}  // namespace

void drawViewport(Session& session, Renderer& renderer, Marks& marks) {
  const ImVec2 low = ImGui::GetCursorScreenPos();
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const ImVec2 high(low.x + std::max(16.0f, room.x), low.y + std::max(16.0f, room.y));
  const Viewport viewport{low.x, low.y, high.x - low.x, high.y - low.y};
  const float scale = session.viewing.scale.now();
  renderer.update(session, {static_cast<std::uint32_t>(std::max(16.0f, scale * viewport.width)),
                            static_cast<std::uint32_t>(std::max(16.0f, scale * viewport.height))});
  drawFrame(session, renderer, low, high);
  const bool over_split = dragSplit(session, marks, low, high);
  const bool over_preview = drawPreview(session, renderer, marks, low, high);

  ImGui::SetCursorScreenPos(low);
  ImGui::InvisibleButton("picture", ImVec2(viewport.width, viewport.height),
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                             ImGuiButtonFlags_MouseButtonMiddle);
  marks.put("viewport");
  takeAsset(session);
  const bool hovered = session.viewing.hovered = ImGui::IsItemHovered();
  moveEye(session, viewport, hovered);
  const auto clicked =
      over_split || over_preview ? std::nullopt : manipulate(session, marks, viewport, hovered);
  if (clicked) pick(session, renderer, scale * *clicked);
  drawLegends(session, marks, low, high);
  drawViewMenu(session, marks);
  ImGui::SetCursorScreenPos(low);
  drawStartPage(session, marks);
}

}  // namespace lambent::editor
