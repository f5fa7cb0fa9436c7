#include "runtime/frame/frame_pass.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

namespace lambent::frame {

void StepCounts::declare(std::span<const std::string_view> names) {
  for (const std::string_view name : names)
    if (std::ranges::find(counts_, name, &Count::name) == counts_.end()) counts_.push_back({.name = name});
}

void StepCounts::clear() {
  for (Count& count : counts_) count.value = 0;
}

std::size_t StepCounts::placeOf(std::string_view name) const {
  const auto found = std::ranges::find(counts_, name, &Count::name);
  if (found == counts_.end()) throw std::out_of_range(fmt::format("no pass counts {}", name));
  return static_cast<std::size_t>(found - counts_.begin());
}

void StepCounts::add(std::string_view name, std::uint64_t value) {
  counts_[placeOf(name)].value += value;
}

std::uint64_t StepCounts::operator[](std::string_view name) const {
  return counts_.empty() ? 0 : counts_[placeOf(name)].value;
}

void FrameContext::because(std::string_view otherwise) const {
  scope->because(log.of(pass->causes, otherwise));
}

bool FrameContext::declares(std::type_index type, bool to_write) const {
  const auto has = [&](const Resources& types) { return std::ranges::find(types, type) != types.end(); };
  return has(pass->writes) || (!to_write && (has(pass->reads) || has(pass->reads_before)));
}

}  // namespace lambent::frame
