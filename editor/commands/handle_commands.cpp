// Implements the commands for the handles in the view: what they do, along which axes, about which point, and
// in which steps.
#include <algorithm>
#include <array>

#include "editor/commands/rows.hpp"
#include "runtime/spec/numbers.hpp"

namespace lambent::editor {

namespace {

GizmoOptions& options(Session& session) {
  return session.handles.gizmo.options;
}

template <GizmoMode Mode>
Answer mode(Session& session, Words) {
  options(session).mode = Mode;
  session.handles.shown = true;
  return nullptr;
}
template <GizmoMode Mode>
bool isMode(const Session& session) {
  return session.handles.shown && session.handles.gizmo.options.mode == Mode;
}

Answer space(Session& session, Words) {
  GizmoSpace& now = options(session).space;
  now = now == GizmoSpace::World ? GizmoSpace::Local : GizmoSpace::World;
  return nullptr;
}
bool isLocal(const Session& session) {
  return session.handles.gizmo.options.space == GizmoSpace::Local;
}

// Takes a pivot by its name, or the next one.
Answer pivot(Session& session, Words words) {
  const auto now = static_cast<std::size_t>(options(session).pivot);
  std::size_t to = (now + 1) % kPivots.size();
  if (!words.empty()) {
    const auto found = std::find(kPivots.begin(), kPivots.end(), words[0]);
    if (found == kPivots.end())
      return fail("pivot", "\"" + words[0] + "\" is not known", "give primary, center or each");
    to = static_cast<std::size_t>(found - kPivots.begin());
  }
  options(session).pivot = static_cast<GizmoPivot>(to);
  return kPivots[to];
}

Answer gizmos(Session& session, Words) {
  session.handles.shown = !session.handles.shown;
  return nullptr;
}
bool gizmosShown(const Session& session) {
  return session.handles.shown;
}

// Switches snapping, or switches it on with these steps; 0 metres switch it off.
Answer snap(Session& session, Words words) {
  GizmoOptions& now = options(session);
  if (words.empty()) {
    now.snap = !now.snap;
    return now.snap;
  }
  const std::array steps = {&now.snap_m, &now.snap_deg, &now.snap_scale};
  std::vector<float> given;
  for (const std::string& word : words) {
    const auto step = spec::parseNumber(word);
    const bool off = given.empty() && words.size() == 1 && step && *step == 0.0f;
    if (!step || (!off && !(*step > 0.0f)))
      return fail("snap", word + " is not a step",
                  "give metres, degrees and a factor above 0, or 0 for none");
    given.push_back(*step);
  }
  now.snap = given[0] > 0.0f;
  if (now.snap)
    for (std::size_t i = 0; i < given.size(); ++i) *steps[i] = given[i];
  return now.snap;
}
bool snaps(const Session& session) {
  return session.handles.gizmo.options.snap;
}

constexpr std::array kHandleRows = {
    separator("View"),
    toggle(&isMode<GizmoMode::Move>,
           item("View", "move", "Move", "W", "Handles that move what is selected", &mode<GizmoMode::Move>)),
    toggle(&isMode<GizmoMode::Rotate>,
           item("View", "turn", "Turn", "E", "Handles that turn what is selected", &mode<GizmoMode::Rotate>)),
    toggle(&isMode<GizmoMode::Scale>, item("View", "scale", "Scale", "R",
                                           "Handles that scale what is selected", &mode<GizmoMode::Scale>)),
    toggle(&isLocal, item("View", "local-axes", "Local axes", "X",
                          "Handles along the axes of what is selected, not of the world", &space)),
    withWords(
        "[primary|center|each]", 0, 1,
        item("View", "pivot", "Next pivot", "Z",
             "Turn and scale about the last selected, the middle of all, or each about itself", &pivot)),
    withWords("[METRES [DEGREES [FACTOR]]]", 0, 3,
              toggle(&snaps, item("View", "snap", "Snap", "Y",
                                  "Drags go in steps; Ctrl does so for one drag, or frees it", &snap))),
    toggle(&gizmosShown, item("View", "gizmos", "Handles", "G", "Show handles at all", &gizmos)),
};

}  // namespace

std::span<const Command> handleCommands() {
  return kHandleRows;
}

}  // namespace lambent::editor
