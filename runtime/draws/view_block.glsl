// Declares the camera (ViewBlock of surface_record.hpp).
#include "surface_shared.h"

layout(std140, binding = kBindView) uniform ViewBlock {
  mat4 view_from_world;
  mat4 clip_from_view;
  vec4 eye;  // world; if w is 0, the direction towards the eye of an orthographic camera
};
