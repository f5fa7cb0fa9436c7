#include "runtime/frame/frame.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace lambent::frame {

namespace {

constexpr std::uint32_t kDisplaySamples = 4;  // OpenGL 4.5 promises four

std::uint32_t samplesOf(Output output) {
  return output == Output::Display ? kDisplaySamples : 0;
}

// GL's pictures have their first row at the bottom.
template <typename Texel>
std::vector<Texel> flipped(const std::vector<Texel>& texels, std::size_t row_length) {
  std::vector<Texel> result(texels.size());
  for (std::size_t begin = 0; begin < texels.size(); begin += row_length)
    std::copy_n(texels.begin() + static_cast<std::ptrdiff_t>(begin), row_length,
                result.end() - static_cast<std::ptrdiff_t>(begin + row_length));
  return result;
}

// Distances along the view axis of what a depth buffer holds; of perspectives and parallel projections, which
// both map z to (a z + b) / (c z + d).
std::vector<float> linearDepths(std::vector<float> window_depths, const glm::mat4& clip_from_view) {
  const double a = clip_from_view[2][2], b = clip_from_view[3][2], c = clip_from_view[2][3],
               d = clip_from_view[3][3];
  constexpr float kFar = 1.0f;  // what clearPicture() leaves
  for (float& depth : window_depths) {
    const double clip_z = 2.0 * double{depth} - 1.0;
    depth = depth < kFar ? static_cast<float>((b - d * clip_z) / (a - c * clip_z))
                         : std::numeric_limits<float>::infinity();
  }
  return window_depths;
}

}  // namespace

Frame::Frame(const FrameOptions& options, lighting::Sky sky, Surfaces surfaces, ToneMapper tone_mapper)
    : options_(options),
      sky_(std::move(sky)),
      surfaces_(std::move(surfaces)),
      tone_mapper_(std::move(tone_mapper)),
      volume_(/*precise=*/options.output == Output::Linear) {
  resize(options.size);
}

Result<Frame> Frame::create(const FrameOptions& options, const lighting::Environment& environment) {
  Result<lighting::Sky> sky = lighting::Sky::create(environment);
  if (!sky) return failAgain(sky.error());
  Result<Surfaces> surfaces = Surfaces::create(/*finest_texels=*/options.output == Output::Linear);
  if (!surfaces) return failAgain(surfaces.error());
  Result<ToneMapper> tone_mapper =
      ToneMapper::create(samplesOf(options.output), /*linear=*/options.output == Output::Linear);
  if (!tone_mapper) return failAgain(tone_mapper.error());
  return Frame(options, std::move(*sky), std::move(*surfaces), std::move(*tone_mapper));
}

Result<void> Frame::setSettings(const FrameSettings& settings) {
  if (Result<void> checked = checkSettings(settings); !checked) return checked;
  const FrameSettings before = std::exchange(options_.settings, settings);
  if (settings == before) return {};
  // What other ways of the light leave in the captures by small steps must not depend on which way was on.
  if (incident_ &&
      (settings.captures != before.captures || settings.neighborhoods != before.neighborhoods ||
       settings.local_shadows != before.local_shadows || settings.local_radii != before.local_radii ||
       settings.light_probes != before.light_probes))
    incident_->forget();
  settled_ = false;
  return {};
}

void Frame::forget() {
  group_lights_.forget();
  local_shadows_.forget();
  key_shadows_.forget();
  if (incident_) incident_->forget();
  settled_ = false;
  forgotten_ = true;
}

Result<std::optional<Picked>> Frame::pick(World& world, const spec::View& view, float x, float y) {
  return picker_.pick(
      world, surfaces_, view, options_.size, x, y,
      {.finest_texels = options_.output == Output::Linear, .volumes = options_.settings.volumes});
}

