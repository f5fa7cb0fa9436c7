// Describes how a frame is made: the picture's size and kind, settings, upload budget, and what it shows
// besides light.
#pragma once

#include <cstdint>

#include "runtime/debug/overlay_options.hpp"
#include "runtime/frame/frame_settings.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/surface/views.hpp"

namespace lambent::frame {

enum class Output {
  Linear,  // for comparisons: float RGBA, one ray per pixel centre, textures at full resolution
  Display  // tone-mapped, sRGB-coded, four samples per pixel
};

// Tells where pictures go.
enum class Destination {
  Picture,  // the frame's own target, which can be read back
  Window,   // framebuffer 0
  Shared    // linear radiance into textures of another program's code (Frame::share), on top of what is there
};

struct FrameOptions {
  spec::Size size;
  Output output = Output::Display;
  Destination destination = Destination::Picture;
  bool show_sky = true;  // false: nothing is drawn where no surface is
  FrameSettings settings{};
  std::uint64_t upload_budget_bytes = std::uint64_t{16} << 20;  // most bytes per frame
  // If true, less is uploaded when frames take longer than usual.
  bool pace_uploads = true;
  // If true, captures arrive in the next frame, however long that takes, so that every run gives the same
  // pictures.
  bool wait_for_captures = false;
  ViewChoice view{};
  OverlayOptions overlays{};

  bool linear() const { return output == Output::Linear; }
  // Returns whether direct light of key lights comes by shadow maps. Unshadowed light does not need them.
  bool keysApart() const { return settings.transfer != evaluate::TransferMode::Unshadowed; }
};

}  // namespace lambent::frame
