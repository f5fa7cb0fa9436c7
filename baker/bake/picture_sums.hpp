// Sums up how wrong the light is that leaves points towards eyes, relative RMS over real lights, and divides
// the error among its causes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "runtime/bundle/description.hpp"

namespace lambent::baker {

class PictureSums {
 public:
  PictureSums(int order, std::size_t eyes);

  // The number of coefficients of a channel.
  std::size_t coefficients() const { return coefficients_; }

  // The radiance that leaves a point as a function of the environment: coefficients of red, then of green,
  // then of blue. `exact` comes from many rays from the point, `noisy` from as many as a vertex has; `fields`
  // is interpolated between vertices, and `codes` from what codes hold of these.
  struct Shown {
    std::span<const float> exact, noisy, fields, codes;
  };
  struct Point {
    std::uint32_t eye = 0;
    double weight = 1.0;          // the number of points for which it stands
    double squared_shares = 1.0;  // the sum of the squares of the vertices' shares
    // The share of the squared difference between few and many rays that the many make.
    double noise_of_exact = 0.0;
  };
  void add(const Point& point, const Shown& shown);

  // Every eye counts alike, as it gets used to the light. Returns nothing if too few points were added.
  std::optional<bundle::PictureError> result() const;

 private:
  double squareOf(std::span<const float> a, std::span<const float> b) const;

  struct OfEye {
    double light = 0.0, all = 0.0, codes = 0.0, samples = 0.0;
    std::size_t points = 0;
  };
  std::size_t coefficients_;
  std::vector<OfEye> of_eye_;
};

}  // namespace lambent::baker
