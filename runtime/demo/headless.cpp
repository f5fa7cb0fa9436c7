#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "runtime/demo/camera.hpp"
#include "runtime/demo/report.hpp"
#include "runtime/demo/stage.hpp"
#include "runtime/effects/volume/volume.hpp"
#include "runtime/frame/frame.hpp"
#include "runtime/shadows/key_shadows.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::demo {

namespace {

// Names the pictures of a sequence: a run of # in the file name stands for the frame's number with as many
// digits.

bool isNumbered(const std::filesystem::path& path) {
  return path.filename().string().find('#') != std::string::npos;
}

// Returns, for "frame-###.png" and 7, "frame-007.png". Only the first run counts; a path without one is
// unchanged.
std::filesystem::path numberedPath(const std::filesystem::path& path, std::uint32_t number) {
  std::string name = path.filename().string();
  const std::size_t first = name.find('#');
  if (first == std::string::npos) return path;
  const std::size_t end = std::min(name.find_first_not_of('#', first), name.size());
  name.replace(first, end - first, fmt::format("{:0{}}", number, end - first));
  return path.parent_path() / name;
}

}  // namespace

namespace {

using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// Returns what all threads of this program have worked.
double processorMilliseconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

Result<void> writePicture(const frame::Frame& frame, const Options& options, std::uint32_t number) {
  const std::filesystem::path path = numberedPath(*options.headless, number);
  const auto write = [&](const auto& picture, const auto& writer) {
    const Result<void> kept = gpu::checkContext();  // what is read from a lost one is no picture
    return kept ? writer(path, picture) : kept;
  };
  const Result<void> written =
      options.linear ? write(frame.readLinear(), spec::writeExr) : write(frame.readDisplay(), spec::writePng);
  if (written && !options.json) fmt::print("{}\n", path.string());
  return written;
}

// Reports a picture that the device cannot hold before anything is loaded.
Result<void> checkSize(const spec::Size& size, std::uint32_t limit) {
  if (size.width > limit || size.height > limit)
    return fail("--size", fmt::format("this device draws at most {} pixels a side", limit),
                "ask for a smaller picture");
  return {};
}

}  // namespace

Result<void> runHeadless(const Options& options) {
  Result<lighting::Environment> environment = loadEnvironment(options);
  if (!environment) return failAgain(environment.error());
  Result<gpu::Context> context = gpu::Context::createHeadless();
  if (!context) return failAgain(context.error());
  if (Result<void> fits = checkSize(options.size, context->info().max_texture_side); !fits) return fits;

  const auto start = Clock::now();
  Report report;
  Result<Stage> stage = Stage::create(options, std::move(*environment));
  if (!stage) return failAgain(stage.error());
  frame::World& world = stage->world();
  const Result<ViewController> controller =
      ViewController::create(world, options.camera, options.size.aspect());
  if (!controller) return failAgain(controller.error());
  const Result<spec::View> first_view = controller->view(world, options.size.aspect());
  if (!first_view) return failAgain(first_view.error());
  world.look(*first_view);
  gpu::Counters loading;
  if (Result<void> loaded = world.uploadAll(loading); !loaded) return loaded;
  report.load_ms = millisecondsSince(start);

  Result<frame::Frame> frame =
      frame::Frame::create({.size = options.size,
                            .output = options.linear ? frame::Output::Linear : frame::Output::Display,
                            .settings = options.settings,
                            .wait_for_captures = true,
                            .view = options.view,
                            .overlays = options.overlays},
                           stage->environment());
  if (!frame) return failAgain(frame.error());
  const auto render = [&]() -> Result<void> {
    world.updateTransforms();  // cameras may be attached to what moves
    const Result<spec::View> view = controller->view(world, options.size.aspect());
    if (!view) return failAgain(view.error());
    return frame->render(world, stage->environment(), *view);
  };
  // A picture shows the light after it has come to rest.
  const auto finishPicture = [&](std::uint32_t number) -> Result<void> {
    const Result<std::uint32_t> steps = frame->rest(world, stage->environment());
    if (!steps) return failAgain(steps.error());
    report.rest_steps = *steps;
    if (*steps > 0)
      if (Result<void> rendered = render(); !rendered) return rendered;
    return writePicture(*frame, options, number);
  };
  const bool every_frame = isNumbered(*options.headless);
  for (std::uint32_t i = 0; i < options.frames; ++i) {
    // Over several frames the light turns to its place and time runs to the requested value, so that the cost
    // of movement can be measured.
    stage->turnLight(options.rotate_light_deg * static_cast<float>(i + 1) /
                     static_cast<float>(options.frames));
    if (options.time_s)
      world.setAnimationTime(
          std::max(0.0f, *options.time_s - options.step_s * static_cast<float>(options.frames - 1 - i)));
    const auto frame_start = Clock::now();
    const double processor_start = processorMilliseconds();
    if (Result<void> rendered = render(); !rendered) return rendered;
    glFinish();
    report.frame_ms.push_back(millisecondsSince(frame_start));
    report.processor_ms.push_back(processorMilliseconds() - processor_start);
    if (i == 0) {
      frame->timers().finish();
      report.first_frame = {frame->timers().latest(), frame->counts()};
    }
    if (i + 1 == options.frames) {
      frame->timers().finish();
      report.last_frame = {frame->timers().latest(), frame->counts()};
    }
    if (every_frame || i + 1 == options.frames)
      if (Result<void> finished = finishPicture(i); !finished) return finished;
  }
  if (!options.json) return {};
  report.parts = world.loadedParts();
  report.streaming = world.streaming();
  report.bytes_resident =
      report.streaming.resident_bytes + frame->kept<effects::volume::Volume>().textureBytes();
  report.negative_pixels = frame->negativePixels();
  report.exposure_ev = frame->exposureEv();
  report.gl_errors = context->errors();
  const std::span<const spec::Disc> keys = stage->environment().keys();
  report.keys.assign(keys.begin(), keys.end());
  report.key_shadow_bytes = frame->kept<frame::KeyShadows>().bytesResident();
  fmt::print("{}\n", reportJson(options, context->info(), report));
  return {};
}

}  // namespace lambent::demo
