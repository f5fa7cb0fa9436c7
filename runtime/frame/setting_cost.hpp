// What a setting of FrameSettings costs and loses in a view. Comes in: the world as it is resident, the
// environment, the view, settings, a row of the table and values for it. Goes out: per value how far its
// picture at rest lies from that at the row's finest value (relative RMS of linear radiance over the pixels
// that both cover: the figure of baker/accuracy/compare.hpp) and how long each pass takes when all of it has
// to run, the median of a few times (measured_frame.hpp). Where the setting is the number of key lights, the
// light is parted anew for each value. Render thread; waits for the GPU. Errors: those of a frame; a value
// out of its range; a view in which nothing is lit.
#pragma once

#include <span>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/frame/frame_settings.hpp"
#include "runtime/frame/measured_frame.hpp"
#include "runtime/gpu/pass_timers.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

using SettingOptions = MeasureOptions;

struct SettingPoint {
  double value = 0.0;
  double error = 0.0;                   // against the finest value: 0 there
  double cpu_ms = 0.0, gpu_ms = 0.0;    // of all passes
  std::vector<gpu::PassTime> passes{};  // medians, in the order of the frame
};

struct SettingCost {
  SettingPoint now, finest;
};

// Of the value that `settings` has. A row without a finest value is an error.
Result<SettingCost> measureSetting(const MeasuredScene& scene, const FrameSettings& settings,
                                   const SettingRow& row, const SettingOptions& options = {});
// In the order of the values.
Result<std::vector<SettingPoint>> sweepSetting(const MeasuredScene& scene, const FrameSettings& settings,
                                               const SettingRow& row, std::span<const double> values,
                                               const SettingOptions& options = {});

}  // namespace lambent::frame
