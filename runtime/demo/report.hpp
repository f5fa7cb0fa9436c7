// What --json prints: the words of the run, passes of the first and the last frame (times in milliseconds,
// what each issued), what was loaded, bytes resident, negative pixels, the device.
#pragma once

#include <string>
#include <vector>

#include "runtime/demo/options.hpp"
#include "runtime/frame/world.hpp"
#include "runtime/gpu/context.hpp"
#include "runtime/gpu/pass_timers.hpp"

namespace lambent::demo {

struct Report {
  std::vector<gpu::PassTime> first_frame, last_frame;
  double load_ms = 0.0;  // from opening the bundles until everything was resident
  std::uint64_t bytes_resident = 0;
  frame::LoadedParts parts;
  std::uint32_t negative_pixels = 0;
  float exposure_ev = 0.0f;
  std::uint64_t gl_errors = 0;
};

std::string reportJson(const Options& options, const gpu::DeviceInfo& device, const Report& report);

}  // namespace lambent::demo
