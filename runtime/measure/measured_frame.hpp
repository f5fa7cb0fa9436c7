// Draws a picture at rest and measures its passes. It takes the world as it is resident, the environment, the
// view and settings. It returns the linear picture, and for each pass the median time of several runs in
// which everything is computed. It uses a frame of its own that starts anew, so the same settings always give
// the same picture. The world does not change, but other frames shade it anew in their next step, with the
// same result. Render thread; waits for the GPU. Fails as frames do.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/frame/frame_settings.hpp"
#include "runtime/gpu/pass_timers.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/image.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

struct MeasureOptions {
  spec::Size size{320, 180};  // size of the picture; gives the view's aspect
  std::uint32_t repeats = 5;  // number of runs for the medians; 0: no times
};

// Describes what is drawn: the resident part of the world, under this light, in this view.
struct MeasuredScene {
  World& world;
  lighting::Environment& environment;
  const spec::View& view;
};

struct FrameCost {
  double cpu_ms = 0.0, gpu_ms = 0.0;    // of all passes
  std::vector<gpu::PassTime> passes{};  // medians, in the order of the frame

  // Return the GPU's time, or the CPU's if the device reports none: of all passes, or of one (0 if it did not
  // run).
  double milliseconds() const { return gpu_ms > 0.0 ? gpu_ms : cpu_ms; }
  double milliseconds(std::string_view pass) const;
};

struct MeasuredFrame {
  spec::RgbaImage picture;
  FrameCost cost;
};

Result<MeasuredFrame> measureFrame(const MeasuredScene& scene, const FrameSettings& settings,
                                   const MeasureOptions& options = {});

// Returns sqrt(sum (X-A)² / sum A²) over the pixels that both pictures cover. Fails if nothing is lit or the
// sizes differ.
Result<double> relativeRms(const spec::RgbaImage& picture, const spec::RgbaImage& reference);

// Measures what a setting of FrameSettings costs and loses in a view. It takes the world as it is resident,
// the environment, the view, settings, a row of their table and values for it. For each value it returns how
// much the picture at rest differs from that at the row's finest value (relative RMS of linear radiance over
// the pixels that both cover, as in baker/accuracy/compare.hpp), and the median time of each pass when
// everything is computed. If the setting is the number of key lights, the light is
// divided anew for each value. Render thread; waits for the GPU. Fails as frames do, if a value is out of its
// range, or if nothing is lit in the view.
struct SettingPoint : FrameCost {
  double value = 0.0;
  double error = 0.0;  // relative to the finest value, which has 0
};

struct SettingCost {
  SettingPoint now, finest;
};

// Measures the value in `settings` and the finest one. Fails if the row has no finest value.
Result<SettingCost> measureSetting(const MeasuredScene& scene, const FrameSettings& settings,
                                   const SettingRow& row, const MeasureOptions& options = {});
// Returns a point for each value, in the order of the values.
Result<std::vector<SettingPoint>> sweepSetting(const MeasuredScene& scene, const FrameSettings& settings,
                                               const SettingRow& row, std::span<const double> values,
                                               const MeasureOptions& options = {});

}  // namespace lambent::frame
