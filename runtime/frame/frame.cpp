#include "runtime/frame/frame.hpp"

#include <algorithm>
#include <cassert>

#include "runtime/debug/data_view.hpp"
#include "runtime/gpu/context.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/surface/surfaces.hpp"
#include "runtime/tone_map/tone_mapper.hpp"

namespace lambent::frame {

Frame::Frame(const FrameOptions& options, PassList passes, Blackboard board)
    : options_(options),
      board_(std::move(board)),
      passes_(std::move(passes)),
      targets_(options.output, options.destination) {
  for (const auto* list : {&passes_.step, &passes_.picture})
    for (const auto& pass : *list) counts_.declare(pass->info().counts);
  resize(options.size);
}

Result<Frame> Frame::create(const FrameOptions& options, const lighting::Environment& environment) {
  return gpu::orOutOfMemory([&]() -> Result<Frame> {
    Blackboard board;
    Result<PassList> passes = makePassList(options, environment, board);
    if (!passes) return failAgain(passes.error());
    return Frame(options, std::move(*passes), std::move(board));
  });
}

Result<void> Frame::setSettings(const FrameSettings& settings) {
  if (Result<void> checked = checkSettings(settings); !checked) return checked;
  if (std::exchange(options_.settings, settings) != settings) settled_ = false;
  return {};
}

void Frame::forget() {
  for (const auto* list : {&passes_.step, &passes_.picture})
    for (const auto& pass : *list) pass->forget();
  settled_ = false;
  forgotten_ = true;
}

void Frame::resize(const spec::Size& size) {
  options_.size = size;
  targets_.resize(size);
}

Result<void> Frame::share(GLuint color, GLuint depth) {
  assert(options_.destination == Destination::Shared);
  Result<gpu::Texture> hdr = gpu::Texture::sharing("colour target", color);
  if (!hdr) return failAgain(hdr.error());
  Result<gpu::Texture> depths = gpu::Texture::sharing("depth target", depth);
  if (!depths) return failAgain(depths.error());
  const gpu::TextureDesc &a = hdr->desc(), &b = depths->desc();
  if (a.format != GL_RGBA16F && a.format != GL_RGBA32F)
    return fail("colour target", "cannot hold radiance", "make it GL_RGBA16F or GL_RGBA32F");
  constexpr GLenum kDepths[] = {GL_DEPTH_COMPONENT16, GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT32,
                                GL_DEPTH_COMPONENT32F};
  if (std::ranges::find(kDepths, b.format) == std::end(kDepths))
    return fail("depth target", "has no depth, or more than depth", "make it GL_DEPTH_COMPONENT32F");
  if (a.width != b.width || a.height != b.height || a.samples != b.samples)
    return fail("targets", "differ in their size or samples", "make colour and depth alike");
  options_.size = {.width = a.width, .height = a.height};
  targets_.share(std::move(*hdr), std::move(*depths));
  return {};
}

Result<std::optional<Picked>> Frame::pick(World& world, const spec::View& view, float x, float y) {
  return picker_.pick(world, board_.get<Surfaces>(), view, {.size = options_.size, .x = x, .y = y},
                      {.finest_texels = options_.linear(), .volumes = options_.settings.volumes});
}

ViewLegend Frame::legend() const {
  const auto& data_view = kept<std::optional<DataView>>();
  return data_view ? data_view->legend() : legendOf(options_.view, 0.0f);
}

std::uint32_t Frame::negativePixels() const {
  return kept<ToneMapper>().negativePixels();
}

float Frame::exposureEv() const {
  return kept<ToneMapper>().exposureEv();
}

FrameContext Frame::contextOf(World& world, lighting::Environment& environment, const spec::View* view) {
  return {.world = world,
          .environment = environment,
          .options = options_,
          .view = view,
          .targets = targets_,
          .log = log_,
          .counts = counts_,
          .board = board_};
}

Result<void> Frame::render(World& world, lighting::Environment& environment, const spec::View& view) {
  clip_from_view_ = view.clip_from_view;
  world.look(view);
  timers_.beginFrame();
  FrameContext context = contextOf(world, environment, &view);
  if (Result<void> done = step(context); !done) return done;
  log_.noticeView(view, options_.size);
  if (Result<void> done = walk(passes_.picture, context); !done) return done;
  return gpu::checkContext();
}

Result<std::uint32_t> Frame::rest(World& world, lighting::Environment& environment) {
  for (std::uint32_t steps = 0; steps < kMaxRestSteps; ++steps) {
    if (atRest(world, environment)) return steps;
    timers_.beginFrame();
    FrameContext context = contextOf(world, environment, nullptr);
    if (Result<void> done = step(context); !done) return failAgain(done.error());
  }
  return kMaxRestSteps;
}

bool Frame::atRest(const World& world, const lighting::Environment& environment) const {
  return settled_ && environment_ == environment.version() && world.loaded() &&
         std::ranges::all_of(passes_.step, [](const auto& pass) { return pass->settled(); });
}

Result<void> Frame::step(FrameContext& context) {
  counts_.clear();
  log_.begin();
  log_.noticeSettings(options_.settings);
  if (std::exchange(forgotten_, false)) log_.note(Cause::Asked, "asked for");
  settled_ = true;
  Result<void> done = walk(passes_.step, context);
  environment_ = context.environment.version();
  return done;
}

Result<void> Frame::walk(std::span<const std::unique_ptr<FramePass>> passes, FrameContext& context) {
  for (const auto& pass : passes) {
    context.pass = &pass->info();
    if (!pass->due(context)) continue;
    gpu::PassTimers::Scope scope(timers_, pass->info().name);
    context.scope = &scope;
    if (Result<void> done = gpu::orOutOfMemory([&] { return pass->update(context); }); !done) return done;
  }
  return {};
}

}  // namespace lambent::frame
