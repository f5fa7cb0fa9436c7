#include "lambent/renderer.hpp"

#include <cmath>
#include <utility>

#include <glm/matrix.hpp>

#include "runtime/frame/frame.hpp"
#include "runtime/library/convert.hpp"
#include "runtime/library/state.hpp"

namespace lambent {

using library::failureOf;
using library::toGlm;

struct Renderer::State {
  frame::Frame frame;
};

Renderer::Renderer(std::unique_ptr<State> state) : state_(std::move(state)) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

Expected<Renderer> Renderer::create() {
  const Result<gpu::Context> context = gpu::Context::attachToCurrent({.debug = false});
  if (!context) return failureOf(context.error());
  const library::HostState host;
  const Result<lighting::Environment> dark = lighting::Environment::create({});
  if (!dark) return failureOf(dark.error());
  Result<frame::Frame> made =
      frame::Frame::create({.size = {}, .destination = frame::Destination::Shared}, *dark);
  if (!made) return failureOf(made.error());
  return Renderer(std::make_unique<State>(State{std::move(*made)}));
}

Expected<void> Renderer::set(const std::string& name, const std::string& value) {
  frame::FrameSettings settings = state_->frame.settings();
  Result<void> done = frame::putSetting(settings, name, value);
  if (done) done = state_->frame.setSettings(settings);
  if (!done) return failureOf(done.error());
  return {};
}

void Renderer::showSky(bool shown) {
  state_->frame.setShowSky(shown);
}

Expected<void> Renderer::draw(Scene& scene, const Camera& camera, const Target& target) {
  spec::View view{.view_from_world = toGlm(camera.view_from_world),
                  .clip_from_view = toGlm(camera.clip_from_view)};
  const float size = std::abs(glm::determinant(view.view_from_world) * glm::determinant(view.clip_from_view));
  if (!(size > 0.0f) || !std::isfinite(size))
    return Failure{"camera", "has a matrix that is singular or not finite", {}};
  view.eye_ws = glm::vec3(glm::inverse(view.view_from_world)[3]);
  const library::HostState host;
  if (const Result<void> shared = state_->frame.share(target.color, target.depth); !shared)
    return failureOf(shared.error());
  scene.state_->environment.setMostKeys(state_->frame.settings().mostKeys());
  const Result<void> drawn = state_->frame.render(scene.state_->world, scene.state_->environment, view);
  if (!drawn) return failureOf(drawn.error());
  return {};
}

Expected<void> Renderer::settle(Scene& scene) {
  const library::HostState host;
  scene.state_->environment.setMostKeys(state_->frame.settings().mostKeys());
  const Result<std::uint32_t> steps = state_->frame.rest(scene.state_->world, scene.state_->environment);
  if (!steps) return failureOf(steps.error());
  return {};
}

std::vector<PassTime> Renderer::times() const {
  std::vector<PassTime> times;
  for (const gpu::PassTime& pass : state_->frame.timers().latest())
    times.push_back({.name = pass.name, .cpu_ms = pass.cpu_ms, .gpu_ms = pass.gpu_ms});
  return times;
}

}  // namespace lambent
