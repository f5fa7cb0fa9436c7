// Holds what is known about the last picture: statistics of its frame, the time it took, and what can only be
// read once the GPU has finished. The renderer writes it; commands and panels read it. Before the first
// picture everything is zero.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/frame/frame.hpp"
#include "runtime/world/frame_times.hpp"

namespace lambent::editor {

struct PictureFacts {
  frame::StepCounts counts;
  frame::ViewLegend legend;
  std::vector<gpu::PassTime> passes;  // of the newest frame whose times are all known
  std::uint64_t volume_bytes = 0;     // GPU memory that the frame keeps for volumes
  frame::FrameTimes times;            // from the first command to the last
  std::uint64_t drawn = 0;            // how many pictures there were
  bool settled = false;               // everything is loaded, and the light did not change in the last frame
  bool in_flight = false;             // the GPU still works on the last picture
  bool preview_waits = false;         // the inset of the selected camera is to be drawn anew
  // These belong to the last picture that the GPU has finished.
  std::uint32_t negative_pixels = 0;
  float exposure_ev = 0.0f;
};

}  // namespace lambent::editor
