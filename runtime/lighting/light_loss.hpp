// Computes what shaded surfaces lose when a light is limited to a few SH bands. It takes light from infinity
// as points of luminous flux and returns one number, the loss. Pure CPU, safe to call from any thread.
//
// A receiver's shaded radiance is sum_i t_i L_i. Over all rotations of the receiver against the light, the
// bands from n on of the light L contribute the variance sum_{l >= n} p_l |L_l|^2, where p_l is the power of
// one coefficient of the transfer in band l. Transfer that is cut by a shadow's edge is a step on the sphere,
// whose power falls as l^-2 per band and so as l^-3 per coefficient. For a clamped cosine half in shadow, p_l
// / p_0 = 1.3 (l + 1/2)^-3; the factor 1.3 is left out here. The loss of L at order n is the standard
// deviation of the missing part relative to the mean:
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

// Holds flux in the cells of a coarse lat-long picture. A point is distributed over the four cells around it,
// so that its position is kept.
class FluxGrid {
 public:
  static constexpr int kRows = 64, kColumns = 128;
  static constexpr int kBands = 24;  // higher bands vary faster than the cells (2.8 degrees) can resolve

  // Holds the cells that a point falls into. Keep it when many grids receive the same points.
  struct Place {
    std::array<std::uint16_t, 4> cells{};
    std::array<float, 4> shares{};
  };
  static Place place(const glm::dvec3& dir);

  void add(const Place& at, double flux) {
    for (std::size_t i = 0; i < 4; ++i) cells_[at.cells[i]] += flux * static_cast<double>(at.shares[i]);
  }
  double flux() const;
  // Returns sum_{l = first_band..23} p_l |L_l|^2 / |Y_00|^2 with p_0 = 1. This is the square of a flux;
  // divide it by the square of the flux of all light.
  double lostPower(int first_band) const;

 private:
  std::vector<double> cells_ = std::vector<double>(std::size_t{kRows} * kColumns);
};

// Returns the loss at this order of a uniform disc that shines alone, in closed form.
double discLoss(int order, double radius_rad);

}  // namespace lambent::lighting
