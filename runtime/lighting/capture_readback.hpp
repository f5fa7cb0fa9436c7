// Reads results back from the GPU without stalling: they are copied into mapped memory, and a fence tells
// when they have arrived. Sizes are in bytes. A Readback must not outlive its context.
#pragma once

#include <cstddef>
#include <cstring>
#include <span>
#include <utility>

#include "runtime/gpu/objects.hpp"

namespace lambent::lighting::capture {

class Readback {
 public:
  Readback() = default;
  Readback(Readback&& other) noexcept { *this = std::move(other); }
  Readback& operator=(Readback&& other) noexcept {
    std::swap(buffer_, other.buffer_);
    std::swap(mapped_, other.mapped_);
    std::swap(capacity_, other.capacity_);
    std::swap(used_, other.used_);
    std::swap(fence_, other.fence_);
    return *this;
  }
  ~Readback() { forgetFence(); }

  // Reserves room for this many bytes and discards earlier copies.
  void start(std::size_t byte_count) {
    forgetFence();
    used_ = 0;
    if (byte_count <= capacity_) return;
    capacity_ = byte_count + byte_count / 2;
    GLuint id = 0;
    glCreateBuffers(1, &id);
    buffer_ = gpu::Handle<gpu::BufferTraits>(id);
    constexpr GLbitfield kAccess = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    glNamedBufferStorage(id, static_cast<GLsizeiptr>(capacity_), nullptr, kAccess | GL_CLIENT_STORAGE_BIT);
    mapped_ = static_cast<const std::byte*>(
        glMapNamedBufferRange(id, 0, static_cast<GLsizeiptr>(capacity_), kAccess));
  }
  // Copies from the start of the buffer and returns the offset at which read() will find the bytes.
  std::size_t copy(const gpu::Buffer& from, std::size_t byte_count) {
    const std::size_t at = used_;
    if (byte_count > 0)
      glCopyNamedBufferSubData(from.id(), buffer_.id(), 0, static_cast<GLintptr>(at),
                               static_cast<GLsizeiptr>(byte_count));
    used_ += byte_count;
    return at;
  }
  void finish() { fence_ = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0); }

  // Returns whether everything has arrived. This is true if `wait` is set or if nothing was asked for.
  bool arrived(bool wait) {
    if (fence_ == nullptr) return true;
    const GLenum state = glClientWaitSync(fence_, GL_SYNC_FLUSH_COMMANDS_BIT, wait ? GL_TIMEOUT_IGNORED : 0);
    if (state == GL_TIMEOUT_EXPIRED) return false;
    forgetFence();
    return true;
  }
  template <typename T>
  void read(std::size_t offset, std::span<T> values) const {
    if (!values.empty()) std::memcpy(values.data(), mapped_ + offset, values.size_bytes());
  }

 private:
  void forgetFence() {
    if (fence_ != nullptr) glDeleteSync(fence_);
    fence_ = nullptr;
  }

  gpu::Handle<gpu::BufferTraits> buffer_;
  const std::byte* mapped_ = nullptr;
  std::size_t capacity_ = 0, used_ = 0;
  GLsync fence_ = nullptr;
};

}  // namespace lambent::lighting::capture
