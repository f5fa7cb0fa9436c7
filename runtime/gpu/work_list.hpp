// Holds the work of a compute pass as batches of work items. Each batch is one indirect dispatch whose items
// share all bindings (one arena page, one program). In the kernel, work group i = x + y * 65535 processes
// work[i] and does nothing if i >= work_count; OpenGL guarantees at most 65535 groups along x. A list that
// does not change is uploaded only once.
#pragma once

#include <cstdint>
#include <map>
#include <string_view>
#include <vector>

#include "runtime/gpu/objects.hpp"

namespace lambent::gpu {

struct WorkItem {
  std::uint32_t record = 0;  // index of the record to process
  std::uint32_t first = 0;   // first element of the record for this work group
};

// Holds the program variant of a batch, followed by its pages.
using BatchKey = std::vector<std::uint32_t>;

class WorkList {
 public:
  static constexpr std::uint32_t kMaxGroupsX = 65535;

  explicit WorkList(std::string_view label) : buffer_(label) {}

  void clear() { batches_.clear(); }
  // Adds items for elements 0..count-1 of a record, with `group_size` elements per item.
  void add(const BatchKey& key, std::uint32_t record, std::uint32_t count, std::uint32_t group_size);
  bool empty() const { return batches_.empty(); }

  // Uploads the list if it differs from the last upload. Batches are ordered by their keys.
  void upload(Counters& counters);
  const std::map<BatchKey, std::vector<WorkItem>>& batches() const { return batches_; }
  // Binds and dispatches batch `index`. The caller has bound the program and its other buffers.
  void dispatch(std::size_t index, std::uint32_t binding, Counters& counters) const;

 private:
  std::map<BatchKey, std::vector<WorkItem>> batches_;
  std::vector<std::size_t> offsets_;  // offset of each batch's arguments in the buffer
  std::vector<std::byte> bytes_;      // the bytes of the last upload
  Table buffer_;
};

}  // namespace lambent::gpu
