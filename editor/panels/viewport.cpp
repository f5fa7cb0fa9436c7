#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <imgui.h>
#include <nlohmann/json.hpp>

#include "editor/commands/command.hpp"
#include "editor/panels/panel.hpp"
#include "editor/render/renderer.hpp"
#include "editor/session/viewing.hpp"
#include "editor/ui/dear_imgui.hpp"

namespace lambent::editor {

namespace {

constexpr float kClickPixels = 4.0f;  // a press in the view that moves no further is a click

void paint(const Painting& painting, const Viewport& viewport) {
  ImDrawList* canvas = ImGui::GetWindowDrawList();
  canvas->PushClipRect(ImVec2(viewport.x, viewport.y),
                       ImVec2(viewport.x + viewport.width, viewport.y + viewport.height), true);
  for (const Stroke& stroke : painting) {
    std::vector<ImVec2> points;
    for (const glm::vec2& point : stroke.points) points.emplace_back(point.x, point.y);
    const int count = static_cast<int>(points.size());
    if (stroke.filled)
      canvas->AddConvexPolyFilled(points.data(), count, stroke.color);
    else
      canvas->AddPolyline(points.data(), count, stroke.color, stroke.closed ? ImDrawFlags_Closed : 0,
                          stroke.width_px);
  }
  canvas->PopClipRect();
}

void setTransforms(Session& session, const std::vector<ecs::Entity>& entities,
                   const std::vector<scene::Transform>& to) {
  std::vector<FieldEdit> edits;
  for (std::size_t i = 0; i < to.size(); ++i)
    for (FieldEdit& edit : transformEdits(entities[i], to[i])) edits.push_back(std::move(edit));
  if (!edits.empty()) logRefusal(session, session.history.setFields(edits));
}

std::vector<GizmoTarget> targetsOf(const Session& session, const std::vector<ecs::Entity>& entities) {
  const ecs::Registry& registry = session.document.registry();
  std::vector<GizmoTarget> targets;
  for (const ecs::Entity entity : entities) {
    const ecs::Entity parent = parentOf(registry, entity);
    targets.push_back({registry.get<scene::Transform>(entity),
                       registry.alive(parent) ? worldFromNode(registry, parent) : glm::mat4(1.0f)});
  }
  return targets;
}

void markHandles(const Session& session, Marks& marks) {
  const auto mark = [&](const std::string& name, const std::optional<glm::vec2>& at) {
    if (at) marks.put(name, {*at - glm::vec2(1.0f), *at + glm::vec2(1.0f)});
  };
  for (const Handle handle : kHandles)
    mark("gizmo." + std::string(handleWord(handle)), session.handles.gizmo.handleScreenPoint(handle));
  mark("gizmo.pivot", session.handles.gizmo.pivotScreenPoint());
}

void addReadout(const glm::vec2& pixel, const std::string& text) {
  if (!text.empty())
    ImGui::GetWindowDrawList()->AddText(ImVec2(pixel.x + 16.0f, pixel.y + 12.0f), IM_COL32_WHITE,
                                        text.c_str());
}

// Handles the pointer in the view, except for the camera: it picks entities and drags the handles of the
// selection. Every drag is one step of the history. Call it right after the view's own widget. Returns the
// pixel at which the user clicked to pick something, from the view's top left corner, or none if there was no
// such click.
std::optional<glm::vec2> manipulate(Session& session, Marks& marks, const Viewport& viewport, bool hovered) {
  Handles& handles = session.handles;
  if (!handles.shown) return std::nullopt;
  const spec::View& view = session.viewing.shown_view;
  const ImGuiIO& io = ImGui::GetIO();
  const glm::vec2 pixel(io.MousePos.x, io.MousePos.y);
  ecs::Registry& registry = session.document.registry();
  std::vector<ecs::Entity> entities = session.selection.topmost(session.document);
  std::erase_if(entities, [&](ecs::Entity entity) { return !registry.has<scene::Transform>(entity); });
  Gizmo& gizmo = handles.gizmo;
  gizmo.setView(view, viewport);
  gizmo.setTargets(targetsOf(session, entities));

  std::optional<glm::vec2> clicked;
  const bool eye_moves = io.KeyAlt;
  if (hovered && !gizmo.dragging()) gizmo.hover(pixel);
  if (hovered && ImGui::IsMouseClicked(ImGuiMouseButton_Left) && !eye_moves) {
    handles.pointer.press(pixel);
    if (gizmo.press(pixel)) {
      session.history.begin(fmt::format("{} of {}",
                                        gizmo.options.mode == GizmoMode::Move     ? "move"
                                        : gizmo.options.mode == GizmoMode::Rotate ? "turn"
                                                                                  : "scale",
                                        entitiesName(session.document, entities)));
    }
  }
  if (gizmo.dragging()) {
    const glm::vec2 at = handles.pointer.moved(pixel, /*fine=*/io.KeyShift);
    if (escapePressed()) {
      gizmo.release();
      session.history.cancel();
    } else if (ImGui::IsMouseDown(ImGuiMouseButton_Left)) {
      setTransforms(session, entities, gizmo.drag(at, /*other_snap=*/io.KeyCtrl));
    } else {
      gizmo.release();
      session.history.commit();
    }
  } else if (hovered && ImGui::IsMouseReleased(ImGuiMouseButton_Left) && !eye_moves &&
             ImGui::GetIO().MouseDragMaxDistanceSqr[0] <= kClickPixels * kClickPixels) {
    clicked = pixel - glm::vec2(viewport.x, viewport.y);
  }
  paint(gizmo.paint(), viewport);
  addReadout(pixel, gizmo.readout());
  markHandles(session, marks);
  return clicked;
}

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

  ImGui::SetCursorScreenPos(low);
  ImGui::InvisibleButton("picture", ImVec2(viewport.width, viewport.height),
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                             ImGuiButtonFlags_MouseButtonMiddle);
  marks.put("viewport");
  const bool hovered = session.viewing.hovered = ImGui::IsItemHovered();
  moveEye(session, viewport, hovered);
  const auto clicked = over_split ? std::nullopt : manipulate(session, marks, viewport, hovered);
  if (clicked) pick(session, renderer, scale * *clicked);
  drawLegends(session, marks, low, high);
  drawViewMenu(session, marks);
  ImGui::SetCursorScreenPos(low);
  drawStartPage(session, marks);
}

}  // namespace lambent::editor
