// An Arena allocates GPU memory in pages. One arena holds one kind of data for all meshes, so a pass binds a
// page and processes everything in it. Pages are storage buffers of at most 128 MiB, which OpenGL 4.5
// guarantees and llvmpipe supports. Offsets and sizes are in bytes and multiples of 16. An allocation lies
// within one page; one larger than the largest page is an error. FreeList manages one page and does not use
// GL.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/gpu/objects.hpp"

namespace lambent::gpu {

// Uploads bytes to buffers that only the GPU writes. The CPU writes them to mapped memory, and the GPU copies
// them in the order of its commands. Without this, drivers move a buffer that the CPU writes often to memory
// of the CPU, even within a frame, and shaders then read it over the bus (docs/design/streaming.md, "GPU
// memory"). The mapped memory is a ring that is made on first use. Writing waits for the GPU only if the ring
// is full of bytes that are not copied yet. The object must not outlive the context.
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

// Allocates the first free range that fits, by address, and merges adjacent ranges on release.
class FreeList {
 public:
  explicit FreeList(std::uint64_t byte_count);
  std::optional<std::uint64_t> allocate(std::uint64_t byte_count);
  void release(std::uint64_t offset, std::uint64_t byte_count);
  std::uint64_t freeBytes() const { return free_bytes_; }
  std::uint64_t largestFree() const;

 private:
  std::map<std::uint64_t, std::uint64_t> free_;  // sizes of free ranges by offset
  std::uint64_t free_bytes_ = 0;
};

struct Allocation {
  std::uint32_t page = 0;
  std::uint64_t offset = 0, byte_count = 0;

  explicit operator bool() const { return byte_count != 0; }
  // Returns the offset in 32-bit words, as shaders address it.
  std::uint32_t word() const { return static_cast<std::uint32_t>(offset / 4); }
};

class Arena {
 public:
  static constexpr std::uint64_t kMaxPageBytes = std::uint64_t{128} << 20;
  static constexpr std::uint64_t kAlignment = 16;

  // Several arenas may share the staging through which they upload.
  explicit Arena(std::string label, std::uint64_t page_bytes = kMaxPageBytes,
                 std::shared_ptr<Staging> staging = std::make_shared<Staging>());

  // Allocates at least one byte in a page that has a free range of at least `room` bytes, which include
  // byte_count, so that related data can be allocated in the same page afterwards. Makes a page of page_bytes
  // (or more, if needed) if no page has room.
  Result<Allocation> allocate(std::uint64_t byte_count, std::uint64_t room = 0);
  // Returns nothing if the page has no free range that is large enough.
  std::optional<Allocation> allocateIn(std::uint32_t page, std::uint64_t byte_count);
  // Releases the memory. One empty page is kept until another page is made, because new data often replace
  // old data, and drivers do not provide new memory at once.
  void release(const Allocation& allocation);
  void write(const Allocation& allocation, std::uint64_t offset, std::span<const std::byte> bytes);
  void clear(const Allocation& allocation);                 // sets all bytes to zero
  void copy(const Allocation& from, const Allocation& to);  // copies on the GPU; `to` is at least as large

  // Sets the size of new pages, up to kMaxPageBytes. A small scene needs no large pages.
  void setPageBytes(std::uint64_t page_bytes);
  const Buffer& page(std::uint32_t index) const { return pages_[index].buffer; }
  // Returns the number of pages. Some of them may be empty handles.
  std::uint32_t pageCount() const { return static_cast<std::uint32_t>(pages_.size()); }
  std::uint64_t bytesUsed() const { return bytes_used_; }

 private:
  struct Page {
    Buffer buffer;  // an empty handle if the page was deleted; a new page may reuse its index
    FreeList list{0};
  };
  static bool isEmpty(const Page& page);
  std::uint32_t makePage(std::uint64_t byte_count);

  std::string label_;
  std::uint64_t page_bytes_;
  std::shared_ptr<Staging> staging_;
  std::uint64_t bytes_used_ = 0;
  std::vector<Page> pages_;
};

}  // namespace lambent::gpu
