// Holds the handles in the picture by which a pointer moves, turns and scales what is selected, shapes
// lights, and drags suns over the sky. This is state between frames; editor/panels/manipulate.cpp drives
// them.
#pragma once

#include <optional>

#include "editor/gizmo/gizmo.hpp"
#include "editor/gizmo/light_gizmo.hpp"
#include "editor/gizmo/sun_gizmo.hpp"
#include "editor/session/suns.hpp"

namespace lambent::editor {

struct Handles {
  bool shown = true;
  Gizmo gizmo;
  LightGizmo light_gizmo;
  SunGizmo sun_gizmo;
  std::optional<SunOnSky> sun_taken;  // as it stood when its drag began
};

}  // namespace lambent::editor
