// Measures what receivers see of a change, given how their surfaces face; this decides how far a grid
// reaches. A floor loses little light to a body that stands on it far away, however much of its sky the body
// fills; ChangeMeter, which takes all normals, would make the grid as long as the floor.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "baker/effects/neighborhood/point_change.hpp"
#include "baker/plan/facing_area.hpp"

namespace lambent::baker {

class ReceiverMeter {
 public:
  // If `facing` has no area, receivers may face anywhere.
  ReceiverMeter(const ChangeShape& shape, const FacingArea& facing);

  // Does what ChangeMeter::measure does, over the normals of the receivers and for their cosine in three
  // bands. May be called from any thread.
  double measure(std::span<const float> visibility, std::span<const float> bounced) const;

 private:
  static constexpr std::size_t kOutputs = 9;
  struct Term {
    std::uint32_t at;  // output * columns + column
    std::uint16_t k;
    float value;
  };
  ChangeShape shape_;
  std::vector<Term> terms_;
  std::vector<double> light_power_;                          // one per column
  std::array<std::array<double, kOutputs>, kOutputs> seen_;  // mean over normals of A_i y_i A_j y_j
  double light_ = 0.0;
};

}  // namespace lambent::baker
