#include "runtime/gpu/work_list.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>

namespace lambent::gpu {

namespace {

// Batches start at multiples of a block, where any driver can bind a storage range. The first block holds the
// arguments of the dispatch. The list follows: its length, padding to 16 bytes, and the items.
constexpr std::size_t kBlockBytes = 256;
constexpr std::size_t kHeaderBytes = 16;

std::size_t listBytes(std::size_t item_count) {
  return kHeaderBytes + item_count * sizeof(WorkItem);
}

}  // namespace

void WorkList::add(const BatchKey& key, std::uint32_t record, std::uint32_t count, std::uint32_t group_size) {
  if (count == 0) return;
  std::vector<WorkItem>& items = batches_[key];
  for (std::uint64_t first = 0; first < count; first += group_size)
    items.push_back({record, static_cast<std::uint32_t>(first)});
}

void WorkList::upload(Counters& counters) {
  std::size_t end = 0;
  offsets_.clear();
  for (const auto& [key, items] : batches_) {
    offsets_.push_back(end);
    end += kBlockBytes + (listBytes(items.size()) + kBlockBytes - 1) / kBlockBytes * kBlockBytes;
  }
  std::vector<std::byte> bytes(end);
  std::size_t batch = 0;
  for (const auto& [key, items] : batches_) {
    const auto count = static_cast<std::uint32_t>(items.size());
    const std::uint32_t arguments[] = {std::min(count, kMaxGroupsX), (count + kMaxGroupsX - 1) / kMaxGroupsX,
                                       1};
    std::byte* at = bytes.data() + offsets_[batch++];
    std::memcpy(at, arguments, sizeof(arguments));
    std::memcpy(at + kBlockBytes, &count, sizeof(count));
    std::memcpy(at + kBlockBytes + kHeaderBytes, items.data(), items.size() * sizeof(WorkItem));
  }
  if (bytes == bytes_) return;
  bytes_ = std::move(bytes);
  buffer_.assignBytes(bytes_);
  counters.uploaded_bytes += bytes_.size();
}

void WorkList::dispatch(std::size_t index, std::uint32_t binding, Counters& counters) const {
  assert(index < offsets_.size());
  const std::size_t item_count =
      std::next(batches_.begin(), static_cast<std::ptrdiff_t>(index))->second.size();
  glBindBufferRange(GL_SHADER_STORAGE_BUFFER, binding, buffer_.buffer().id(),
                    static_cast<GLintptr>(offsets_[index] + kBlockBytes),
                    static_cast<GLsizeiptr>(listBytes(item_count)));
  glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, buffer_.buffer().id());
  glDispatchComputeIndirect(static_cast<GLintptr>(offsets_[index]));
  ++counters.dispatches;
}

}  // namespace lambent::gpu
