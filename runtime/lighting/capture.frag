// Which surface a subsample sees.
#include "capture_shared.h"

layout(location = 0) flat in uint surface_id;
layout(location = 0) out uint id;

void main() {
  id = gl_FrontFacing ? surface_id : kBlackId;
}
