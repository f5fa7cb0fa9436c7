// Owns GL objects as move-only values with labels for debuggers. They use direct state access. Sizes are in
// bytes and texels. An object must not outlive its context. Creation fails only by a bug, which debug output
// reports, or for lack of memory, for which buffers and textures throw OutOfMemory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <ranges>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <epoxy/gl.h>

#include "runtime/base/result.hpp"

namespace lambent::gpu {

// Owns one GL name; `Traits::destroy` deletes it.
template <typename Traits>
class Handle {
 public:
  Handle() = default;
  explicit Handle(GLuint id) : id_(id) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  ~Handle() {
    if (id_ != 0) Traits::destroy(id_);
  }
  GLuint id() const { return id_; }
  explicit operator bool() const { return id_ != 0; }

 private:
  GLuint id_ = 0;
};

struct BufferTraits {
  static void destroy(GLuint id) { glDeleteBuffers(1, &id); }
};
struct TextureTraits {
  static void destroy(GLuint id) { glDeleteTextures(1, &id); }
};
struct SamplerTraits {
  static void destroy(GLuint id) { glDeleteSamplers(1, &id); }
};
struct FramebufferTraits {
  static void destroy(GLuint id) { glDeleteFramebuffers(1, &id); }
};
struct VertexArrayTraits {
  static void destroy(GLuint id) { glDeleteVertexArrays(1, &id); }
};

// Tells who writes into a buffer. A buffer that only the GPU writes (shaders, copies) stays in GPU memory.
enum class WrittenBy { Cpu, Gpu };

class Buffer : public Handle<BufferTraits> {
 public:
  Buffer() = default;
  Buffer(std::string_view label, std::size_t byte_count, WrittenBy writer = WrittenBy::Cpu);

  std::size_t byteCount() const { return byte_count_; }
  void writeBytes(std::size_t offset, std::span<const std::byte> bytes);  // only for WrittenBy::Cpu
  void readBytes(std::size_t offset, std::span<std::byte> bytes) const;   // waits for the GPU
  template <typename T>
  void write(std::size_t offset, std::span<const T> values) {
    writeBytes(offset, std::as_bytes(values));
  }
  template <typename T>
  void read(std::size_t offset, std::span<T> values) const {
    readBytes(offset, std::as_writable_bytes(values));
  }
  void bindStorage(GLuint binding) const { glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, id()); }

 private:
  std::size_t byte_count_ = 0;
};

// Counts commands and uploads, which are reported per pass and frame.
struct Counters {
  std::uint32_t dispatches = 0;
  std::uint32_t draws = 0;       // draw commands, including each one of a multi-draw
  std::uint32_t draw_calls = 0;  // GL calls that issued them
  std::uint64_t uploaded_bytes = 0;
};

// Owns a storage buffer that grows with its contents, for tables that the CPU maintains and the GPU reads.
class Table {
 public:
  explicit Table(std::string_view label) : label_(label) {}

  // Replaces the contents by those of a vector, an array or a span.
  void assign(const std::ranges::contiguous_range auto& values) {
    assignBytes(std::as_bytes(std::span(values)));
  }
  // Does the same, and counts it.
  void assign(const std::ranges::contiguous_range auto& values, Counters& counters) {
    assign(values);
    counters.uploaded_bytes += std::span(values).size_bytes();
  }
  template <typename T>
  void assignOne(const T& value) {
    assignBytes(std::as_bytes(std::span(&value, 1)));
  }
  // Uploads the records that differ from those of the last call, or all of them if their number does.
  template <typename Record>
  void update(const std::vector<Record>& records, Counters& counters) {
    updateBytes(std::as_bytes(std::span(records)), sizeof(Record), counters);
  }
  void assignBytes(std::span<const std::byte> bytes);
  void reserve(std::size_t byte_count);  // contents are lost when it grows
  void bindStorage(GLuint binding) const { buffer_.bindStorage(binding); }
  void bindUniform(GLuint binding) const { glBindBufferBase(GL_UNIFORM_BUFFER, binding, buffer_.id()); }
  Buffer& buffer() { return buffer_; }
  const Buffer& buffer() const { return buffer_; }