void Frame::resize(const spec::Size& size) {
  if (hdr_ && size == options_.size) return;
  options_.size = size;
  const std::uint32_t samples = samplesOf(options_.output);
  const bool linear = options_.output == Output::Linear;
  hdr_ = gpu::Texture("hdr", {.format = linear ? GLenum{GL_RGBA32F} : GLenum{GL_RGBA16F},
                              .width = size.width,
                              .height = size.height,
                              .samples = samples});
  depth_ = gpu::Texture(
      "depth",
      {.format = GL_DEPTH_COMPONENT32F, .width = size.width, .height = size.height, .samples = samples});
  hdr_target_ = gpu::Framebuffer("hdr", hdr_, &depth_);
  hdr_color_target_ = {};
  overlays_.reset();
  if (options_.to_window) return;
  picture_ = gpu::Texture(
      "picture",
      {.format = linear ? GLenum{GL_RGBA32F} : GLenum{GL_RGBA8}, .width = size.width, .height = size.height});
  picture_target_ = gpu::Framebuffer("picture", picture_, nullptr);
}

Result<void> Frame::render(World& world, const lighting::Environment& environment, const spec::View& view) {
  const auto now = std::chrono::steady_clock::now();
  if (rendered_)
    pacer_.frameTook(std::chrono::duration<double, std::milli>(now - *rendered_).count(), uploaded_bytes_ > 0,
                     options_.upload_budget_bytes);
  rendered_ = now;
  clip_from_view_ = view.clip_from_view;
  uploaded_bytes_ = 0;
  world.look(view);
  timers_.beginFrame();
  if (Result<void> done = step(world, environment, options_.settings.captures_per_step); !done) return done;
  invalidation_log_.noticeView(view, options_.size);
  // what is seen where nothing stands, if other lights were loaded
  updateSky(environment);
  // cubes of the lights that stand among surfaces
  if (Result<void> done = castShadows(world); !done) return done;
  // shadow maps of key lights over what is seen
  if (Result<void> done = castKeyShadows(world, environment, view); !done) return done;
  // the sky as rough mirrors show it
  if (Result<void> done = reflectSky(world, environment); !done) return done;
  // surfaces, sky, blended surfaces: linear radiance
  if (Result<void> done = raster(world, environment, view); !done) return done;
  // what volumes scatter and let through
  if (Result<void> done = marchVolumes(world, view); !done) return done;
  // exposure, tone curve, sRGB; negative pixels are counted and clamped here
  toneMap();
  // what is asked for to be seen besides, as it is
  return drawOverlays(world, environment, view);
}

Result<std::uint32_t> Frame::rest(World& world, const lighting::Environment& environment) {
  for (std::uint32_t steps = 0; steps < kMaxRestSteps; ++steps) {
    if (atRest(world, environment)) return steps;
    timers_.beginFrame();
    // nobody waits for the next picture
    if (Result<void> done = step(world, environment, kAllCaptures); !done) return failAgain(done.error());
  }
  return kMaxRestSteps;
}

bool Frame::atRest(const World& world, const lighting::Environment& environment) const {
  return settled_ && environment_seen_ == environment.version() && world.loaded() &&
         (!incident_ || incident_->atRest()) && neighborhoods_.settled();
}

Result<void> Frame::step(World& world, const lighting::Environment& environment, std::size_t max_captures) {
  counts_ = {};
  invalidation_log_.begin();
  invalidation_log_.noticeSettings(options_.settings);
  invalidation_log_.noticeEnvironment(environment);
  if (std::exchange(forgotten_, false)) invalidation_log_.note(Cause::Asked, "asked for");
  settled_ = true;
  environment_seen_ = environment.version();
  // what has arrived goes to the GPU, within the budget
  if (Result<void> done = upload(world); !done) return done;
  // where nodes and rigid groups stand
  transforms(world);
  // what arrives at each light probe, windowed and turned into its group's frame
  if (Result<void> done = light(world, environment); !done) return done;
  // what surfaces send on of the lights that stand among them, and of key lights
  if (Result<void> done = bounce(world, environment); !done) return done;
  // E/pi at every vertex whose light or transfer is new
  if (Result<void> done = shade(world); !done) return done;
  // transferred light at the samples of glossy surfaces, likewise
  if (Result<void> done = shadeGlossy(world); !done) return done;
  // and what of it rays through volumes look up
  if (Result<void> done = shadeVolumes(world); !done) return done;
  // what bodies with grids change around them
  if (Result<void> done = shadeNeighborhoods(world); !done) return done;
  // what bodies send to each other: arrives with the next step
  return capture(world, environment, max_captures);
}

