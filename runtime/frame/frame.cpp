#include "runtime/frame/frame.hpp"

#include <algorithm>

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

float meanRadiance(const lighting::Environment& environment) {
  constexpr float kMeanOfBandZero = 0.28209479f;  // y_00
  const glm::vec3 mean = kMeanOfBandZero * environment.light().c[0];
  return std::max({mean.r, mean.g, mean.b, 0.0f});
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
  if (options_.to_window) return;
  picture_ = gpu::Texture(
      "picture",
      {.format = linear ? GLenum{GL_RGBA32F} : GLenum{GL_RGBA8}, .width = size.width, .height = size.height});
  picture_target_ = gpu::Framebuffer("picture", picture_, nullptr);
}

Result<void> Frame::render(World& world, const lighting::Environment& environment, const spec::View& view) {
  timers_.beginFrame();
  if (Result<void> done = step(world, environment, options_.captures_per_step); !done) return done;
  // cubes of the lights that stand among surfaces
  if (Result<void> done = castShadows(world); !done) return done;
  // the sky as rough mirrors show it
  if (Result<void> done = reflectSky(world, environment); !done) return done;
  // surfaces, sky, blended surfaces: linear radiance
  if (Result<void> done = raster(world, environment, view); !done) return done;
  // what volumes scatter and let through
  if (Result<void> done = marchVolumes(world, view); !done) return done;
  // exposure, tone curve, sRGB; negative pixels are counted and clamped here
  toneMap();
  return {};
}

Result<std::uint32_t> Frame::rest(World& world, const lighting::Environment& environment) {
  for (std::uint32_t steps = 0; steps < kMaxRestSteps; ++steps) {
    if (atRest(world)) return steps;
    timers_.beginFrame();
    constexpr std::size_t kAll = ~std::size_t{0};  // nobody waits for the next picture
    if (Result<void> done = step(world, environment, kAll); !done) return failAgain(done.error());
  }
  return kMaxRestSteps;
}

bool Frame::atRest(const World& world) const {
  return world.loaded() && (!incident_ || incident_->atRest()) && neighborhoods_.settled();
}

Result<void> Frame::step(World& world, const lighting::Environment& environment, std::size_t max_captures) {
  counts_ = {};
  // what has arrived goes to the GPU, within the budget
  if (Result<void> done = upload(world); !done) return done;
  // where nodes and rigid groups stand
  transforms(world);
  // what arrives at each light sample, windowed and turned into its group's frame
  if (Result<void> done = light(world, environment); !done) return done;
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
  return world.upload(options_.upload_budget_bytes, pass.counters());
}

void Frame::transforms(World& world) {
  gpu::PassTimers::Scope pass(timers_, "transforms");
  world.updateTransforms();
}

Result<void> Frame::prepareSampling(World& world, const lighting::Environment& environment,
                                    gpu::Counters& counters) {
  if (!incident_ && !lit_scene_.needsSampling()) return {};
  lighting::CaptureOptions options = options_.capture;
  if (options.order == 0) {
    for (const streaming::ResidentGroup& group : world.residency().groups())
      options.order = std::max(options.order, static_cast<int>(group.order));
  }
  if (!incident_ || options.order != capture_order_) {
    auto made = lighting::IncidentLight::create(options, environment);
    if (!made) return failAgain(made.error());
    incident_ = std::move(*made);
    capture_order_ = options.order;
    proxies_seen_ = 0;
  }
  if (proxies_seen_ != world.residency().proxiesVersion()) {
    proxies_seen_ = world.residency().proxiesVersion();
    incident_->captures().setProxies(proxiesOf(world.residency()), counters);
  }
  return {};
}

