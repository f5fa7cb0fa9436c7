// Bytes on their way to buffers that only the GPU writes: put into memory that both see, and copied by the
// GPU in the order of its commands. Drivers keep a buffer that the CPU writes to again and again where the
// CPU reaches it, and shaders then read it over the bus; and they move it there in the midst of a frame
// (docs/decisions/streaming.md, "GPU memory"). The memory is a ring, made with the first bytes; what is
// written waits for the GPU only where the ring is full of bytes that it has not copied yet. Must not outlive
// the context.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "runtime/gpu/objects.hpp"

namespace lambent::gpu {

class Staging {
 public:
  // What a frame brings at most (FrameOptions): then nothing waits for the GPU within one.
  static constexpr std::size_t kRingBytes = std::size_t{16} << 20;

  explicit Staging(std::size_t ring_bytes = kRingBytes) : part_bytes_(ring_bytes / kParts) {}
  ~Staging();
  Staging(const Staging&) = delete;
  Staging& operator=(const Staging&) = delete;

  // Any number of bytes, into [offset, offset + bytes.size()) of the buffer.
  void write(const Buffer& to, std::size_t offset, std::span<const std::byte> bytes);
  // To zero, by copies, too: a driver may clear buffers on the CPU, in memory that it first has to ask for.
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
  std::size_t part_ = 0, used_ = 0;      // the part that is being filled, and how many of its bytes are
  std::array<GLsync, kParts> copied_{};  // of a part: signalled once its copies are done; null: nothing there
};

}  // namespace lambent::gpu