 private:
  void updateBytes(std::span<const std::byte> bytes, std::size_t record_bytes, Counters& counters);

  std::string_view label_;  // refers to a literal
  Buffer buffer_;
  std::vector<std::byte> updated_;  // contents after update()
};

struct TextureDesc {
  GLenum format = GL_RGBA8;
  std::uint32_t width = 1, height = 1;
  std::uint32_t levels = 1;
  std::uint32_t samples = 0;  // 0 for a single-sampled texture
  bool cube = false;
  std::uint32_t layers = 0;  // 0 if the texture is no array; an array of cubes has six images per layer
  std::uint32_t depth = 0;   // 0 if the texture is not three-dimensional
};

class Texture : public Handle<TextureTraits> {
 public:
  Texture() = default;
  Texture(std::string_view label, const TextureDesc& desc);
  // Returns a texture that shares the storage of `other`, a two-dimensional texture with or without samples,
  // which may belong to another program's code. Fails, naming `label`, if it is none, or if its storage may
  // change.
  static Result<Texture> sharing(std::string_view label, GLuint other);
  const TextureDesc& desc() const { return desc_; }
  // Binds it with its own sampling. Bind another sampler afterwards.
  void bind(GLuint unit) const {
    glBindTextureUnit(unit, id());
    glBindSampler(unit, 0);
  }
  // Makes samplers interpolate between texels and repeat the last ones beyond the edges.
  void interpolate(GLint min_filter = GL_LINEAR) const;

 private:
  Texture(GLuint id, const TextureDesc& desc) : Handle(id), desc_(desc) {}
  TextureDesc desc_;
};

class Sampler : public Handle<SamplerTraits> {
 public:
  Sampler() = default;
  // The parameters are GL constants, which glTF uses, too.
  Sampler(GLenum wrap_s, GLenum wrap_t, GLenum mag_filter, GLenum min_filter);
};

class Framebuffer : public Handle<FramebufferTraits> {
 public:
  Framebuffer() = default;
  // `depth` may be null.
  Framebuffer(std::string_view label, const Texture& color, const Texture* depth);
  // Attaches each layer of an array as a colour of its own.
  Framebuffer(std::string_view label, const Texture& layers);

  // Binds it for drawing, with the viewport over all of it.
  void bind() const;
  void clearColor(const std::array<float, 4>& color) const;
  // Clears the depth to the far end. Needs writing of depths to be on.
  void clearDepth() const;

 private:
  std::uint32_t width_ = 0, height_ = 0;
};

// Makes draws test and write depths.
void testDepth();

// Blends colours that are premultiplied by alpha, until glDisable(GL_BLEND).
void blendPremultiplied();

class VertexArray : public Handle<VertexArrayTraits> {
 public:
  VertexArray() = default;
  explicit VertexArray(std::string_view label);

  // Draws triangles whose vertices the shader makes of their number.
  void draw(std::size_t vertices, Counters& counters, std::size_t instances = 1) const;
};

// Gives the commands of a scope a name in debuggers.
class DebugGroup {
 public:
  explicit DebugGroup(std::string_view name) {
    glPushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 0, static_cast<GLsizei>(name.size()), name.data());
  }
  ~DebugGroup() { glPopDebugGroup(); }
  DebugGroup(const DebugGroup&) = delete;
  DebugGroup& operator=(const DebugGroup&) = delete;
};

// Says that the driver has no memory for a buffer or a texture. It is thrown, as std::bad_alloc is, since
// objects are made deep within passes. orOutOfMemory() makes an Error of it where results are returned.
class OutOfMemory : public std::runtime_error {
 public:
  // `what` names the object and its size.
  explicit OutOfMemory(const std::string& what) : std::runtime_error("has no memory for " + what) {}
  Error error() const {
    return {"GPU", what(), "close other programs, or give --max-memory or a smaller picture"};
  }
};

// Returns what the call returns, a Result, or an error if the GPU has no memory for it.
template <typename Call>
auto orOutOfMemory(Call&& call) -> decltype(call()) {
  try {
    return std::forward<Call>(call)();
  } catch (const OutOfMemory& failure) {
    return failAgain(failure.error());
  }
}

}  // namespace lambent::gpu
