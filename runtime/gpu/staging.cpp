#include "runtime/gpu/staging.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "runtime/gpu/out_of_memory.hpp"

namespace lambent::gpu {

Staging::~Staging() {
  for (const GLsync fence : copied_)
    if (fence != nullptr) glDeleteSync(fence);
}

void Staging::make() {
  GLuint id = 0;
  glCreateBuffers(1, &id);
  ring_ = Handle<BufferTraits>(id);
  const auto byte_count = static_cast<GLsizeiptr>(kParts * part_bytes_);
  constexpr GLbitfield kAccess = GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
  glNamedBufferStorage(id, byte_count, nullptr, kAccess | GL_CLIENT_STORAGE_BIT);
  mapped_ = static_cast<std::byte*>(glMapNamedBufferRange(id, 0, byte_count, kAccess));
  if (mapped_ == nullptr) {
    ring_ = {};
    throw OutOfMemory(fmt::format("staging, {} bytes", byte_count));
  }
}

// Moves on to the next part of the ring, and waits until its earlier copies are done.
void Staging::nextPart() {
  copied_[part_] = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  part_ = (part_ + 1) % kParts;
  used_ = 0;
  if (const GLsync before = std::exchange(copied_[part_], nullptr)) {
    glClientWaitSync(before, GL_SYNC_FLUSH_COMMANDS_BIT, GL_TIMEOUT_IGNORED);
    glDeleteSync(before);
  }
}

void Staging::write(const Buffer& to, std::size_t offset, std::span<const std::byte> bytes) {
  assert(offset + bytes.size() <= to.byteCount());
  if (!bytes.empty() && !ring_) make();
  while (!bytes.empty()) {
    if (used_ == part_bytes_) nextPart();
    const std::size_t count = std::min(bytes.size(), part_bytes_ - used_), at = part_ * part_bytes_ + used_;
    std::memcpy(mapped_ + at, bytes.data(), count);
    glCopyNamedBufferSubData(ring_.id(), to.id(), static_cast<GLintptr>(at), static_cast<GLintptr>(offset),
                             static_cast<GLsizeiptr>(count));
    used_ += count;
    offset += count;
    bytes = bytes.subspan(count);
  }
}

void Staging::clear(const Buffer& to, std::size_t offset, std::size_t byte_count) {
  assert(offset + byte_count <= to.byteCount());
  if (!zeros_) {
    zeros_ = Buffer("zeros", kZeroBytes);
    zeros_.writeBytes(0, std::vector<std::byte>(kZeroBytes));
  }
  while (byte_count > 0) {
    const std::size_t count = std::min(byte_count, kZeroBytes);
    glCopyNamedBufferSubData(zeros_.id(), to.id(), 0, static_cast<GLintptr>(offset),
                             static_cast<GLsizeiptr>(count));
    offset += count;
    byte_count -= count;
  }
}

}  // namespace lambent::gpu
