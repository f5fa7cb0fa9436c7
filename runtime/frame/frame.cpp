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

}  // namespace

Frame::Frame(const FrameOptions& options, lighting::Sky sky, Surfaces surfaces, ToneMapper tone_mapper)
    : options_(options),
      sky_(std::move(sky)),
      surfaces_(std::move(surfaces)),
      tone_mapper_(std::move(tone_mapper)) {
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
  if (options_.to_window) return;
  picture_ = gpu::Texture(
      "picture",
      {.format = linear ? GLenum{GL_RGBA32F} : GLenum{GL_RGBA8}, .width = size.width, .height = size.height});
  picture_target_ = gpu::Framebuffer("picture", picture_, nullptr);
}

Result<void> Frame::render(World& world, const lighting::Environment& environment, const spec::View& view) {
  timers_.beginFrame();
  // what has arrived goes to the GPU, within the budget
  if (Result<void> done = upload(world); !done) return done;
  // where nodes and rigid groups stand
  transforms(world);
  // the light, windowed and turned into each group's frame
  light(world, environment);
  // E/pi at every vertex whose light or transfer is new
  if (Result<void> done = shade(world); !done) return done;
  // surfaces, sky, blended surfaces: linear radiance
  raster(world, environment, view);
  // exposure, tone curve, sRGB; negative pixels are counted and clamped here
  toneMap();
  return {};
}

Result<void> Frame::upload(World& world) {
  gpu::PassTimers::Scope pass(timers_, "upload");
  return world.upload(options_.upload_budget_bytes, pass.counters());
}

void Frame::transforms(World& world) {
  gpu::PassTimers::Scope pass(timers_, "transforms");
  world.updateTransforms();
}

void Frame::light(const World& world, const lighting::Environment& environment) {
  gpu::PassTimers::Scope pass(timers_, "light");
  group_lights_.update(environment, options_.window, world.groupPlaces(), pass.counters());
}

Result<void> Frame::shade(World& world) {
  gpu::PassTimers::Scope pass(timers_, "shade");
  return diffuse_.shade(world.residency(), group_lights_, options_.transfer, pass.counters());
}

void Frame::raster(World& world, const lighting::Environment& environment, const spec::View& view) {
  gpu::PassTimers::Scope pass(timers_, "raster");
  surfaces_.prepare(world, diffuse_, view, pass.counters());
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
