#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <imgui.h>

#include "editor/panels/panel.hpp"
#include "editor/panels/widgets.hpp"
#include "editor/ui/dear_imgui.hpp"

namespace lambent::editor {

namespace {

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

void setLight(Session& session, ecs::Entity entity, const scene::LocalLightComponent& to) {
  const FieldEdit edits[] = {{entity, "Light", "strength", to.strength},
                             {entity, "Light", "radius", to.radius_m},
                             {entity, "Light", "range", to.range_m},
                             {entity, "Light", "inner_cone", to.inner_cone_rad},
                             {entity, "Light", "outer_cone", to.outer_cone_rad}};
  logRefusal(session, session.history.setFields(edits));
}

float snapped(float value, float step) {
  return std::round(value / step) * step;
}

// Returns the light with the value that is dragged in steps; one step is the least.
scene::LocalLightComponent snapped(scene::LocalLightComponent light, LightHandle handle,
                                   const GizmoOptions& steps) {
  const auto snap = [](float& value, float step) { value = std::max(snapped(value, step), step); };
  if (handle == LightHandle::Radius) snap(light.radius_m, steps.snap_m);
  if (handle == LightHandle::Range) snap(light.range_m, steps.snap_m);
  if (handle == LightHandle::OuterCone) {
    snap(light.outer_cone_rad, glm::radians(steps.snap_deg));
    light.outer_cone_rad = std::min(light.outer_cone_rad, 0.5f * std::numbers::pi_v<float>);
    light.inner_cone_rad = std::min(light.inner_cone_rad, light.outer_cone_rad);
  }
  return light;
}

// Returns the direction towards a sun with azimuth and elevation in steps.
glm::vec3 snappedSun(const glm::vec3& towards, float step_deg) {
  const SkyDirection at = skyDirection(towards, 0.0f);
  return towardsSun(
      {snapped(at.azimuth_deg, step_deg), std::clamp(snapped(at.elevation_deg, step_deg), -90.0f, 90.0f)},
      0.0f);
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

void markHandles(const Session& session, Marks& marks, const std::vector<SunOnSky>& suns) {
  const auto mark = [&](const std::string& name, const std::optional<glm::vec2>& at) {
    if (at) marks.put(name, {*at - glm::vec2(1.0f), *at + glm::vec2(1.0f)});
  };
  for (const Handle handle : kHandles)
    mark("gizmo." + std::string(handleWord(handle)), session.handles.gizmo.handleScreenPoint(handle));
  for (const LightHandle handle : kLightHandles)
    mark("light." + std::string(lightHandleWord(handle)),
         session.handles.light_gizmo.handleScreenPoint(handle));
  mark("gizmo.pivot", session.handles.gizmo.pivotScreenPoint());
  for (std::size_t sun = 0; sun < session.handles.sun_gizmo.count(); ++sun)
    if (const auto at = session.handles.sun_gizmo.place(sun)) {
      if (sun < suns.size() && suns[sun].key)
        mark(fmt::format("key.{}.handle", *suns[sun].key), at->pixel);
      else
        mark(sun == 0 ? "sun.handle" : fmt::format("sun.handle.{}", sun + 1), at->pixel);
    }
}

void addReadout(const glm::vec2& pixel, const std::string& text) {
  if (!text.empty())
    ImGui::GetWindowDrawList()->AddText(ImVec2(pixel.x + 16.0f, pixel.y + 12.0f), IM_COL32_WHITE,
                                        text.c_str());
}

}  // namespace

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
  LightGizmo& light_gizmo = handles.light_gizmo;
  gizmo.setView(view, viewport);
  light_gizmo.setView(view, viewport);
  gizmo.setTargets(targetsOf(session, entities));
  const ecs::Entity primary = session.selection.primaryEntity(session.document);
  const auto* light = registry.tryGet<scene::LocalLightComponent>(primary);
  const bool light_handles = light && registry.has<scene::Transform>(primary);
  if (light_handles) light_gizmo.setLight(*light, worldFromNode(registry, primary));
  SunGizmo& sun_gizmo = handles.sun_gizmo;
  const std::vector<SunOnSky> suns = sunsOf(session);
  sun_gizmo.setView(view, viewport);
  std::vector<glm::vec3> towards;
  for (const SunOnSky& sun : suns) towards.push_back(sun.towards_ws);
  sun_gizmo.setSuns(std::move(towards));

  std::optional<glm::vec2> clicked;
  const bool eye_moves = io.KeyAlt;
  const auto dragging = [&] { return gizmo.dragging() || light_gizmo.dragging() || sun_gizmo.dragging(); };
  const auto release = [&] { gizmo.release(), light_gizmo.release(), sun_gizmo.release(); };
  if (hovered && !dragging()) {
    gizmo.hover(pixel);
    sun_gizmo.hover(pixel);
    if (light_handles) light_gizmo.hover(pixel);
  }
  if (hovered && ImGui::IsMouseClicked(ImGuiMouseButton_Left) && !eye_moves) {
    handles.pointer.press(pixel);
    if (sun_gizmo.press(pixel)) {
      handles.sun_taken = suns[*sun_gizmo.active()];
      if (handles.sun_taken->key) session.viewing.key_at_hand = handles.sun_taken->key;
      session.history.begin("turn of " + handles.sun_taken->name);
    } else if (light_handles && light_gizmo.press(pixel)) {
      session.history.begin("light of " + session.document.nameOf(primary));
    } else if (gizmo.press(pixel)) {
      session.history.begin(fmt::format("{} of {}",
                                        gizmo.options.mode == GizmoMode::Move     ? "move"
                                        : gizmo.options.mode == GizmoMode::Rotate ? "turn"
                                                                                  : "scale",
                                        session.document.nameOf(primary)));
    }
  }
  if (dragging()) {
    const glm::vec2 at = handles.pointer.moved(pixel, /*fine=*/io.KeyShift);
    const bool snaps = gizmo.options.snap != io.KeyCtrl;
    if (escapePressed()) {
      release();
      session.history.cancel();
    } else if (ImGui::IsMouseDown(ImGuiMouseButton_Left)) {
      if (sun_gizmo.dragging()) {
        // A click without a drag does not move a sun that is at the border.
        const glm::vec3 to = sun_gizmo.drag(at);
        if (io.MouseDragMaxDistanceSqr[0] > 0.0f)
          moveSun(session, *handles.sun_taken, snaps ? snappedSun(to, gizmo.options.snap_deg) : to);
      } else if (light_gizmo.dragging()) {
        const scene::LocalLightComponent to = light_gizmo.drag(at);
        setLight(session, primary, snaps ? snapped(to, light_gizmo.active(), gizmo.options) : to);
      } else {
        setTransforms(session, entities, gizmo.drag(at, /*other_snap=*/io.KeyCtrl));
      }
    } else {
      release();
      session.history.commit();
    }
  } else if (hovered && ImGui::IsMouseReleased(ImGuiMouseButton_Left) && !eye_moves &&
             ImGui::GetIO().MouseDragMaxDistanceSqr[0] <= kClickPixels * kClickPixels) {
    clicked = pixel - glm::vec2(viewport.x, viewport.y);
  }
  paint(gizmo.paint(), viewport);
  if (light_handles) paint(light_gizmo.paint(), viewport);
  paint(sun_gizmo.paint(), viewport);
  addReadout(pixel, gizmo.readout());
  if (const auto sun = sun_gizmo.active()) addReadout(pixel, sunReadout(session, suns[*sun]));
  markHandles(session, marks, suns);
  return clicked;
}

}  // namespace lambent::editor
