// Holds whether the animations of the world run, and how long they have run.
#pragma once

namespace lambent::editor {

struct Playback {
  bool playing = false;
  float time_s = 0.0f;
};

}  // namespace lambent::editor
