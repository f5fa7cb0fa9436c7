// Storage in pages: one arena holds one kind of data for all meshes, in storage buffers of at most 128 MiB
// each (what OpenGL 4.5 promises and llvmpipe allows), so that a pass binds a page and works on everything in
// it. FreeList is the bookkeeping of one page, without GL. Offsets and sizes are bytes, multiples of 16. An
// allocation lies within one page; one larger than a page is an error.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/gpu/staging.hpp"

namespace lambent::gpu {

// First fit by address; neighbours are merged on release.
class FreeList {
 public:
  explicit FreeList(std::uint64_t byte_count);
  std::optional<std::uint64_t> allocate(std::uint64_t byte_count);
  void release(std::uint64_t offset, std::uint64_t byte_count);
  std::uint64_t freeBytes() const { return free_bytes_; }
  std::uint64_t largestFree() const;

 private:
  std::map<std::uint64_t, std::uint64_t> free_;  // offset -> bytes
  std::uint64_t free_bytes_ = 0;
};

struct Allocation {
  std::uint32_t page = 0;
  std::uint64_t offset = 0, byte_count = 0;

  explicit operator bool() const { return byte_count != 0; }
  std::uint32_t word() const { return static_cast<std::uint32_t>(offset / 4); }  // as shaders address it
};

class Arena {
 public:
  static constexpr std::uint64_t kMaxPageBytes = std::uint64_t{128} << 20;
  static constexpr std::uint64_t kAlignment = 16;

  // Several arenas may share what their bytes come through.
  explicit Arena(std::string label, std::uint64_t page_bytes = kMaxPageBytes,
                 std::shared_ptr<Staging> staging = std::make_shared<Staging>());

  // Pages are made when first needed, as large as page_bytes. Takes at least one byte.
  Result<Allocation> allocate(std::uint64_t byte_count);
  // In a page where `room` bytes in one piece are free for what is to lie beside it.
  Result<Allocation> allocateWithRoom(std::uint64_t byte_count, std::uint64_t room);
  // None where the page has no room in one piece.
  std::optional<Allocation> allocateIn(std::uint32_t page, std::uint64_t byte_count);
  // Of pages that nothing lies in any more one stays until another one is made: what goes makes room for
  // what comes, and memory that is asked for anew is not had at once.
  void release(const Allocation& allocation);
  void write(const Allocation& allocation, std::uint64_t offset, std::span<const std::byte> bytes);
  void clear(const Allocation& allocation);                 // to zero
  void copy(const Allocation& from, const Allocation& to);  // on the GPU; `to` is as large

  // Lowers or raises the size of pages made from now on, up to kMaxPageBytes: a small scene needs no large
  // page.
  void setPageBytes(std::uint64_t page_bytes);
  const Buffer& page(std::uint32_t index) const { return pages_[index].buffer; }
  // Pages up to this one; some in between may be empty handles.
  std::uint32_t pageCount() const { return static_cast<std::uint32_t>(pages_.size()); }
  std::uint64_t bytesUsed() const { return bytes_used_; }
  std::uint64_t bytesReserved() const;  // of all pages

 private:
  struct Page {
    Buffer buffer;  // empty handle: the page has gone, its place is used again
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
