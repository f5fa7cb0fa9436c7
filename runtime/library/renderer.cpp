#include "lambent/renderer.hpp"

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <epoxy/gl.h>
#include <glm/matrix.hpp>

#include "runtime/frame/frame.hpp"
#include "runtime/gpu/context.hpp"
#include "runtime/library/convert.hpp"
#include "runtime/library/state.hpp"

namespace lambent::library {

namespace {

struct Switch {
  GLenum name;
  bool as_passes_need;
};
constexpr Switch kSwitches[] = {
    {GL_DEPTH_TEST, false},          {GL_BLEND, false},
    {GL_CULL_FACE, false},           {GL_SCISSOR_TEST, false},
    {GL_STENCIL_TEST, false},        {GL_FRAMEBUFFER_SRGB, false},
    {GL_MULTISAMPLE, true},          {GL_SAMPLE_MASK, false},
    {GL_SAMPLE_SHADING, false},      {GL_SAMPLE_COVERAGE, false},
    {GL_DEPTH_CLAMP, false},         {GL_SAMPLE_ALPHA_TO_COVERAGE, false},
    {GL_COLOR_LOGIC_OP, false},      {GL_SAMPLE_ALPHA_TO_ONE, false},
    {GL_POLYGON_OFFSET_FILL, false}, {GL_RASTERIZER_DISCARD, false},
    {GL_PRIMITIVE_RESTART, false},   {GL_PRIMITIVE_RESTART_FIXED_INDEX, false},
    {GL_PROGRAM_POINT_SIZE, false},  {GL_TEXTURE_CUBE_MAP_SEAMLESS, false},
    {GL_CLIP_DISTANCE0, false},      {GL_DITHER, false},
};
constexpr std::pair<GLenum, GLint> kPixelStore[] = {{GL_UNPACK_ALIGNMENT, 4},    {GL_UNPACK_ROW_LENGTH, 0},
                                                    {GL_UNPACK_SKIP_ROWS, 0},    {GL_UNPACK_SKIP_PIXELS, 0},
                                                    {GL_UNPACK_IMAGE_HEIGHT, 0}, {GL_UNPACK_SKIP_IMAGES, 0},
                                                    {GL_PACK_ALIGNMENT, 4},      {GL_PACK_ROW_LENGTH, 0},
                                                    {GL_PACK_SKIP_ROWS, 0},      {GL_PACK_SKIP_PIXELS, 0}};
constexpr std::pair<GLenum, GLenum> kBuffers[] = {  // target, and its binding
    {GL_PIXEL_UNPACK_BUFFER, GL_PIXEL_UNPACK_BUFFER_BINDING},
    {GL_PIXEL_PACK_BUFFER, GL_PIXEL_PACK_BUFFER_BINDING},
    {GL_ARRAY_BUFFER, GL_ARRAY_BUFFER_BINDING},
    {GL_DRAW_INDIRECT_BUFFER, GL_DRAW_INDIRECT_BUFFER_BINDING},
    {GL_DISPATCH_INDIRECT_BUFFER, GL_DISPATCH_INDIRECT_BUFFER_BINDING}};

GLint integer(GLenum name) {
  GLint value = 0;
  glGetIntegerv(name, &value);
  return value;
}

void set(GLenum name, bool on) {
  if (on)
    glEnable(name);
  else
    glDisable(name);
}

}  // namespace

HostState::HostState()
    : draw_framebuffer_(integer(GL_DRAW_FRAMEBUFFER_BINDING)),
      read_framebuffer_(integer(GL_READ_FRAMEBUFFER_BINDING)),
      vertex_array_(integer(GL_VERTEX_ARRAY_BINDING)),
      program_(integer(GL_CURRENT_PROGRAM)),
      active_texture_(integer(GL_ACTIVE_TEXTURE)),
      depth_func_(integer(GL_DEPTH_FUNC)),
      cull_face_(integer(GL_CULL_FACE_MODE)),
      front_face_(integer(GL_FRONT_FACE)),
      clip_origin_(integer(GL_CLIP_ORIGIN)),
      clip_depth_(integer(GL_CLIP_DEPTH_MODE)),
      blend_{integer(GL_BLEND_EQUATION_RGB), integer(GL_BLEND_EQUATION_ALPHA), integer(GL_BLEND_SRC_RGB),
             integer(GL_BLEND_DST_RGB),      integer(GL_BLEND_SRC_ALPHA),      integer(GL_BLEND_DST_ALPHA)} {
  for (const Switch& one : kSwitches) {
    switches_.emplace_back(one.name, glIsEnabled(one.name) == GL_TRUE);
    set(one.name, one.as_passes_need);
  }
  for (const auto& [name, value] : kPixelStore) {
    pixel_store_.emplace_back(name, integer(name));
    glPixelStorei(name, value);
  }
  for (const auto& [target, binding] : kBuffers) {
    buffers_.emplace_back(target, integer(binding));
    glBindBuffer(target, 0);
  }
  std::array<GLint, 2> polygon_modes{};  // compatibility contexts have one for each side
  glGetIntegerv(GL_POLYGON_MODE, polygon_modes.data());
  polygon_mode_ = polygon_modes[0];
  glGetIntegerv(GL_VIEWPORT, viewport_.data());
  glGetBooleanv(GL_COLOR_WRITEMASK, color_mask_.data());
  glGetBooleanv(GL_DEPTH_WRITEMASK, &depth_mask_);
  glGetDoublev(GL_DEPTH_RANGE, depth_range_.data());
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  glFrontFace(GL_CCW);
  glCullFace(GL_BACK);
  glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
  glBlendEquation(GL_FUNC_ADD);
  glBlendFunc(GL_ONE, GL_ZERO);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_LESS);
  glDepthRange(0.0, 1.0);
}

