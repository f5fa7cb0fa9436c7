#include "runtime/gpu/objects.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace lambent::gpu {

namespace {

void setLabel(GLenum kind, GLuint id, std::string_view label) {
  glObjectLabel(kind, id, static_cast<GLsizei>(label.size()), label.data());
}

template <typename Create>
GLuint made(Create create) {
  GLuint id = 0;
  create(&id);
  return id;
}

}  // namespace

Buffer::Buffer(std::string_view label, std::size_t byte_count, WrittenBy writer)
    : Handle(made([](GLuint* id) { glCreateBuffers(1, id); })), byte_count_(byte_count) {
  assert(byte_count > 0);
  glNamedBufferStorage(id(), static_cast<GLsizeiptr>(byte_count), nullptr,
                       writer == WrittenBy::Cpu ? GL_DYNAMIC_STORAGE_BIT : 0);
  // The size tells it without glGetError, whose queue may belong to a program that uses the library.
  GLint64 stored = 0;
  glGetNamedBufferParameteri64v(id(), GL_BUFFER_SIZE, &stored);
  if (stored == 0) throw OutOfMemory(fmt::format("{}, {} bytes", label, byte_count));
  setLabel(GL_BUFFER, id(), label);
}

void Buffer::writeBytes(std::size_t offset, std::span<const std::byte> bytes) {
  assert(offset + bytes.size() <= byte_count_);
  if (bytes.empty()) return;
  glNamedBufferSubData(id(), static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(bytes.size()),
                       bytes.data());
}

void Buffer::readBytes(std::size_t offset, std::span<std::byte> bytes) const {
  assert(offset + bytes.size() <= byte_count_);
  if (bytes.empty()) return;
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glGetNamedBufferSubData(id(), static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(bytes.size()),
                          bytes.data());
}

void Table::reserve(std::size_t byte_count) {
  // GL cannot bind an empty buffer. Some spare room avoids new buffers while a scene streams in.
  if (buffer_.byteCount() < std::max<std::size_t>(byte_count, 16))
    buffer_ = Buffer(label_, std::max<std::size_t>(byte_count + byte_count / 2, 256));
}

void Table::assignBytes(std::span<const std::byte> bytes) {
  reserve(bytes.size());
  buffer_.writeBytes(0, bytes);
}

void Table::updateBytes(std::span<const std::byte> bytes, std::size_t record_bytes, Counters& counters) {
  const auto same = [&](std::size_t at) { return std::memcmp(&bytes[at], &updated_[at], record_bytes) == 0; };
  if (bytes.size() != updated_.size()) {
    assignBytes(bytes);
    counters.uploaded_bytes += bytes.size();
  } else {
    for (std::size_t first = 0; first < bytes.size(); first += record_bytes) {
      if (same(first)) continue;
      std::size_t end = first + record_bytes;
      while (end < bytes.size() && !same(end)) end += record_bytes;
      buffer_.writeBytes(first, bytes.subspan(first, end - first));
      counters.uploaded_bytes += end - first;
      first = end;
    }
  }
  updated_.assign(bytes.begin(), bytes.end());
}

Texture::Texture(std::string_view label, const TextureDesc& desc)
    : Handle(made([&](GLuint* id) {
        glCreateTextures(desc.cube && desc.layers > 0 ? GL_TEXTURE_CUBE_MAP_ARRAY
                         : desc.cube                  ? GL_TEXTURE_CUBE_MAP
                         : desc.depth > 0             ? GL_TEXTURE_3D
                         : desc.layers > 0            ? GL_TEXTURE_2D_ARRAY
                         : desc.samples > 0           ? GL_TEXTURE_2D_MULTISAMPLE
                                                      : GL_TEXTURE_2D,
                         1, id);
      })),
      desc_(desc) {
  const auto width = static_cast<GLsizei>(desc.width), height = static_cast<GLsizei>(desc.height);
  if (desc.samples > 0)
    glTextureStorage2DMultisample(id(), static_cast<GLsizei>(desc.samples), desc.format, width, height,
                                  GL_TRUE);
  else if (desc.depth > 0)
    glTextureStorage3D(id(), static_cast<GLsizei>(desc.levels), desc.format, width, height,
                       static_cast<GLsizei>(desc.depth));
  else if (desc.layers > 0)
    glTextureStorage3D(id(), static_cast<GLsizei>(desc.levels), desc.format, width, height,
                       static_cast<GLsizei>(desc.cube ? 6 * desc.layers : desc.layers));
  else
    glTextureStorage2D(id(), static_cast<GLsizei>(desc.levels), desc.format, width, height);
  GLint stored = GL_FALSE;
  glGetTextureParameteriv(id(), GL_TEXTURE_IMMUTABLE_FORMAT, &stored);
  if (stored == GL_FALSE)
    throw OutOfMemory(fmt::format("{}, {} x {} texels", label, desc.width, desc.height));
  setLabel(GL_TEXTURE, id(), label);
}

