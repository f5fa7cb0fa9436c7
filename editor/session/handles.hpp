// Holds the state of the gizmos between frames: the handles that move, turn and scale the selection, shape
// lights, and drag suns. editor/panels/manipulate.cpp drives them.
#pragma once

#include <optional>

#include "editor/gizmo/gizmo.hpp"
#include "editor/gizmo/light_gizmo.hpp"
#include "editor/gizmo/projection.hpp"
#include "editor/gizmo/sun_gizmo.hpp"
#include "editor/session/suns.hpp"

namespace lambent::editor {

struct Handles {
  bool shown = true;
  Gizmo gizmo;
  LightGizmo light_gizmo;
  SunGizmo sun_gizmo;
  FinePointer pointer;
  std::optional<SunOnSky> sun_taken;  // the sun as it was when its drag began
};

}  // namespace lambent::editor
