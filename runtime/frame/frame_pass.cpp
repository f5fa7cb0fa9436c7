#include "runtime/frame/frame_pass.hpp"

#include <algorithm>
#include <cassert>

namespace lambent::frame {

void StepCounts::declare(std::span<const std::string_view> names) {
  for (const std::string_view name : names)
    if (std::ranges::find(counts_, name, &Count::name) == counts_.end()) counts_.push_back({.name = name});
}

void StepCounts::clear() {
  for (Count& count : counts_) count.value = 0;
}

void StepCounts::add(std::string_view name, std::uint64_t value) {
  const auto found = std::ranges::find(counts_, name, &Count::name);
  assert(found != counts_.end());
  found->value += value;
}

std::uint64_t StepCounts::operator[](std::string_view name) const {
  if (counts_.empty()) return 0;
  const auto found = std::ranges::find(counts_, name, &Count::name);
  assert(found != counts_.end());
  return found->value;
}

void FrameContext::because(std::string_view otherwise) const {
  scope->because(log.of(pass->causes, otherwise));
}

bool FrameContext::declares(std::type_index type, bool to_write) const {
  const auto has = [&](const Resources& types) { return std::ranges::find(types, type) != types.end(); };
  return has(pass->writes) || (!to_write && (has(pass->reads) || has(pass->reads_before)));
}

}  // namespace lambent::frame
