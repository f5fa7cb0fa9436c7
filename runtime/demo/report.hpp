// Makes the output of --json: the arguments of the run, the passes of the first and the last frame (times in
// milliseconds, what each issued, what was captured and shaded), frame times, what was loaded, bytes
// resident, negative pixels, and the device.
#pragma once

#include <string>
#include <vector>

#include "runtime/demo/options.hpp"
#include "runtime/frame/frame.hpp"
#include "runtime/gpu/context.hpp"
#include "runtime/gpu/pass_timers.hpp"
#include "runtime/world/world.hpp"

namespace lambent::demo {

struct FrameReport {
  std::vector<gpu::PassTime> passes;
  frame::StepCounts counts;
};

struct Report {
  FrameReport first_frame, last_frame;
  std::vector<double> frame_ms;      // per frame, until the GPU was done
  std::vector<double> processor_ms;  // per frame, of all threads; where the processor draws, its cost
  std::uint32_t rest_steps = 0;      // steps after the last frame until no light changed any more
  double load_ms = 0.0;              // from opening the bundles until everything was resident
  std::uint64_t bytes_resident = 0;
  frame::LoadedParts parts;
  frame::StreamingStatus streaming;
  std::uint32_t negative_pixels = 0;
  float exposure_ev = 0.0f;
  std::uint64_t gl_errors = 0;
  std::vector<spec::Disc> keys;  // of the last frame, in world axes
  std::uint64_t key_shadow_bytes = 0;
};

std::string reportJson(const Options& options, const gpu::DeviceInfo& device, const Report& report);

}  // namespace lambent::demo
