#include "runtime/frame/frame.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "runtime/frame/frame_parts.hpp"
#include "runtime/gpu/context.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/scene/materials.hpp"

namespace lambent::frame {

namespace {

// Sets `seen` to the current version of a type of components. Returns whether it was another one.
template <typename Component>
bool changed(const ecs::Registry& registry, std::uint64_t& seen) {
  const std::uint64_t now = registry.version<Component>();
  return std::exchange(seen, now) != now;
}

bool sameValue(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

void append(std::string& words, std::string_view more) {
  if (words.find(more) != std::string::npos) return;
  if (!words.empty()) words += ", ";
  words += more;
}

}  // namespace

void InvalidationLog::note(Cause cause, std::string words) {
  notes_.push_back({cause, std::move(words)});
}

void InvalidationLog::noticeArrivals(const World& world, std::uint64_t bytes) {
  if (bytes == 0) return;
  note(Cause::Arrived,
       fmt::format("{} kB arrived{}", (bytes + 999) / 1000, world.loaded() ? ", the last" : ""));
}

void InvalidationLog::noticeWorld(const World& world) {
  const ecs::Registry& registry = world.registry();
  const bool nodes = changed<scene::WorldTransform>(registry, transforms_);
  const bool groups = changed<scene::RigidGroupComponent>(registry, groups_);
  const bool lamps = changed<scene::LampComponent>(registry, lamps_);
  const bool lights = changed<scene::LocalLightComponent>(registry, local_lights_);
  const bool materials = changed<scene::MaterialComponent>(registry, materials_);
  if (!std::exchange(world_known_, true)) return;
  if (groups || nodes) note(Cause::Moved, groups ? "groups moved" : "nodes moved");
  if (lamps) note(Cause::Lights, "lamps changed");
  if (lights) note(Cause::Lights, "lights changed");
  if (materials) note(Cause::Materials, "materials changed");
}

void InvalidationLog::noticeEnvironment(const lighting::Environment& environment) {
  if (environment.version() == environment_) return;
  const bool first = std::exchange(environment_, environment.version()) == 0;
  if (first) {
    // The first step has nothing to compare with.
  } else if (environment.lightsVersion() != lights_) {
    note(Cause::Environment, "other light from outside");
  } else {
    if (environment.turnDegrees() != turn_) note(Cause::Environment, "light turned");
    if (environment.fade() != fade_) note(Cause::Environment, "light faded");
    if (environment.intensity() != intensity_) note(Cause::Environment, "light's intensity changed");
  }
  lights_ = environment.lightsVersion();
  turn_ = environment.turnDegrees();
  fade_ = environment.fade();
  intensity_ = environment.intensity();
}

void InvalidationLog::noticeSettings(const FrameSettings& settings) {
  if (!settings_) note(Cause::Settings, "first frame");
  if (settings_ && settings != *settings_)
    for (const SettingRow& row : settingRows())
      if (!sameValue(row.get(settings), row.get(*settings_)))
        note(row.name == "exposure" ? Cause::Exposure : Cause::Settings,
             fmt::format("{}: {}", row.label, settingWord(row, settings)));
  settings_ = settings;
}

void InvalidationLog::noticeView(const spec::View& view, const spec::Size& size) {
  if (!view_ || view.view_from_world != view_->view_from_world ||
      view.clip_from_view != view_->clip_from_view)
    note(Cause::View, "camera");
  if (view_ && !(size == size_)) note(Cause::View, "size of the picture");
  view_ = view;
  size_ = size;
}

std::string InvalidationLog::of(std::uint32_t causes, std::string_view otherwise) const {
  std::string words;
  for (const Note& note : notes_)
    if ((causes & static_cast<std::uint32_t>(note.cause)) != 0) append(words, note.words);
  return words.empty() ? std::string(otherwise) : words;
}

// The counts, in the order of the passes.
StepCounts::StepCounts() {
  const auto declare = [this](std::initializer_list<std::string_view> names) {
    for (const std::string_view name : names) counts_.push_back({.name = name});
  };
  declare({"volumes", "groups", "bodies", "local_lights", "shadowed_lights", "shadowed_lights_left_out",
           "light_probes", "light_probes_risen", "light_probes_written"});
  declare({"patch_rooms", "patch_rooms_to_come", "patches", "lights_bounced", "patch_draws_gathered"});
  declare({"cells_shaded", "draws_shaded"});
  declare({"neighborhood_grids", "neighborhood_grids_ready", "neighborhood_grids_written",
           "neighborhood_pairs", "neighborhood_receivers", "neighborhood_arrivals",
           "neighborhood_vertex_receivers", "neighborhood_vertex_receivers_shaded",
           "neighborhood_arrivals_left_out"});
  declare({"light_probes_captured", "light_probes_waiting", "capture_bodies_drawn"});
  declare({"shadow_cubes_drawn", "key_lights", "key_maps_drawn", "reflection_probes",
           "reflection_probes_captured"});
  declare({"draws_out_of_view", "volumes_shaded", "volume_slabs_written", "volumes_out_of_view",
           "volumes_drawn"});
}

void StepCounts::clear() {
  for (Count& count : counts_) count.value = 0;
}

std::size_t StepCounts::placeOf(std::string_view name) const {
  const auto found = std::ranges::find(counts_, name, &Count::name);
  if (found == counts_.end()) throw std::out_of_range(fmt::format("no pass counts {}", name));
  return static_cast<std::size_t>(found - counts_.begin());
}

void StepCounts::add(std::string_view name, std::uint64_t value) {
  counts_[placeOf(name)].value += value;
}

std::uint64_t StepCounts::operator[](std::string_view name) const {
  return counts_[placeOf(name)].value;
}

namespace {

constexpr float kFar = 1.0f;

// Reverses the order of rows, because the first row of GL's pictures is at the bottom.
template <typename Texel>
std::vector<Texel> flipped(const std::vector<Texel>& texels, std::size_t row_length) {
  std::vector<Texel> result(texels.size());
  for (std::size_t begin = 0; begin < texels.size(); begin += row_length)
    std::copy_n(texels.begin() + static_cast<std::ptrdiff_t>(begin), row_length,
                result.end() - static_cast<std::ptrdiff_t>(begin + row_length));
  return result;
}

// Converts depths to distances along the view axis. All projections map z to (a z + b) / (c z + d).
std::vector<float> linearDepths(std::vector<float> window_depths, const glm::mat4& clip_from_view) {
  const double a = clip_from_view[2][2], b = clip_from_view[3][2], c = clip_from_view[2][3],
               d = clip_from_view[3][3];
  for (float& depth : window_depths) {
    const double clip_z = 2.0 * double{depth} - 1.0;
    depth = depth < kFar ? static_cast<float>((b - d * clip_z) / (a - c * clip_z))
                         : std::numeric_limits<float>::infinity();
  }
  return window_depths;
}

}  // namespace

std::uint32_t samplesOf(Output output) {
  constexpr std::uint32_t kDisplaySamples = 4;  // OpenGL 4.5 promises four
  return output == Output::Display ? kDisplaySamples : 0;
}

void PictureTargets::resize(const spec::Size& size) {
  if (destination_ == Destination::Shared || (hdr_ && size == size_)) return;
  size_ = size;
  ++version_;
  const std::uint32_t samples = samplesOf(output_);
  const bool linear = output_ == Output::Linear;
  hdr_ = gpu::Texture("hdr", {.format = linear ? GLenum{GL_RGBA32F} : GLenum{GL_RGBA16F},
                              .width = size.width,
                              .height = size.height,
                              .samples = samples});
  depth_ = gpu::Texture(
      "depth",
      {.format = GL_DEPTH_COMPONENT32F, .width = size.width, .height = size.height, .samples = samples});
  hdr_target_ = gpu::Framebuffer("hdr", hdr_, &depth_);
  hdr_color_target_ = gpu::Framebuffer("hdr color", hdr_, nullptr);
  if (destination_ == Destination::Window) return;
  picture_ = gpu::Texture(
      "picture",
      {.format = linear ? GLenum{GL_RGBA32F} : GLenum{GL_RGBA8}, .width = size.width, .height = size.height});
  picture_target_ = gpu::Framebuffer("picture", picture_, nullptr);
}

void PictureTargets::share(gpu::Texture hdr, gpu::Texture depth) {
  size_ = {.width = hdr.desc().width, .height = hdr.desc().height};
  ++version_;
  hdr_ = std::move(hdr);
  depth_ = std::move(depth);
  hdr_target_ = gpu::Framebuffer("hdr", hdr_, &depth_);
  hdr_color_target_ = gpu::Framebuffer("hdr color", hdr_, nullptr);
}

void PictureTargets::bindCleared(float grey) {
  hdr_target_.bind();
  gpu::testDepth();
  if (destination_ == Destination::Shared) return;
  hdr_target_.clearColor({grey, grey, grey, 0.0f});
  hdr_target_.clearDepth();
}

void PictureTargets::bindPicture() const {
  glBindFramebuffer(GL_FRAMEBUFFER, destination_ == Destination::Window ? 0 : picture_target_.id());
}

spec::RgbaImage PictureTargets::readLinear(const glm::mat4& clip_from_view) const {
  std::vector<glm::vec4> texels(std::size_t{size_.width} * size_.height);
  glGetTextureImage(picture_.id(), 0, GL_RGBA, GL_FLOAT,
                    static_cast<GLsizei>(texels.size() * sizeof(glm::vec4)), texels.data());
  spec::RgbaImage image{.width = size_.width, .height = size_.height, .texels = flipped(texels, size_.width)};
  if (output_ != Output::Linear) return image;  // the depth buffer has several samples per pixel
  std::vector<float> depths(texels.size());
  glGetTextureImage(depth_.id(), 0, GL_DEPTH_COMPONENT, GL_FLOAT,
                    static_cast<GLsizei>(depths.size() * sizeof(float)), depths.data());
  image.depths = linearDepths(flipped(depths, size_.width), clip_from_view);
  return image;
}

spec::Rgba8Image PictureTargets::readDisplay() const {
  std::vector<std::uint8_t> texels(std::size_t{size_.width} * size_.height * 4);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glGetTextureImage(picture_.id(), 0, GL_RGBA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(texels.size()),
                    texels.data());
  return {
      .width = size_.width, .height = size_.height, .texels = flipped(texels, std::size_t{size_.width} * 4)};
}

Frame::Frame(const FrameOptions& options, std::shared_ptr<FrameParts> parts)
    : options_(options), parts_(std::move(parts)), targets_(options.output, options.destination) {
  resize(options.size);
}

Result<Frame> Frame::create(const FrameOptions& options, const lighting::Environment& environment) {
  return gpu::orOutOfMemory([&]() -> Result<Frame> {
    Result<lighting::Sky> sky = lighting::Sky::create(environment);
    if (!sky) return failAgain(sky.error());
    return Frame(options, std::make_shared<FrameParts>(options, std::move(*sky)));
  });
}

Result<void> Frame::setSettings(const FrameSettings& settings) {
  if (Result<void> checked = checkSettings(settings); !checked) return checked;
  if (std::exchange(options_.settings, settings) != settings) settled_ = false;
  return {};
}

void Frame::forget() {
  parts_->group_lights.forget();
  if (parts_->incident) parts_->incident->forget();
  parts_->local_shadows.forget();
  parts_->key_shadows.forget();
  parts_->rooms.captured_from.forget();
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
  return picker_.pick(world, parts_->surfaces, view,
                      {.size = options_.size,
                       .x = x,
                       .y = y,
                       .finest_texels = options_.linear(),
                       .volumes = options_.settings.volumes});
}

ViewLegend Frame::legend() const {
  return parts_->data_view ? parts_->data_view->legend() : legendOf(options_.view, 0.0f);
}

std::uint32_t Frame::negativePixels() const {
  return parts_->tone_mapper.negativePixels();
}

float Frame::exposureEv() const {
  return parts_->tone_mapper.exposureEv();
}

FrameContext Frame::contextOf(World& world, lighting::Environment& environment, const spec::View* view) {
  return {.world = world,
          .environment = environment,
          .options = options_,
          .view = view,
          .targets = targets_,
          .log = log_,
          .counts = counts_,
          .parts = *parts_};
}

Result<void> Frame::render(World& world, lighting::Environment& environment, const spec::View& view) {
  clip_from_view_ = view.clip_from_view;
  world.look(view);
  timers_.beginFrame();
  FrameContext context = contextOf(world, environment, &view);
  if (Result<void> done = step(context); !done) return done;
  log_.noticeView(view, options_.size);
  if (Result<void> done = walk(surfacePasses(), context); !done) return done;
  if (Result<void> done = walk(picturePasses(), context); !done) return done;
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
         (!parts_->incident || parts_->incident->atRest()) && parts_->neighborhoods.settled();
}

Result<void> Frame::step(FrameContext& context) {
  counts_.clear();
  log_.begin();
  log_.noticeSettings(options_.settings);
  if (std::exchange(forgotten_, false)) log_.note(Cause::Asked, "asked for");
  settled_ = true;
  Result<void> done = walk(stepPasses(), context);
  environment_ = context.environment.version();
  return done;
}

Result<void> Frame::walk(std::span<const FramePass> passes, FrameContext& context) {
  for (const FramePass& pass : passes) {
    context.pass = &pass;
    if (pass.due != nullptr && !pass.due(context)) continue;
    gpu::PassTimers::Scope scope(timers_, pass.name);
    context.scope = &scope;
    if (Result<void> done = gpu::orOutOfMemory([&] { return pass.update(context); }); !done) return done;
  }
  return {};
}

}  // namespace lambent::frame
