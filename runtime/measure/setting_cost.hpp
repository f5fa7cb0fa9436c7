// Measures what a setting of FrameSettings costs and loses in a view. It takes the world as it is resident,
// the environment, the view, settings, a row of their table and values for it. For each value it returns how
// much the picture at rest differs from that at the row's finest value (relative RMS of linear radiance over
// the pixels that both cover, as in baker/accuracy/compare.hpp), and the median time of each pass when
// everything is computed (measured_frame.hpp). If the setting is the number of key lights, the light is
// divided anew for each value. Render thread; waits for the GPU. Fails as frames do, if a value is out of its
// range, or if nothing is lit in the view.
#pragma once

#include <span>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/frame/frame_settings.hpp"
#include "runtime/gpu/pass_timers.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/measure/measured_frame.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

using SettingOptions = MeasureOptions;

struct SettingPoint {
  double value = 0.0;
  double error = 0.0;                   // relative to the finest value, which has 0
  double cpu_ms = 0.0, gpu_ms = 0.0;    // of all passes
  std::vector<gpu::PassTime> passes{};  // medians, in the order of the frame
};

struct SettingCost {
  SettingPoint now, finest;
};

// Measures the value in `settings` and the finest one. Fails if the row has no finest value.
Result<SettingCost> measureSetting(const MeasuredScene& scene, const FrameSettings& settings,
                                   const SettingRow& row, const SettingOptions& options = {});
// Returns a point for each value, in the order of the values.
Result<std::vector<SettingPoint>> sweepSetting(const MeasuredScene& scene, const FrameSettings& settings,
                                               const SettingRow& row, std::span<const double> values,
                                               const SettingOptions& options = {});

}  // namespace lambent::frame
