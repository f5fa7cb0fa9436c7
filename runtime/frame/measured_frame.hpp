// A picture at rest and what its passes take. Comes in: the world as it is resident, the environment, the
// view, settings. Goes out: the linear picture, and how long each pass takes when all of it has to run, the
// median of a few times. Draws with a frame of its own that starts anew: the same settings always give the
// same picture. The world stays as it is; other frames shade it anew in their next step, to the same result.
// Render thread; waits for the GPU. Errors: those of a frame.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/frame/frame_settings.hpp"
#include "runtime/gpu/pass_timers.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/image.hpp"
#include "runtime/spec/size.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

struct MeasureOptions {
  spec::Size size{320, 180};  // of the picture: the view's aspect
  std::uint32_t repeats = 5;  // of which times are the median; 0: no times
};

// What is drawn: the world as it is resident, under this light, from this place.
struct MeasuredScene {
  World& world;
  const lighting::Environment& environment;
  const spec::View& view;
};

struct FrameCost {
  double cpu_ms = 0.0, gpu_ms = 0.0;    // of all passes
  std::vector<gpu::PassTime> passes{};  // medians, in the order of the frame

  // The GPU's time, or the CPU's where the device tells none; of one pass, 0 where it did not run.
  double milliseconds() const { return gpu_ms > 0.0 ? gpu_ms : cpu_ms; }
  double milliseconds(std::string_view pass) const;
};

struct MeasuredFrame {
  spec::RgbaImage picture;
  FrameCost cost;
};

Result<MeasuredFrame> measureFrame(const MeasuredScene& scene, const FrameSettings& settings,
                                   const MeasureOptions& options = {});

// sqrt( sum (X-A)² / sum A² ) over pixels that both cover. Errors: nothing is lit; the sizes differ.
Result<double> relativeRms(const spec::RgbaImage& picture, const spec::RgbaImage& reference);

}  // namespace lambent::frame
