#include "runtime/gpu/arena.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "runtime/gpu/objects.hpp"

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

namespace {

std::uint64_t alignUp(std::uint64_t byte_count) {
  return (byte_count + Arena::kAlignment - 1) / Arena::kAlignment * Arena::kAlignment;
}

}  // namespace

FreeList::FreeList(std::uint64_t byte_count) : free_bytes_(byte_count) {
  if (byte_count > 0) free_.emplace(0, byte_count);
}

std::optional<std::uint64_t> FreeList::allocate(std::uint64_t byte_count) {
  assert(byte_count > 0);
  const auto fit =
      std::find_if(free_.begin(), free_.end(), [&](const auto& run) { return run.second >= byte_count; });
  if (fit == free_.end()) return {};
  const auto [offset, available] = *fit;
  free_.erase(fit);
  if (available > byte_count) free_.emplace(offset + byte_count, available - byte_count);
  free_bytes_ -= byte_count;
  return offset;
}

void FreeList::release(std::uint64_t offset, std::uint64_t byte_count) {
  auto [run, inserted] = free_.emplace(offset, byte_count);
  assert(inserted);
  free_bytes_ += byte_count;
  if (const auto next = std::next(run); next != free_.end()) {
    assert(offset + byte_count <= next->first);
    if (offset + byte_count == next->first) {
      run->second += next->second;
      free_.erase(next);
    }
  }
  if (run != free_.begin()) {
    const auto previous = std::prev(run);
    assert(previous->first + previous->second <= offset);
    if (previous->first + previous->second == offset) {
      previous->second += run->second;
      free_.erase(run);
    }
  }
}

std::uint64_t FreeList::largestFree() const {
  std::uint64_t largest = 0;
  for (const auto& [offset, byte_count] : free_) largest = std::max(largest, byte_count);
  return largest;
}

bool Arena::isEmpty(const Page& page) {
  return page.buffer && page.list.freeBytes() == page.buffer.byteCount();
}

Arena::Arena(std::string label, std::uint64_t page_bytes, std::shared_ptr<Staging> staging)
    : label_(std::move(label)), staging_(std::move(staging)) {
  setPageBytes(page_bytes);
}

void Arena::setPageBytes(std::uint64_t page_bytes) {
  page_bytes_ = std::clamp(alignUp(page_bytes), kAlignment, kMaxPageBytes);
}

std::optional<Allocation> Arena::allocateIn(std::uint32_t page, std::uint64_t byte_count) {
  const std::uint64_t aligned = alignUp(std::max<std::uint64_t>(byte_count, 1));
  const auto offset = pages_[page].list.allocate(aligned);
  if (!offset) return {};
  bytes_used_ += aligned;
  return Allocation{.page = page, .offset = *offset, .byte_count = aligned};
}

std::uint32_t Arena::makePage(std::uint64_t byte_count) {
  for (Page& page : pages_)
    if (isEmpty(page)) page = {};  // the empty page that was kept is too small
  auto page = std::ranges::find_if(pages_, [](const Page& one) { return !one.buffer; });
  if (page == pages_.end()) page = pages_.insert(page, Page{});
  const auto index = static_cast<std::uint32_t>(page - pages_.begin());
  // Where this throws OutOfMemory, the page stays an empty handle.
  *page = {Buffer(fmt::format("{} page {}", label_, index), byte_count, WrittenBy::Gpu),
           FreeList(byte_count)};
  return index;
}

Result<Allocation> Arena::allocate(std::uint64_t byte_count, std::uint64_t room) {
  const std::uint64_t wanted = alignUp(std::max<std::uint64_t>({byte_count, room, 1}));
  if (wanted > kMaxPageBytes)
    return fail(label_, fmt::format("{} bytes in one piece; a page holds {}", wanted, kMaxPageBytes),
                "split the mesh or the group");
  for (std::uint32_t i = 0; i < pages_.size(); ++i)
    if (pages_[i].list.largestFree() >= wanted) return *allocateIn(i, byte_count);
  return orOutOfMemory([&]() -> Result<Allocation> {
    return *allocateIn(makePage(std::max(page_bytes_, wanted)), byte_count);
  });
}

void Arena::release(const Allocation& allocation) {
  assert(allocation.page < pages_.size());
  Page& page = pages_[allocation.page];
  page.list.release(allocation.offset, allocation.byte_count);
  bytes_used_ -= allocation.byte_count;
  if (!isEmpty(page)) return;
  for (Page& other : pages_)
    if (&other != &page && isEmpty(other)) other = {};
}

void Arena::write(const Allocation& allocation, std::uint64_t offset, std::span<const std::byte> bytes) {
  assert(offset + bytes.size() <= allocation.byte_count);
  staging_->write(pages_[allocation.page].buffer, allocation.offset + offset, bytes);
}

void Arena::clear(const Allocation& allocation) {
  staging_->clear(pages_[allocation.page].buffer, allocation.offset, allocation.byte_count);
}

void Arena::copy(const Allocation& from, const Allocation& to) {
  assert(from.byte_count <= to.byte_count);
  glCopyNamedBufferSubData(pages_[from.page].buffer.id(), pages_[to.page].buffer.id(),
                           static_cast<GLintptr>(from.offset), static_cast<GLintptr>(to.offset),
                           static_cast<GLsizeiptr>(from.byte_count));
}

}  // namespace lambent::gpu
