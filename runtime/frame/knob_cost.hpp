// What a knob of FrameSettings costs and loses in a view. Comes in: the world as it is resident, the
// environment, the view, settings, a row of the table and values for it. Goes out: per value how far its
// picture at rest lies from that at the row's finest value (relative RMS of linear radiance over the pixels
// that both cover: the figure of baker/accuracy/compare.hpp) and how long each pass takes when all of it has
// to run, the median of a few times. Draws with frames of its own, small and linear, of which each starts
// anew: a value always gives the same picture. The world stays as it is; other frames shade it anew in their
// next step, to the same result. Render thread; waits for the GPU. Errors: those of a frame; a value out of
// its range; a view in which nothing is lit.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/frame/frame_settings.hpp"
#include "runtime/frame/world.hpp"
#include "runtime/gpu/pass_timers.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/image.hpp"
#include "runtime/spec/size.hpp"

namespace lambent::frame {

struct KnobOptions {
  spec::Size size{320, 180};  // of the pictures: the view's aspect
  std::uint32_t repeats = 5;  // of which times are the median; 0: no times
};

struct KnobPoint {
  double value = 0.0;
  double error = 0.0;                   // against the finest value: 0 there
  double cpu_ms = 0.0, gpu_ms = 0.0;    // of all passes
  std::vector<gpu::PassTime> passes{};  // medians, in the order of the frame
};

struct KnobCost {
  KnobPoint now, finest;
};

// Of the value that `settings` has. A row without a finest value is an error.
Result<KnobCost> measureKnob(World& world, const lighting::Environment& environment, const spec::View& view,
                             const FrameSettings& settings, const SettingRow& row,
                             const KnobOptions& options = {});
// In the order of the values.
Result<std::vector<KnobPoint>> sweepKnob(World& world, const lighting::Environment& environment,
                                         const spec::View& view, const FrameSettings& settings,
                                         const SettingRow& row, std::span<const double> values,
                                         const KnobOptions& options = {});

// sqrt( sum (X-A)² / sum A² ) over pixels that both cover.
Result<double> relativeRms(const spec::RgbaImage& picture, const spec::RgbaImage& reference);

}  // namespace lambent::frame
