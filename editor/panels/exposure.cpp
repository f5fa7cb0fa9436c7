// Draws the exposure: automatic, or a slider in stops. The environment's panel has it, and lights have it
// beside their strength.
#include <imgui.h>

#include "editor/panels/panel.hpp"
#include "editor/ui/fitting.hpp"

namespace lambent::editor {

void drawExposure(Session& session, Marks& marks, const std::string& mark) {
  const std::optional<float> exposure = session.document.world().exposure_ev;
  bool automatic = !exposure.has_value();
  if (ImGui::Checkbox("auto", &automatic))
    session.history.editWorld("exposure", [&](WorldState& world) {
      world.exposure_ev = automatic ? std::nullopt : std::optional(session.picture.exposure_ev);
    });
  marks.put(mark + ".automatic");
  tooltip("Meters the exposure from the picture, so a brighter lamp may not look brighter");
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1.0f);
  float ev = exposure.value_or(session.picture.exposure_ev);
  // A drag of the slider takes the exposure from the meter.
  const bool changed = ImGui::SliderFloat("##exposure", &ev, -12.0f, 12.0f, "%.2f EV");
  if (ImGui::IsItemActivated()) session.history.beginDrag("exposure");
  if (changed) session.history.editWorld("exposure", [&](WorldState& world) { world.exposure_ev = ev; });
  if (ImGui::IsItemDeactivated()) session.history.endDrag();
  marks.put(mark + ".exposure");
  tooltip("Stops by which the picture is brightened; at 0, radiance 1 is white");
}

}  // namespace lambent::editor
