// Holds what is known of the last picture of the world: what its frame did, how long pictures take, and what
// can only be read once the GPU has finished. The renderer writes it, commands and panels read it; before the
// first picture all is zero.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/frame/frame.hpp"
#include "runtime/frame/frame_times.hpp"

namespace lambent::editor {

struct PictureFacts {
  frame::StepCounts counts;
  frame::ViewLegend legend;
  std::vector<gpu::PassTime> passes;  // of the newest frame whose times are all known
  std::uint64_t volume_bytes = 0;     // of GPU memory that the frame keeps for volumes
  frame::FrameTimes times;            // of pictures, from the first command to the last
  bool settled = false;               // all is loaded, and light did not change in the last frame
  bool in_flight = false;             // the GPU still works on the last picture
  // Of the last picture that the GPU has finished.
  std::uint32_t negative_pixels = 0;
  float exposure_ev = 0.0f;
};

}  // namespace lambent::editor