Result<void> Frame::light(World& world, const lighting::Environment& environment) {
  gpu::PassTimers::Scope pass(timers_, "light");
  lit_scene_ = gatherLitScene(world, meanRadiance(environment));
  if (options_.neighborhoods) neighborhoods_.chooseCarriers(world, lit_scene_);
  if (Result<void> done = prepareSampling(world, environment, pass.counters()); !done) return done;
  if (incident_) {
    incident_->update(environment, lit_scene_.groups, lit_scene_.lights, options_.wait_for_captures);
    counts_.incident = incident_->counts();
  }
  std::vector<lighting::GroupPlace> places;
  for (std::size_t g = 0; g < world.residency().groups().size(); ++g) {
    const streaming::ResidentGroup& group = world.residency().groups()[g];
    lighting::GroupPlace place{
        .world_from_group = world.rotationOf(g), .order = group.order, .lamps = lit_scene_.lamps[g]};
    if (incident_)
      place.incident = incident_->incidentOf(g);
    else
      place.incident.resize(group.light_samples.size());
    places.push_back(std::move(place));
  }
  group_lights_.update(environment, options_.window, places, pass.counters());
  counts_.groups = static_cast<std::uint32_t>(places.size());
  counts_.bodies = static_cast<std::uint32_t>(lit_scene_.bodies.size());
  counts_.local_lights = static_cast<std::uint32_t>(lit_scene_.lights.size());
  counts_.near_lights = static_cast<std::uint32_t>(lit_scene_.near_lights.size());
  counts_.near_lights_left_out = lit_scene_.near_left_out;
  counts_.light_samples_written = group_lights_.renewedSamples();
  return {};
}

Result<void> Frame::capture(World& world, const lighting::Environment& environment,
                            std::size_t max_captures) {
  gpu::PassTimers::Scope pass(timers_, "capture");
  if (!incident_) return {};
  std::vector<std::uint64_t> shaded;
  for (std::size_t g = 0; g < world.residency().groups().size(); ++g)
    shaded.push_back(diffuse_.versionOf(g) + glossy_.versionOf(g));
  if (Result<void> done = proxies_.shade(world.residency(), group_lights_, shaded, pass.counters()); !done)
    return done;
  proxy_radiance_.resize(lit_scene_.groups.size());
  for (std::size_t g = 0; g < lit_scene_.groups.size(); ++g) {
    ProxyRadiance& radiance = proxy_radiance_[g];
    if (radiance.version != proxies_.versionOf(g)) {
      radiance.version = proxies_.versionOf(g);
      // Shaded for another reason than light or a turn: all of it may be different.
      const bool by_light = group_lights_.versionOf(g) != radiance.light;
      radiance.light = group_lights_.versionOf(g);
      radiance.drift += by_light ? double{group_lights_.changeOf(g)} : 1.0;
    }
    if (const std::uint32_t body = lit_scene_.groups[g].body; body != lighting::CapturePoint::kNoBody)
      lit_scene_.bodies[body].radiance_drift = radiance.drift;
  }
  Result<void> done = incident_->capture(environment, lit_scene_.groups, lit_scene_.bodies, lit_scene_.lights,
                                         proxies_.radiance(), max_captures, pass.counters());
  counts_.incident.captured = incident_->counts().captured;
  counts_.incident.waiting = incident_->counts().waiting;
  if (counts_.incident.captured > 0) counts_.captured = incident_->captures().load();
  return done;
}

Result<void> Frame::shade(World& world) {
  gpu::PassTimers::Scope pass(timers_, "shade");
  Result<void> done = diffuse_.shade(world.residency(), group_lights_, options_.transfer, pass.counters());
  counts_.cells_shaded = diffuse_.shadedLast().cells;
  counts_.draws_shaded = diffuse_.shadedLast().draws;
  return done;
}

Result<void> Frame::shadeGlossy(World& world) {
  const auto& cells = world.residency().cells();
  if (std::none_of(cells.begin(), cells.end(), [](const auto& cell) { return cell.matrices(); })) return {};
  gpu::PassTimers::Scope pass(timers_, "glossy");
  Result<void> done = glossy_.shade(world.residency(), group_lights_, options_.transfer, pass.counters(),
                                    options_.neighborhoods);
  counts_.cells_shaded += glossy_.cellsShadedLast();
  return done;
}

Result<void> Frame::shadeVolumes(World& world) {
  counts_.volumes = static_cast<std::uint32_t>(world.residency().volumes().size());
  if (counts_.volumes == 0) return {};
  gpu::PassTimers::Scope pass(timers_, "volume");
  Result<void> done =
      volume_.shade(world.residency(), group_lights_, diffuse_, glossy_, options_.transfer, pass.counters());
  counts_.volumes_shaded = volume_.shadedLast().volumes;
  counts_.volume_slabs_written = volume_.shadedLast().slabs;
  return done;
}

