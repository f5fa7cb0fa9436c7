#include <chrono>
#include <cstdio>

#include <fmt/format.h>

#include "runtime/demo/camera.hpp"
#include "runtime/demo/report.hpp"
#include "runtime/demo/run.hpp"
#include "runtime/frame/frame.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::demo {

namespace {

Result<void> writePicture(const frame::Frame& frame, const Options& options) {
  if (options.linear) return spec::writeExr(*options.headless, frame.readLinear());
  return spec::writePng(*options.headless, frame.readDisplay());
}

// Errors of a picture that the device cannot hold are told before anything is loaded.
Result<void> checkSize(const spec::Size& size, std::uint32_t limit) {
  if (size.width > limit || size.height > limit)
    return fail("--size", fmt::format("this device draws at most {} pixels a side", limit),
                "ask for a smaller picture");
  return {};
}

}  // namespace

Result<void> runHeadless(const Options& options) {
  // The light first: a wrong file is told before a device is looked for.
  Result<lighting::Environment> environment = lighting::Environment::create(options.lights);
  if (!environment) return failAgain(environment.error());
  for (const std::string& notice : environment->notices()) fmt::print(stderr, "lambent-demo: {}\n", notice);

  Result<gpu::Context> context = gpu::Context::createHeadless();
  if (!context) return failAgain(context.error());
  if (Result<void> fits = checkSize(options.size, context->info().max_texture_side); !fits) return fits;

  const auto start = std::chrono::steady_clock::now();
  Report report;
  frame::World world({.max_resident_bytes = options.max_memory_bytes});
  for (const std::filesystem::path& path : options.bundles)
    if (Result<void> opened = world.open(path); !opened) return opened;
  world.scaleLamps(options.lamps);
  gpu::Counters loading;
  if (Result<void> loaded = world.uploadAll(loading); !loaded) return loaded;
  report.load_ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();

  const Result<ViewController> controller =
      ViewController::create(world, options.camera, options.size.aspect());
  if (!controller) return failAgain(controller.error());
  const Result<spec::View> view = controller->view(world, options.size.aspect());
  if (!view) return failAgain(view.error());

  Result<frame::Frame> frame =
      frame::Frame::create({.size = options.size,
                            .output = options.linear ? frame::Output::Linear : frame::Output::Display,
                            .transfer = options.transfer,
                            .window = options.window,
                            .exposure_ev = options.exposure_ev},
                           *environment);
  if (!frame) return failAgain(frame.error());
  for (std::uint32_t i = 0; i < options.frames; ++i) {
    // Over several frames the light turns into its place, so that what a turn costs can be read off.
    environment->setTurn(options.rotate_light_deg * static_cast<float>(i + 1) /
                         static_cast<float>(options.frames));
    if (Result<void> rendered = frame->render(world, *environment, *view); !rendered) return rendered;
    if (i == 0) {
      frame->timers().finish();
      report.first_frame = frame->timers().latest();
    }
  }
  if (Result<void> written = writePicture(*frame, options); !written) return written;
  if (!options.json) {
    fmt::print("{}\n", options.headless->string());
    return {};
  }
  frame->timers().finish();
  report.last_frame = frame->timers().latest();
  report.bytes_resident = world.residency().bytesResident();
  report.parts = world.loadedParts();
  report.negative_pixels = frame->negativePixels();
  report.exposure_ev = frame->exposureEv();
  report.gl_errors = context->errors();
  fmt::print("{}\n", reportJson(options, context->info(), report));
  return {};
}

}  // namespace lambent::demo