Result<void> Frame::upload(World& world) {
  gpu::PassTimers::Scope pass(timers_, "upload");
  const std::uint64_t most = options_.upload_budget_bytes;
  Result<void> done = world.upload(options_.pace_uploads ? pacer_.budget(most) : most, pass.counters());
  uploaded_bytes_ += pass.counters().uploaded_bytes;
  invalidation_log_.noticeArrivals(world, pass.counters().uploaded_bytes);
  pass.because(invalidation_log_.of(static_cast<std::uint32_t>(Cause::Arrived)));
  return done;
}

void Frame::transforms(World& world) {
  gpu::PassTimers::Scope pass(timers_, "transforms");
  world.updateTransforms();
  world.updateMaterials();
  invalidation_log_.noticeWorld(world);
  pass.because(invalidation_log_.of(Cause::Moved | Cause::Materials));
}

Result<void> Frame::shade(World& world) {
  gpu::PassTimers::Scope pass(timers_, "shade");
  const FrameSettings& settings = options_.settings;
  Result<void> done = diffuse_.shade(world.residency(), group_lights_, settings.transfer, pass.counters(),
                                     {.surfaces = settings.diffuse, .volumes = settings.volumes});
  if (pass.counters().dispatches > 0) pass.because(invalidation_log_.of(kLightCauses, "light"));
  counts_.cells_shaded = diffuse_.shadedLast().cells;
  counts_.draws_shaded = diffuse_.shadedLast().draws;
  return done;
}

Result<void> Frame::shadeGlossy(World& world) {
  const auto& cells = world.residency().cells();
  if (std::none_of(cells.begin(), cells.end(), [](const auto& cell) { return cell.matrices(); })) return {};
  gpu::PassTimers::Scope pass(timers_, "glossy");
  const FrameSettings& settings = options_.settings;
  Result<void> done = glossy_.shade(
      world.residency(), group_lights_, settings.transfer, pass.counters(),
      {.surfaces = settings.glossy, .volumes = settings.volumes, .neighborhoods = settings.neighborhoods});
  if (pass.counters().dispatches > 0) pass.because(invalidation_log_.of(kLightCauses, "light"));
  counts_.cells_shaded += glossy_.cellsShadedLast();
  return done;
}

Result<void> Frame::shadeVolumes(World& world) {
  counts_.volumes = static_cast<std::uint32_t>(world.residency().volumes().size());
  if (counts_.volumes == 0 || !options_.settings.volumes) return {};
  gpu::PassTimers::Scope pass(timers_, "volume");
  Result<void> done = volume_.shade(world.residency(), group_lights_, diffuse_, glossy_,
                                    options_.settings.transfer, pass.counters());
  if (pass.counters().dispatches > 0) pass.because(invalidation_log_.of(kLightCauses, "light"));
  counts_.volumes_shaded = volume_.shadedLast().volumes;
  counts_.volume_slabs_written = volume_.shadedLast().slabs;
  return done;
}

Result<void> Frame::marchVolumes(World& world, const spec::View& view) {
  const auto& volumes = world.residency().volumes();
  const SurfaceView shown = options_.view.view;
  if (volumes.empty() || !options_.settings.volumes ||
      (shown != SurfaceView::Final && shown != SurfaceView::Wireframe))
    return {};
  gpu::PassTimers::Scope pass(timers_, "march");
  pass.because(invalidation_log_.of(kPictureCauses));
  // Pictures that are compared take half the steps, all at their places.
  const bool linear = options_.output == Output::Linear;
  if (!march_) march_.emplace(effects::volume::MarchOptions{.jitter = !linear});
  march_->setStep(options_.settings.march_step_voxels * (linear ? 0.5f : 1.0f));
  if (!hdr_color_target_) hdr_color_target_ = gpu::Framebuffer("hdr color", hdr_, nullptr);
  std::vector<effects::volume::PlacedVolume> placed;
  for (std::uint32_t v = 0; v < volumes.size(); ++v)
    if (world.showsSurfaces(world.residency().groups()[volumes[v].group].bundle))
      placed.push_back({v, world.worldFromGroup(volumes[v].group)});
  Result<void> done = march_->draw(world.residency(), volume_, placed, view,
                                   {hdr_color_target_, depth_, options_.size}, pass.counters());
  counts_.volumes_drawn = march_->drawnLast();
  return done;
}

