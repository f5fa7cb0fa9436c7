// What shaded surfaces miss when a light is kept to a few SH bands. In: light from infinity as points of
// luminous flux. Out: one number, its loss. Pure CPU, safe to call from any thread.
//
// A receiver's shaded radiance is sum_i t_i L_i. Over all turns of receiver against light, what the bands
// from n of the light L give to it has the variance sum_{l >= n} p_l |L_l|^2, where p_l is the power of one
// coefficient of the transfer in band l. Transfer that is cut by a shadow's edge is a step on the sphere,
// whose power falls as l^-2 per band and so as l^-3 per coefficient; for a clamped cosine half in shadow, p_l
// / p_0 = 1.3 (l + 1/2)^-3, of which the 1.3 is left out here. The loss of L at order n is the standard
// deviation of what is missing relative to the mean:
//
//   loss = sqrt(sum_{l = n..23} (l + 1/2)^-3 |L_l|^2) / |L_00|
//
// A sun alone loses 0.56 at order 5, a uniform half of the sky about 0.02, a sky like cos^2 nothing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

namespace lambent::lighting {

// Flux in the cells of a coarse lat-long picture. A point is shared out among the four cells around it, so
// that it keeps its place.
class FluxGrid {
 public:
  static constexpr int kRows = 64, kColumns = 128;
  static constexpr int kBands = 24;  // more than the cells' edges (2.8 degrees) could tell apart are left out

  // The cells that a point falls into, to be kept where many grids get the same points.
  struct Place {
    std::array<std::uint16_t, 4> cells{};
    std::array<float, 4> shares{};
  };
  static Place place(const glm::dvec3& dir);

  void add(const Place& at, double flux) {
    for (std::size_t i = 0; i < 4; ++i) cells_[at.cells[i]] += flux * static_cast<double>(at.shares[i]);
  }
  double flux() const;
  // sum_{l = first_band..23} p_l |L_l|^2 / |Y_00|^2: the square of a flux, to be divided by that of all
  // light. p_0 is 1.
  double lostPower(int first_band) const;

 private:
  std::vector<double> cells_ = std::vector<double>(std::size_t{kRows} * kColumns);
};

// The loss at this order of a uniform disc that shines alone, closed form.
double discLoss(int order, double radius_rad);

}  // namespace lambent::lighting
