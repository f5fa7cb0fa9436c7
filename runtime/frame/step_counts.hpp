// Counts what one step and the picture after it did, as numbers with names, such as light probes captured or
// cells shaded. Each pass declares its names once, and two passes may share one. For a still scene the work
// counts are 0. Reports print the whole list.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace lambent::frame {

class StepCounts {
 public:
  struct Count {
    std::string_view name;  // a literal
    std::uint64_t value = 0;
  };

  void declare(std::span<const std::string_view> names);
  // Sets every count to 0.
  void clear();
  void add(std::string_view name, std::uint64_t value);
  // Returns the count. The name must be declared, unless none is; then the result is 0.
  std::uint64_t operator[](std::string_view name) const;

  // Iterate in the order in which the names were declared.
  auto begin() const { return counts_.begin(); }
  auto end() const { return counts_.end(); }

 private:
  std::vector<Count> counts_;
};

}  // namespace lambent::frame
