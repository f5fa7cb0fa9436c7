// Measures what a setting of FrameSettings costs and loses in a view. It takes the world as it is resident,
// the environment, the view, settings and a row of their table. For the present value and the row's finest
// one it returns the median time of each pass of several runs in which everything is computed, and how much
// the linear picture at rest differs from the finest (relative RMS of radiance over the pixels that both
// cover, as in baker/accuracy/compare.hpp). If the setting is the number of key lights, the light is divided
// anew. It uses frames of its own that start anew, so the same settings always give the same picture. The
// world does not change, but other frames shade it anew in their next step, with the same result. Render
// thread; waits for the GPU. Fails as frames do, or if nothing is lit in the view.
#pragma once

#include <cstdint>
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

struct SettingPoint {
  double value = 0.0;
  double error = 0.0;                   // relative to the finest value, which has 0
  double cpu_ms = 0.0, gpu_ms = 0.0;    // of all passes
  std::vector<gpu::PassTime> passes{};  // medians, in the order of the frame
};

struct SettingCost {
  SettingPoint now, finest;
};

// Returns sqrt(sum (X-A)² / sum A²) over the pixels that both pictures cover. Fails if nothing is lit or the
// sizes differ.
Result<double> relativeRms(const spec::RgbaImage& picture, const spec::RgbaImage& reference);

// Measures the value in `settings` and the finest one. Fails if the row has no finest value.
Result<SettingCost> measureSetting(const MeasuredScene& scene, const FrameSettings& settings,
                                   const SettingRow& row, const MeasureOptions& options = {});

}  // namespace lambent::frame