Result<void> Frame::marchVolumes(World& world, const spec::View& view) {
  const auto& volumes = world.residency().volumes();
  if (volumes.empty()) return {};
  gpu::PassTimers::Scope pass(timers_, "march");
  if (!march_) {
    // Pictures that are compared take half the steps, all at their places.
    const bool linear = options_.output == Output::Linear;
    march_.emplace(effects::volume::MarchOptions{.step_voxels = linear ? 0.5f : 1.0f, .jitter = !linear});
  }
  if (!hdr_color_target_) hdr_color_target_ = gpu::Framebuffer("hdr color", hdr_, nullptr);
  std::vector<effects::volume::PlacedVolume> placed;
  for (std::uint32_t v = 0; v < volumes.size(); ++v)
    placed.push_back({v, world.worldFromGroup(volumes[v].group)});
  Result<void> done = march_->draw(world.residency(), volume_, placed, view,
                                   {hdr_color_target_, depth_, options_.size}, pass.counters());
  counts_.volumes_drawn = march_->drawnLast();
  return done;
}

Result<void> Frame::shadeNeighborhoods(World& world) {
  if (!neighborhoods_.any()) return {};
  gpu::PassTimers::Scope pass(timers_, "neighborhood");
  Result<void> done =
      neighborhoods_.update(world, group_lights_, glossy_, options_.transfer, pass.counters());
  counts_.neighborhoods = neighborhoods_.counts();
  return done;
}

Result<void> Frame::castShadows(World& world) {
  gpu::PassTimers::Scope pass(timers_, "shadows");
  Result<void> done =
      near_lights_.update(world, lit_scene_.near_lights, lit_scene_.near_masks, pass.counters());
  counts_.shadow_cubes_drawn = near_lights_.cubesDrawn();
  return done;
}

Result<void> Frame::reflectSky(const World& world, const lighting::Environment& environment) {
  if (!options_.residual || !glossy_.any() || reflected_sky_) return {};
  if (std::ranges::none_of(world.residency().groups(),
                           [](const streaming::ResidentGroup& group) { return group.glossy_outputs > 0; }))
    return {};  // matrices of neighborhoods or volumes alone
  gpu::PassTimers::Scope pass(timers_, "residual");
  Result<lighting::ReflectedSky> made = lighting::ReflectedSky::make(environment, sky_, pass.counters());
  if (!made) return failAgain(made.error());
  reflected_sky_ = std::move(*made);
  return {};
}

Result<void> Frame::raster(World& world, const lighting::Environment& environment, const spec::View& view) {
  gpu::PassTimers::Scope pass(timers_, "raster");
  if (reflected_sky_) {
    std::uint32_t order = 1;
    for (const streaming::ResidentGroup& group : world.residency().groups())
      order = std::max(order, group.order);
    reflected_sky_->update(environment, static_cast<int>(order), options_.window, pass.counters());
  }
  if (Result<void> done = surfaces_.prepare(world, diffuse_, view, pass.counters(), &near_lights_,
                                            reflected_sky_ ? &*reflected_sky_ : nullptr,
                                            neighborhoods_.any() ? &neighborhoods_ : nullptr);
      !done)
    return done;
  near_lights_.bind(view, options_.size);
  glBindFramebuffer(GL_FRAMEBUFFER, hdr_target_.id());
  glViewport(0, 0, static_cast<GLsizei>(options_.size.width), static_cast<GLsizei>(options_.size.height));
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  constexpr float kNothing[] = {0.0f, 0.0f, 0.0f, 0.0f}, kFar = 1.0f;
  glClearNamedFramebufferfv(hdr_target_.id(), GL_COLOR, 0, kNothing);
  glClearNamedFramebufferfv(hdr_target_.id(), GL_DEPTH, 0, &kFar);
  surfaces_.drawOpaque(world, pass.counters());
  sky_.draw(environment, view.view_from_world, view.clip_from_view, options_.size.height, pass.counters());
  glDepthFunc(GL_LESS);
  surfaces_.drawBlended(world, pass.counters());
  return {};
}

void Frame::toneMap() {
  gpu::PassTimers::Scope pass(timers_, "tone map");
  glBindFramebuffer(GL_FRAMEBUFFER, options_.to_window ? 0 : picture_target_.id());
  tone_mapper_.run(hdr_, options_.exposure_ev, pass.counters());
}

spec::RgbaImage Frame::readLinear() const {
  std::vector<glm::vec4> texels(std::size_t{options_.size.width} * options_.size.height);
  glGetTextureImage(picture_.id(), 0, GL_RGBA, GL_FLOAT,
                    static_cast<GLsizei>(texels.size() * sizeof(glm::vec4)), texels.data());
  return {.width = options_.size.width,
          .height = options_.size.height,
          .texels = flipped(texels, options_.size.width)};
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
