// Holds whether the world's animations are playing, and their time.
#pragma once

namespace lambent::editor {

struct Playback {
  bool playing = false;
  float time_s = 0.0f;
};

}  // namespace lambent::editor