Result<void> Frame::shadeNeighborhoods(World& world) {
  if (!options_.settings.neighborhoods || !neighborhoods_.any()) return {};
  gpu::PassTimers::Scope pass(timers_, "neighborhood");
  Result<void> done =
      neighborhoods_.update(world, group_lights_, glossy_, options_.settings.transfer, pass.counters());
  if (pass.counters().dispatches > 0 || pass.counters().uploaded_bytes > 0)
    pass.because(invalidation_log_.of(kLightCauses, "light"));
  counts_.neighborhoods = neighborhoods_.counts();
  return done;
}

Result<void> Frame::castShadows(World& world) {
  gpu::PassTimers::Scope pass(timers_, "shadows");
  Result<void> done =
      local_shadows_.update(world, lit_scene_.shadowed_lights, lit_scene_.pixel_masks, pass.counters());
  counts_.shadow_cubes_drawn = local_shadows_.cubesDrawn();
  if (counts_.shadow_cubes_drawn > 0)
    pass.because(invalidation_log_.of(kLightCauses | Cause::Materials, "lights among surfaces"));
  return done;
}

Result<void> Frame::castKeyShadows(World& world, const lighting::Environment& environment,
                                   const spec::View& view) {
  counts_.key_lights = static_cast<std::uint32_t>(environment.keys().size());
  if (environment.keys().empty() && !key_shadows_.any()) return {};
  gpu::PassTimers::Scope pass(timers_, "key shadows");
  const std::span<const spec::Disc> keys = keysApart() ? environment.keys() : std::span<const spec::Disc>();
  Result<void> done = key_shadows_.update(
      world, keys, view, {.finest = options_.settings.key_size, .samples = options_.settings.key_samples},
      pass.counters());
  counts_.key_maps_drawn = key_shadows_.mapsDrawn();
  if (key_shadows_.mapsDrawn() > 0) pass.because(invalidation_log_.of(kPictureCauses));
  return done;
}

Result<void> Frame::reflectSky(const World& world, const lighting::Environment& environment) {
  if (!options_.settings.residual || !options_.settings.glossy || !glossy_.any()) return {};
  const std::uint64_t source = lighting::PrefilteredEnvironment::sourceVersion(environment);
  if (prefiltered_environment_ && reflected_lights_ == source) return {};
  if (std::ranges::none_of(world.residency().groups(),
                           [](const streaming::ResidentGroup& group) { return group.glossy_outputs > 0; }))
    return {};  // matrices of neighborhoods or volumes alone
  gpu::PassTimers::Scope pass(timers_, "specular environment");
  Result<lighting::PrefilteredEnvironment> made =
      lighting::PrefilteredEnvironment::make(environment, sky_, pass.counters());
  if (!made) return failAgain(made.error());
  prefiltered_environment_ = std::move(*made);
  reflected_lights_ = source;
  pass.because(invalidation_log_.of(static_cast<std::uint32_t>(Cause::Environment), "first needed"));
  return {};
}

void Frame::updateSky(const lighting::Environment& environment) {
  if (sky_.upToDate(environment)) return;
  gpu::PassTimers::Scope pass(timers_, "sky");
  sky_.update(environment);
  pass.because(invalidation_log_.of(static_cast<std::uint32_t>(Cause::Environment)));
}

