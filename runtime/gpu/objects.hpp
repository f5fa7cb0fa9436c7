// GL objects as values: move-only, named for debuggers, made and changed by direct state access, deleted with
// their last owner. Sizes are bytes and texels. They must not outlive their context; making one cannot fail
// except by a bug or for want of memory, which debug output reports.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>

#include <epoxy/gl.h>

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

// Who writes into a buffer. What only the GPU writes (shaders, copies) stays in its own memory.
enum class WrittenBy { Cpu, Gpu };

class Buffer : public Handle<BufferTraits> {
 public:
  Buffer() = default;
  Buffer(std::string_view label, std::size_t byte_count, WrittenBy writer = WrittenBy::Cpu);

  std::size_t byteCount() const { return byte_count_; }
  void writeBytes(std::size_t offset, std::span<const std::byte> bytes);  // WrittenBy::Cpu alone
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

// A storage buffer that is as large as what is put into it: tables that the CPU keeps and the GPU reads.
class Table {
 public:
  explicit Table(std::string_view label) : label_(label) {}

  template <typename T>
  void assign(std::span<const T> values) {
    assignBytes(std::as_bytes(values));
  }
  void assignBytes(std::span<const std::byte> bytes);
  void reserve(std::size_t byte_count);  // contents are lost when it grows
  void bindStorage(GLuint binding) const { buffer_.bindStorage(binding); }
  Buffer& buffer() { return buffer_; }
  const Buffer& buffer() const { return buffer_; }

 private:
  std::string_view label_;  // a literal
  Buffer buffer_;
};

struct TextureDesc {
  GLenum format = GL_RGBA8;
  std::uint32_t width = 1, height = 1;
  std::uint32_t levels = 1;
  std::uint32_t samples = 0;  // 0: single-sampled
  bool cube = false;
  std::uint32_t layers = 0;  // 0: no array
  std::uint32_t depth = 0;   // 0: not three-dimensional
};

class Texture : public Handle<TextureTraits> {
 public:
  Texture() = default;
  Texture(std::string_view label, const TextureDesc& desc);
  const TextureDesc& desc() const { return desc_; }
  void bind(GLuint unit) const { glBindTextureUnit(unit, id()); }

 private:
  TextureDesc desc_;
};

class Sampler : public Handle<SamplerTraits> {
 public:
  Sampler() = default;
  // glTF's sampler enums are GL's.
  Sampler(GLenum wrap_s, GLenum wrap_t, GLenum mag_filter, GLenum min_filter);
};

class Framebuffer : public Handle<FramebufferTraits> {
 public:
  Framebuffer() = default;
  // `depth` may be null.
  Framebuffer(std::string_view label, const Texture& color, const Texture* depth);
  // The layers of an array, each a colour of its own.
  Framebuffer(std::string_view label, const Texture& layers);
};

class VertexArray : public Handle<VertexArrayTraits> {
 public:
  VertexArray() = default;
  explicit VertexArray(std::string_view label);
};

// A named stretch of commands, as debuggers show it.
class DebugGroup {
 public:
  explicit DebugGroup(std::string_view name) {
    glPushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 0, static_cast<GLsizei>(name.size()), name.data());
  }
  ~DebugGroup() { glPopDebugGroup(); }
  DebugGroup(const DebugGroup&) = delete;
  DebugGroup& operator=(const DebugGroup&) = delete;
};

// What was given to the GPU: counted where it is issued, shown per pass and frame.
struct Counters {
  std::uint32_t dispatches = 0;
  std::uint32_t draws = 0;       // draw commands, each one of a multi-draw counted
  std::uint32_t draw_calls = 0;  // calls that issued them
  std::uint64_t uploaded_bytes = 0;
};

}  // namespace lambent::gpu
