// What a frame is made with: the picture's size and kind, settings, upload budget, and what it shows besides
// light.
#pragma once

#include <cstdint>

#include "runtime/debug/overlay_options.hpp"
#include "runtime/frame/frame_settings.hpp"
#include "runtime/spec/size.hpp"
#include "runtime/surface/views.hpp"

namespace lambent::frame {

enum class Output {
  Linear,  // float RGBA, one ray per pixel centre, textures at full resolution: pictures for comparison
  Display  // tone-mapped, sRGB-coded, four samples per pixel
};

struct FrameOptions {
  spec::Size size;
  Output output = Output::Display;
  bool to_window = false;  // draw into framebuffer 0
  FrameSettings settings{};
  std::uint64_t upload_budget_bytes = std::uint64_t{16} << 20;  // per frame, at most
  // Less than that where frames would take longer than usual.
  bool pace_uploads = true;
  // Captures arrive in the very next frame, however long that takes: the same pictures on every run.
  bool wait_for_captures = false;
  ViewChoice view{};
  OverlayOptions overlays{};

  bool linear() const { return output == Output::Linear; }
  // Whether direct light of key lights comes by shadow maps; unshadowed light has no use for them.
  bool keysApart() const { return settings.transfer != evaluate::TransferMode::Unshadowed; }
};

}  // namespace lambent::frame
