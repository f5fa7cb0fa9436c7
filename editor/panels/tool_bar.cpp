// Draws the bar above the view: what the handles do, along which axes, about which point and in which steps.
// What does not fit is left out; the View menu has it.
#include <array>

#include <fmt/format.h>
#include <imgui.h>
#include <nlohmann/json.hpp>

#include "editor/commands/command.hpp"
#include "editor/panels/number_field.hpp"
#include "editor/panels/panel.hpp"
#include "editor/ui/fitting.hpp"

namespace lambent::editor {

namespace {

constexpr float kStepEms = 4.0f;

float buttonWidth(const char* text) {
  return ImGui::CalcTextSize(text).x + 2.0f * ImGui::GetStyle().FramePadding.x;
}

// Draws a button that runs a command, lit while its switch is on.
void drawCommand(Session& session, Marks& marks, const char* id, const char* text,
                 std::string_view more = {}) {
  const Command* command = findCommand(id);
  const bool on = command->checked && command->checked(session);
  if (on) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyle().Colors[ImGuiCol_ButtonActive]);
  if (ImGui::Button(text)) runOrLog(session, id, {});
  if (on) ImGui::PopStyleColor();
  marks.put(std::string("tool.") + id);
  tooltip(fmt::format("{} ({})\n{}{}", command->title, command->shortcut, command->help, more));
}

void drawStep(Session& session, Marks& marks, const char* name, float& step, const char* format,
              double most) {
  ImGui::SetNextItemWidth(em(kStepEms));
  const std::string id = fmt::format("##{}", name);
  dragNumber(id.c_str(), step,
             {.speed = 0.005 * double{step}, .least = 0.001, .most = most, .format = format, .step = 0.05},
             session.field_edit.number);
  marks.put(fmt::format("tool.snap.{}", name));
  tooltip(fmt::format("Step of a drag that snaps\n{}", kNumberHelp));
}

}  // namespace

void drawToolBar(Session& session, Marks& marks) {
  GizmoOptions& options = session.handles.gizmo.options;
  const ImGuiStyle& style = ImGui::GetStyle();
  ImGui::SetCursorPos(ImVec2(style.ItemSpacing.x, style.ItemSpacing.y));
  ImGui::BeginGroup();
  drawCommand(session, marks, "move", "Move");
  if (sameLineIfFits("Turn")) drawCommand(session, marks, "turn", "Turn");
  if (sameLineIfFits("Scale")) drawCommand(session, marks, "scale", "Scale");
  const char* axes = options.space == GizmoSpace::Local ? "Local" : "World";
  if (sameLineIfFits(em(1.0f) + buttonWidth(axes))) {
    ImGui::SameLine(0.0f, em(1.0f));
    drawCommand(session, marks, "local-axes", axes);
  }
  constexpr std::array kPivots = {"About last", "About middle", "About each"};
  const char* pivot = kPivots[static_cast<std::size_t>(options.pivot)];
  if (sameLineIfFits(pivot)) drawCommand(session, marks, "pivot", pivot);
  if (sameLineIfFits(em(1.0f) + buttonWidth("Snap"))) {
    ImGui::SameLine(0.0f, em(1.0f));
    drawCommand(session, marks, "snap", "Snap");
  }
  if (sameLineIfFits(em(kStepEms))) drawStep(session, marks, "metres", options.snap_m, "%.3g m", 1e3);
  if (sameLineIfFits(em(kStepEms))) drawStep(session, marks, "degrees", options.snap_deg, "%.3g°", 180.0);
  if (sameLineIfFits(em(kStepEms))) drawStep(session, marks, "factor", options.snap_scale, "× %.3g", 10.0);
  ImGui::EndGroup();
}

}  // namespace lambent::editor