HostState::~HostState() {
  for (const auto& [name, on] : switches_) set(name, on);
  for (const auto& [name, value] : pixel_store_) glPixelStorei(name, value);
  glPolygonMode(GL_FRONT_AND_BACK, static_cast<GLenum>(polygon_mode_));
  glFrontFace(static_cast<GLenum>(front_face_));
  glCullFace(static_cast<GLenum>(cull_face_));
  glClipControl(static_cast<GLenum>(clip_origin_), static_cast<GLenum>(clip_depth_));
  glBlendEquationSeparate(static_cast<GLenum>(blend_[0]), static_cast<GLenum>(blend_[1]));
  glBlendFuncSeparate(static_cast<GLenum>(blend_[2]), static_cast<GLenum>(blend_[3]),
                      static_cast<GLenum>(blend_[4]), static_cast<GLenum>(blend_[5]));
  glColorMask(color_mask_[0], color_mask_[1], color_mask_[2], color_mask_[3]);
  glDepthMask(depth_mask_);
  glDepthFunc(static_cast<GLenum>(depth_func_));
  glDepthRange(depth_range_[0], depth_range_[1]);
  glViewport(viewport_[0], viewport_[1], viewport_[2], viewport_[3]);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(draw_framebuffer_));
  glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(read_framebuffer_));
  glUseProgram(static_cast<GLuint>(program_));
  glBindVertexArray(static_cast<GLuint>(vertex_array_));
  for (const auto& [target, buffer] : buffers_) glBindBuffer(target, static_cast<GLuint>(buffer));
  glActiveTexture(static_cast<GLenum>(active_texture_));
}

}  // namespace lambent::library

namespace lambent {

using library::failureOf;
using library::HostState;
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
  const HostState host;
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
  const HostState host;
  if (const Result<void> shared = state_->frame.share(target.color, target.depth); !shared)
    return failureOf(shared.error());
  scene.state_->environment.setMostKeys(state_->frame.settings().mostKeys());
  const Result<void> drawn = state_->frame.render(scene.state_->world, scene.state_->environment, view);
  if (!drawn) return failureOf(drawn.error());
  return {};
}

Expected<void> Renderer::settle(Scene& scene) {
  const HostState host;
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
