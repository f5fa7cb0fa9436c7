// Uploads bytes to buffers that only the GPU writes. The CPU writes them to mapped memory, and the GPU copies
// them in the order of its commands. Without this, drivers move a buffer that the CPU writes often to memory
// of the CPU, even within a frame, and shaders then read it over the bus (docs/design/streaming.md, "GPU
// memory"). The mapped memory is a ring that is made on first use. Writing waits for the GPU only if the ring
// is full of bytes that are not copied yet. The object must not outlive the context.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "runtime/gpu/objects.hpp"

namespace lambent::gpu {

class Staging {
 public:
  // This is the most that a frame uploads (FrameOptions), so nothing waits for the GPU within a frame.
  static constexpr std::size_t kRingBytes = std::size_t{16} << 20;

  explicit Staging(std::size_t ring_bytes = kRingBytes) : part_bytes_(ring_bytes / kParts) {}
  ~Staging();
  Staging(const Staging&) = delete;
  Staging& operator=(const Staging&) = delete;

  // Writes any number of bytes to [offset, offset + bytes.size()) of the buffer.
  void write(const Buffer& to, std::size_t offset, std::span<const std::byte> bytes);
  // Sets bytes to zero, by copies as well, because a driver may clear a buffer on the CPU in memory that it
  // must allocate first.
  void clear(const Buffer& to, std::size_t offset, std::size_t byte_count);

 private:
  static constexpr std::size_t kParts = 16;
  static constexpr std::size_t kZeroBytes = std::size_t{1} << 20;

  void make();
  void nextPart();

  std::size_t part_bytes_;
  Buffer zeros_;
  Handle<BufferTraits> ring_;
  std::byte* mapped_ = nullptr;
  std::size_t part_ = 0, used_ = 0;      // the part of the ring that is being filled, and its bytes in use
  std::array<GLsync, kParts> copied_{};  // signalled when a part's copies are done; null if it has none
};

}  // namespace lambent::gpu
