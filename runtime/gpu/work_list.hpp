// What a compute pass has to do, as batches of work items, each run by one indirect dispatch. A batch is what
// can share its bindings (one arena page, one program). In a kernel: work group i does work[i], and a group
// with i >= work_count has nothing to do; i = x + y * 65535, since OpenGL promises no longer rows. Lists that
// stay the same are uploaded once.
#pragma once

#include <cstdint>
#include <map>
#include <string_view>
#include <vector>

#include "runtime/gpu/objects.hpp"

namespace lambent::gpu {

struct WorkItem {
  std::uint32_t record = 0;  // what to work on
  std::uint32_t first = 0;   // its first element for this work group
};

// In the order: program variant, then pages.
using BatchKey = std::vector<std::uint32_t>;

class WorkList {
 public:
  static constexpr std::uint32_t kMaxGroupsX = 65535;

  explicit WorkList(std::string_view label) : buffer_(label) {}

  void clear() { batches_.clear(); }
  // Items for elements 0..count-1 of a record, `group_size` elements to an item.
  void add(const BatchKey& key, std::uint32_t record, std::uint32_t count, std::uint32_t group_size);
  bool empty() const { return batches_.empty(); }

  // Uploads if anything differs from last time; batches keep the order of their keys.
  void upload(Counters& counters);
  const std::map<BatchKey, std::vector<WorkItem>>& batches() const { return batches_; }
  // Binds batch `index` and dispatches it. The program and its other buffers are bound already.
  void dispatch(std::size_t index, std::uint32_t binding, Counters& counters) const;

 private:
  std::map<BatchKey, std::vector<WorkItem>> batches_;
  std::vector<std::size_t> offsets_;  // of each batch's arguments in the buffer
  std::vector<std::byte> bytes_;      // as uploaded
  Table buffer_;
};

}  // namespace lambent::gpu