void Texture::interpolate(GLint min_filter) const {
  glTextureParameteri(id(), GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTextureParameteri(id(), GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glTextureParameteri(id(), GL_TEXTURE_WRAP_R, GL_CLAMP_TO_EDGE);
  glTextureParameteri(id(), GL_TEXTURE_MIN_FILTER, min_filter);
  glTextureParameteri(id(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
}

Result<Texture> Texture::sharing(std::string_view label, GLuint other) {
  const auto no = [&](std::string why) {
    return fail(std::string(label), std::move(why),
                "make it with glCreateTextures and glTextureStorage2D or glTextureStorage2DMultisample");
  };
  if (glIsTexture(other) == GL_FALSE) return no(std::to_string(other) + " is no texture");
  const auto parameter = [&](GLenum name) {
    GLint value = 0;
    glGetTextureParameteriv(other, name, &value);
    return value;
  };
  const auto target = static_cast<GLenum>(parameter(GL_TEXTURE_TARGET));
  if (target != GL_TEXTURE_2D && target != GL_TEXTURE_2D_MULTISAMPLE) return no("is not two-dimensional");
  if (parameter(GL_TEXTURE_IMMUTABLE_FORMAT) == 0) return no("has storage that may change");
  const auto ofLevel = [&](GLenum name) {
    GLint value = 0;
    glGetTextureLevelParameteriv(other, 0, name, &value);
    return static_cast<std::uint32_t>(value);
  };
  const TextureDesc desc{.format = ofLevel(GL_TEXTURE_INTERNAL_FORMAT),
                         .width = ofLevel(GL_TEXTURE_WIDTH),
                         .height = ofLevel(GL_TEXTURE_HEIGHT),
                         .samples = ofLevel(GL_TEXTURE_SAMPLES)};
  const GLuint id = made([](GLuint* name) { glGenTextures(1, name); });
  glTextureView(id, target, other, desc.format, 0, 1, 0, 1);
  setLabel(GL_TEXTURE, id, label);
  return Texture(id, desc);
}

Sampler::Sampler(GLenum wrap_s, GLenum wrap_t, GLenum mag_filter, GLenum min_filter)
    : Handle(made([](GLuint* id) { glCreateSamplers(1, id); })) {
  glSamplerParameteri(id(), GL_TEXTURE_WRAP_S, static_cast<GLint>(wrap_s));
  glSamplerParameteri(id(), GL_TEXTURE_WRAP_T, static_cast<GLint>(wrap_t));
  glSamplerParameteri(id(), GL_TEXTURE_MAG_FILTER, static_cast<GLint>(mag_filter));
  glSamplerParameteri(id(), GL_TEXTURE_MIN_FILTER, static_cast<GLint>(min_filter));
}

Framebuffer::Framebuffer(std::string_view label, const Texture& color, const Texture* depth)
    : Handle(made([](GLuint* id) { glCreateFramebuffers(1, id); })),
      width_(color.desc().width),
      height_(color.desc().height) {
  glNamedFramebufferTexture(id(), GL_COLOR_ATTACHMENT0, color.id(), 0);
  if (depth != nullptr) glNamedFramebufferTexture(id(), GL_DEPTH_ATTACHMENT, depth->id(), 0);
  setLabel(GL_FRAMEBUFFER, id(), label);
  assert(glCheckNamedFramebufferStatus(id(), GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE);
}

Framebuffer::Framebuffer(std::string_view label, const Texture& layers)
    : Handle(made([](GLuint* id) { glCreateFramebuffers(1, id); })),
      width_(layers.desc().width),
      height_(layers.desc().height) {
  std::vector<GLenum> colors;
  for (std::uint32_t i = 0; i < layers.desc().layers; ++i) {
    colors.push_back(GL_COLOR_ATTACHMENT0 + i);
    glNamedFramebufferTextureLayer(id(), colors.back(), layers.id(), 0, static_cast<GLint>(i));
  }
  glNamedFramebufferDrawBuffers(id(), static_cast<GLsizei>(colors.size()), colors.data());
  setLabel(GL_FRAMEBUFFER, id(), label);
  assert(glCheckNamedFramebufferStatus(id(), GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE);
}

void Framebuffer::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, id());
  glViewport(0, 0, static_cast<GLsizei>(width_), static_cast<GLsizei>(height_));
}

void Framebuffer::clearColor(const std::array<float, 4>& color) const {
  glClearNamedFramebufferfv(id(), GL_COLOR, 0, color.data());
}

void Framebuffer::clearDepth() const {
  constexpr float kFar = 1.0f;
  glClearNamedFramebufferfv(id(), GL_DEPTH, 0, &kFar);
}

void testDepth() {
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
}

void blendPremultiplied() {
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
}

VertexArray::VertexArray(std::string_view label)
    : Handle(made([](GLuint* id) { glCreateVertexArrays(1, id); })) {
  setLabel(GL_VERTEX_ARRAY, id(), label);
}

void VertexArray::draw(std::size_t vertices, Counters& counters, std::size_t instances) const {
  glBindVertexArray(id());
  glDrawArraysInstanced(GL_TRIANGLES, 0, static_cast<GLsizei>(vertices), static_cast<GLsizei>(instances));
  counters.draws += static_cast<std::uint32_t>(instances);
  ++counters.draw_calls;
}

}  // namespace lambent::gpu
