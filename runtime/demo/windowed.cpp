#include <chrono>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>

#include "runtime/demo/camera.hpp"
#include "runtime/demo/run.hpp"
#include "runtime/frame/frame.hpp"
#include "runtime/gpu/window.hpp"

namespace lambent::demo {

namespace {

using Clock = std::chrono::steady_clock;

constexpr float kTurnDegreesPerSecond = 12.0f;  // on its own
constexpr float kKeyDegreesPerSecond = 60.0f;   // while A or D is held

float secondsSince(Clock::time_point start) {
  return std::chrono::duration<float>(Clock::now() - start).count();
}

// Frames per second over the last second or so, into the title.
class TitleClock {
 public:
  void tick(gpu::Window& window, const std::string& title) {
    ++frames_;
    const float seconds = secondsSince(start_);
    if (seconds < 1.0f) return;
    const float fps = static_cast<float>(frames_) / seconds;
    window.setTitle(fmt::format("{} - {:.0f} frames/s", title, fps));
    start_ = Clock::now();
    frames_ = 0;
  }

 private:
  Clock::time_point start_ = Clock::now();
  int frames_ = 0;
};

}  // namespace

Result<void> runWindowed(const Options& options) {
  Result<lighting::Environment> environment = lighting::Environment::create(options.lights);
  if (!environment) return failAgain(environment.error());
  for (const std::string& notice : environment->notices()) fmt::print(stderr, "lambent-demo: {}\n", notice);

  const std::string title = "Lambent - " + options.bundles.front().filename().string();
  Result<gpu::Window> window = gpu::Window::create(title, options.size.width, options.size.height, {});
  if (!window) return failAgain(window.error());
  frame::World world({.max_resident_bytes = options.max_memory_bytes});
  for (const std::filesystem::path& path : options.bundles)
    if (Result<void> opened = world.open(path); !opened) return opened;
  world.scaleLamps(options.lamps);
  Result<ViewController> controller = ViewController::create(world, options.camera, options.size.aspect());
  if (!controller) return failAgain(controller.error());
  spec::Size size = options.size;
  window->framebufferSize(size.width, size.height);
  Result<frame::Frame> frame = frame::Frame::create({.size = size,
                                                     .output = frame::Output::Display,
                                                     .to_window = true,
                                                     .transfer = options.transfer,
                                                     .window = options.window,
                                                     .exposure_ev = options.exposure_ev},
                                                    *environment);
  if (!frame) return failAgain(frame.error());

  float turn_deg = options.rotate_light_deg;
  bool turning = true;
  TitleClock title_clock;
  Clock::time_point last = Clock::now();
  while (true) {
    const gpu::Input input = window->poll();
    if (input.quit) return {};
    const float seconds = secondsSince(last);
    last = Clock::now();
    if (input.pause) turning = !turning;
    if (input.turn != 0)
      turn_deg += kKeyDegreesPerSecond * seconds * static_cast<float>(input.turn);
    else if (turning)
      turn_deg += kTurnDegreesPerSecond * seconds;
    turn_deg = std::remainder(turn_deg, 360.0f);
    environment->setTurn(turn_deg);
    controller->move(world, input);

    window->framebufferSize(size.width, size.height);
    frame->resize(size);
    const Result<spec::View> view = controller->view(world, size.aspect());
    if (!view) return failAgain(view.error());
    if (Result<void> rendered = frame->render(world, *environment, *view); !rendered) return rendered;
    window->swap();
    title_clock.tick(*window, title);
  }
}

}  // namespace lambent::demo