// Also where numbers are drawn in place of light: what is picked is found among these.
Result<void> Frame::prepareSurfaces(World& world, const lighting::Environment& environment,
                                    const spec::View& view, gpu::Counters& counters) {
  surfaces_.setView(options_.view.view);
  const FrameSettings& settings = options_.settings;
  const bool residual = prefiltered_environment_ && settings.residual;
  if (residual) {
    std::uint32_t order = 1;
    for (const streaming::ResidentGroup& group : world.residency().groups())
      order = std::max(order, group.order);
    order = std::min(order, settings.order);
    prefiltered_environment_->update(environment, static_cast<int>(order), settings.window, counters);
  }
  return surfaces_.prepare(world, diffuse_, view, counters, &local_shadows_,
                           residual ? &*prefiltered_environment_ : nullptr,
                           settings.neighborhoods && neighborhoods_.any() ? &neighborhoods_ : nullptr,
                           patch_bounces_.any() ? &patch_bounces_ : nullptr,
                           {.diffuse = settings.diffuse,
                            .glossy = settings.glossy,
                            .glossy_bands = settings.glossy_order,
                            .key_lights = key_shadows_.any()});
}

Result<void> Frame::raster(World& world, const lighting::Environment& environment, const spec::View& view) {
  gpu::PassTimers::Scope pass(timers_, "raster");
  pass.because(invalidation_log_.of(kPictureCauses));
  if (Result<void> done = prepareSurfaces(world, environment, view, pass.counters()); !done) return done;
  if (showsTransfer(options_.view.view)) return drawNumbers(world, view, pass.counters());
  data_view_.reset();
  local_shadows_.bind(view, options_.size);
  key_shadows_.bind(view, options_.size);
  clearPicture();
  surfaces_.drawOpaque(world, pass.counters());
  if (options_.view.view == SurfaceView::Final || options_.view.view == SurfaceView::Wireframe) {
    if (Result<void> done = proxy_lods_.prepare(world, environment, lit_scene_.lights,
                                                {.order = options_.settings.order,
                                                 .window = options_.settings.window,
                                                 .diffuse = options_.settings.diffuse},
                                                pass.counters());
        !done)
      return done;
    proxy_lods_.draw(view, pass.counters());
  }
  if (showsLight(options_.view.view)) {
    sky_.draw(environment, view.view_from_world, view.clip_from_view, options_.size.height, pass.counters());
    glDepthFunc(GL_LESS);
  }
  surfaces_.drawBlended(world, pass.counters());
  return {};
}

void Frame::toneMap() {
  gpu::PassTimers::Scope pass(timers_, "tone map");
  glBindFramebuffer(GL_FRAMEBUFFER, options_.to_window ? 0 : picture_target_.id());
  pass.because(invalidation_log_.of(kPictureCauses | Cause::Exposure));
  tone_mapper_.run(hdr_, options_.settings.exposure_ev, pass.counters(), !showsLight(options_.view.view));
}

spec::RgbaImage Frame::readLinear() const {
  std::vector<glm::vec4> texels(std::size_t{options_.size.width} * options_.size.height);
  glGetTextureImage(picture_.id(), 0, GL_RGBA, GL_FLOAT,
                    static_cast<GLsizei>(texels.size() * sizeof(glm::vec4)), texels.data());
  spec::RgbaImage image{.width = options_.size.width,
                        .height = options_.size.height,
                        .texels = flipped(texels, options_.size.width)};
  if (options_.output != Output::Linear) return image;  // depths of several samples a pixel
  std::vector<float> depths(texels.size());
  glGetTextureImage(depth_.id(), 0, GL_DEPTH_COMPONENT, GL_FLOAT,
                    static_cast<GLsizei>(depths.size() * sizeof(float)), depths.data());
  image.depths = linearDepths(flipped(depths, options_.size.width), clip_from_view_);
  return image;
}

spec::Rgba8Image Frame::readDisplay() const {
  std::vector<std::uint8_t> texels(std::size_t{options_.size.width} * options_.size.height * 4);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glGetTextureImage(picture_.id(), 0, GL_RGBA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(texels.size()),
                    texels.data());
  return {.width = options_.size.width,
          .height = options_.size.height,
          .texels = flipped(texels, std::size_t{options_.size.width} * 4)};
}

}  // namespace lambent::frame
