#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>
#include <set>
#include <string_view>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "runtime/demo/stage.hpp"
#include "runtime/frame/frame.hpp"
#include "runtime/gpu/context.hpp"

namespace lambent::demo {

namespace {

using Clock = std::chrono::steady_clock;

constexpr float kTurnDegreesPerSecond = 12.0f;  // without a key held
constexpr float kKeyDegreesPerSecond = 60.0f;   // while A or D is held

float secondsSince(Clock::time_point start) {
  return std::chrono::duration<float>(Clock::now() - start).count();
}

// Adds what is being loaded and how much of the memory is taken.
std::string titleOf(const std::string& title, const frame::StreamingStatus& status) {
  constexpr double kMegabyte = 1e6;
  std::string text =
      fmt::format("{} - {:.0f}", title, static_cast<double>(status.resident_bytes) / kMegabyte);
  if (status.budget_bytes != ~std::uint64_t{0})
    text += fmt::format(" of {:.0f}", static_cast<double>(status.budget_bytes) / kMegabyte);
  text += " MB";
  return status.queued == 0 ? text : fmt::format("{}, {} parts to come", text, status.queued);
}

constexpr std::string_view kKeys =
    "drag          turn the camera\n"
    "wheel         nearer, farther\n"
    "right drag    move the first light\n"
    "R             first view again\n"
    "A, D          turn the lights\n"
    "space         stop lights and animations\n"
    "Esc           quit";

// Returns the distance to the surface in the middle of the picture, or none where the sky is.
std::optional<float> surfaceAhead(frame::Frame& frame, frame::World& world, const spec::View& view,
                                  spec::Size size) {
  const auto picked =
      frame.pick(world, view, 0.5f * static_cast<float>(size.width), 0.5f * static_cast<float>(size.height));
  if (!picked || !*picked) return std::nullopt;
  return glm::length((*picked)->position_ws - view.eye_ws);
}

}  // namespace

Result<void> runWindowed(const Options& options) {
  Result<lighting::Environment> environment = loadEnvironment(options);
  if (!environment) return failAgain(environment.error());
  const std::string title = "Lambent - " + options.bundles.front().filename().string() + " - H: keys";
  Result<gpu::Window> window = gpu::Window::create(title, options.size.width, options.size.height, {});
  if (!window) return failAgain(window.error());
  Result<Stage> stage = Stage::create(options, std::move(*environment));
  if (!stage) return failAgain(stage.error());
  frame::World& world = stage->world();
  spec::Size size = options.size;
  window->framebufferSize(size.width, size.height);
  Result<frame::Frame> frame = frame::Frame::create({.size = size,
                                                     .output = frame::Output::Display,
                                                     .destination = frame::Destination::Window,
                                                     .settings = options.settings,
                                                     .view = options.view,
                                                     .overlays = options.overlays},
                                                    stage->environment());
  if (!frame) return failAgain(frame.error());

  float turn_deg = options.rotate_light_deg;
  bool turning = true;
  std::optional<spec::View> last_view;
  world.setAnimationTime(options.time_s.value_or(0.0f));
  Clock::time_point titled = Clock::now();
  int frames = 0;                  // since the title was set, about once per second
  std::set<std::string> reported;  // errors of bundles, each reported once
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
    stage->environment().setTurn(turn_deg);
    if (turning) world.playAnimations(seconds);
    if (input.help) fmt::print("{}\n", kKeys);
    // Only the wheel asks what is ahead, since the answer waits for the GPU.
    stage->move(input, input.scroll > 0.0f && last_view ? surfaceAhead(*frame, world, *last_view, size)
                                                        : std::nullopt);

    window->framebufferSize(size.width, size.height);
    frame->resize(size);
    world.updateTransforms();
    const Result<spec::View> view = stage->view(size.aspect());
    if (!view) return failAgain(view.error());
    if (input.light_x != 0.0f || input.light_y != 0.0f) stage->dragLight(*view, input.light_x, input.light_y);
    if (Result<void> rendered = frame->render(world, stage->environment(), *view); !rendered) return rendered;
    last_view = *view;
    window->swap();
    for (const frame::BundleError& wrong : world.errors())
      if (reported.insert(wrong.error.line()).second) printError(wrong.error);
    ++frames;
    if (const float since = secondsSince(titled); since >= 1.0f) {
      window->setTitle(fmt::format("{} - {:.0f} frames/s", titleOf(title, world.streaming()),
                                   static_cast<float>(frames) / since));
      titled = Clock::now();
      frames = 0;
    }
  }
}

}  // namespace lambent::demo
