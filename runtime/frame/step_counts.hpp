// What one step and the picture after it did, as numbers with names: light probes that were captured, cells
// that were shaded. Each pass declares its names once, and two passes may share one. A still scene does
// nothing. Reports print the list as it stands.
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
  // Returns 0 while no name is declared; else the name must be.
  std::uint64_t operator[](std::string_view name) const;

  // In the order in which they were declared.
  auto begin() const { return counts_.begin(); }
  auto end() const { return counts_.end(); }

 private:
  std::vector<Count> counts_;
};

}  // namespace lambent::frame
