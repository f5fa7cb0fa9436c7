// One frame, from what has arrived to the picture: stream, transforms, light, shade, raster, tone map. Every
// pass runs only if something that it reads is newer than its last output; each is timed and counts what it
// issued. The picture goes to the frame's own target, which can be read back, or to the window's framebuffer.
// Errors: shaders that do not compile, a bundle that turns out damaged while it loads.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/effects/diffuse/diffuse.hpp"
#include "runtime/frame/surfaces.hpp"
#include "runtime/frame/tone_mapper.hpp"
#include "runtime/frame/world.hpp"
#include "runtime/gpu/pass_timers.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/lighting/sky.hpp"
#include "runtime/sh/window.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/image.hpp"
#include "runtime/spec/size.hpp"

namespace lambent::frame {

enum class Output {
  Linear,  // float RGBA, one ray per pixel centre, textures at full resolution: pictures for comparison
  Display  // tone-mapped, sRGB-coded, four samples per pixel
};

struct FrameOptions {
  spec::Size size;
  Output output = Output::Display;
  bool to_window = false;  // draw into framebuffer 0
  effects::diffuse::TransferMode transfer = effects::diffuse::TransferMode::Full;
  sh::Window window = sh::Window::Auto;
  std::optional<float> exposure_ev;                             // none: automatic
  std::uint64_t upload_budget_bytes = std::uint64_t{16} << 20;  // per frame
};

class Frame {
 public:
  static Result<Frame> create(const FrameOptions& options, const lighting::Environment& environment);

  Result<void> render(World& world, const lighting::Environment& environment, const spec::View& view);
  void resize(const spec::Size& size);

  // Waits for the GPU. Row 0 is the top.
  spec::RgbaImage readLinear() const;
  spec::Rgba8Image readDisplay() const;

  std::uint32_t negativePixels() const { return tone_mapper_.negativePixels(); }
  float exposureEv() const { return tone_mapper_.exposureEv(); }
  gpu::PassTimers& timers() { return timers_; }
  const FrameOptions& options() const { return options_; }

 private:
  Frame(const FrameOptions& options, lighting::Sky sky, Surfaces surfaces, ToneMapper tone_mapper);

  Result<void> upload(World& world);
  void transforms(World& world);
  void light(const World& world, const lighting::Environment& environment);
  Result<void> shade(World& world);
  void raster(World& world, const lighting::Environment& environment, const spec::View& view);
  void toneMap();

  FrameOptions options_;
  lighting::Sky sky_;
  Surfaces surfaces_;
  ToneMapper tone_mapper_;
  effects::diffuse::Diffuse diffuse_;
  lighting::GroupLights group_lights_;
  gpu::PassTimers timers_;
  gpu::Texture hdr_, depth_, picture_;
  gpu::Framebuffer hdr_target_, picture_target_;
};

}  // namespace lambent::frame
