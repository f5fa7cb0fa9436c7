// What receivers see of a change, by how their surfaces face: a grid's reach. A floor takes little from a
// body that stands low over it far off, however much of its sky the body fills; ChangeMeter, which takes all
// normals, would have the grid as long as the floor.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "baker/effects/neighborhood/point_change.hpp"
#include "baker/plan/facing_area.hpp"

namespace lambent::baker {

class ReceiverMeter {
 public:
  // facing: no area at all counts as everywhere.
  ReceiverMeter(const ChangeShape& shape, const FacingArea& facing);

  // As ChangeMeter::measure, over the normals of the receivers and for their cosine in three bands. From any
  // thread.
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
  std::vector<double> light_power_;                          // of each column
  std::array<std::array<double, kOutputs>, kOutputs> seen_;  // mean over normals of A_i y_i A_j y_j
  double light_ = 0.0;
};

}  // namespace lambent::baker
