#include "runtime/lighting/light_loss.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/sh/zonal.hpp"

namespace lambent::lighting {

namespace {

using sh::kPi;

// Returns p_l; see the header.
double transferPower(int l) {
  return l == 0 ? 1.0 : std::pow(l + 0.5, -3.0);
}

// Holds the normalised associated Legendre functions at the centres of the rows, times sqrt(4pi) so that band
// 0 is 1, and with the sqrt(2) of m > 0; and the cosine and sine of m times the azimuth.
struct Tables {
  static constexpr int kBands = FluxGrid::kBands;
  static constexpr std::size_t kRows = FluxGrid::kRows, kColumns = FluxGrid::kColumns;
  std::array<std::array<std::array<double, kRows>, kBands>, kBands> legendre{};  // [m][l][row]
  std::array<std::array<double, kColumns>, kBands> cosines{}, sines{};           // [m][column]

  Tables() {
    for (std::size_t row = 0; row < kRows; ++row) {
      const double polar = kPi * (static_cast<double>(row) + 0.5) / kRows;
      const double z = std::cos(polar), side = std::sin(polar);
      double sectoral = 1.0;
      for (int m = 0; m < kBands; ++m) {
        if (m > 0) sectoral *= side * std::sqrt((2.0 * m + 1.0) / (2.0 * m) * (m == 1 ? 2.0 : 1.0));
        double before = 0.0, value = sectoral, back = 0.0;
        for (int l = m; l < kBands; ++l) {
          if (l > m) {
            const double factor = std::sqrt((4.0 * l * l - 1.0) / (1.0 * l * l - 1.0 * m * m));
            const double next = factor * (z * value - back * before);
            before = value;
            value = next;
          }
          // The next step uses this factor, sqrt((l² - m²) / (4 l² - 1)).
          back = std::sqrt((1.0 * l * l - 1.0 * m * m) / (4.0 * l * l - 1.0));
          if (l == m) back = 0.0;
          legendre[static_cast<std::size_t>(m)][static_cast<std::size_t>(l)][row] = value;
        }
      }
    }
    for (std::size_t m = 0; m < cosines.size(); ++m)
      for (std::size_t x = 0; x < kColumns; ++x) {
        const double angle = 2 * kPi * static_cast<double>(m * x % kColumns) / kColumns;
        cosines[m][x] = std::cos(angle);
        sines[m][x] = std::sin(angle);
      }
  }
};

const Tables& tables() {
  static const Tables made;
  return made;
}

}  // namespace

FluxGrid::Place FluxGrid::place(const glm::dvec3& dir) {
  const double azimuth = std::atan2(dir.z, dir.x), polar = std::atan2(std::hypot(dir.x, dir.z), dir.y);
  const double x = (0.5 + azimuth / (2 * kPi)) * kColumns - 0.5, y = polar / kPi * kRows - 0.5;
  const double left = std::floor(x), top = std::floor(y);
  Place at;
  for (int corner = 0; corner < 4; ++corner) {
    const int right = corner & 1, below = corner >> 1;
    int column = static_cast<int>(left) + right, row = static_cast<int>(top) + below;
    if (row < 0 || row >= kRows) {  // beyond a pole
      row = std::clamp(row, 0, kRows - 1);
      column += kColumns / 2;
    }
    column = (column + 2 * kColumns) % kColumns;
    const auto i = static_cast<std::size_t>(corner);
    at.cells[i] = static_cast<std::uint16_t>(row * kColumns + column);
    at.shares[i] = static_cast<float>((right ? x - left : left + 1 - x) * (below ? y - top : top + 1 - y));
  }
  return at;
}

double FluxGrid::flux() const {
  double sum = 0.0;
  for (const double cell : cells_) sum += cell;
  return sum;
}

double FluxGrid::lostPower(int first_band) const {
  const Tables& table = tables();
  std::vector<double> even(kRows), odd(kRows);
  double lost = 0.0;
  for (int m = 0; m < kBands; ++m) {
    const auto& cosines = table.cosines[static_cast<std::size_t>(m)];
    const auto& sines = table.sines[static_cast<std::size_t>(m)];
    for (std::size_t row = 0; row < kRows; ++row) {
      const double* cells = cells_.data() + row * kColumns;
      double even_sum = 0.0, odd_sum = 0.0;
      for (std::size_t x = 0; x < kColumns; ++x) {
        even_sum += cells[x] * cosines[x];
        odd_sum += cells[x] * sines[x];
      }
      even[row] = even_sum;
      odd[row] = odd_sum;
    }
    for (int l = std::max(m, first_band); l < kBands; ++l) {
      const auto& legendre = table.legendre[static_cast<std::size_t>(m)][static_cast<std::size_t>(l)];
      double a = 0.0, b = 0.0;
      for (std::size_t row = 0; row < kRows; ++row) {
        a += legendre[row] * even[row];
        b += legendre[row] * odd[row];
      }
      lost += transferPower(l) * (a * a + b * b);
    }
  }
  return lost;
}

double discLoss(int order, double radius_rad) {
  const double radius = std::max(radius_rad, 1e-5);  // approaches a point
  const double mean = sh::discZonal(0, radius);
  double lost = 0.0;
  for (int l = order; l < FluxGrid::kBands; ++l) {
    const double zonal = sh::discZonal(l, radius) / mean;
    lost += transferPower(l) * zonal * zonal;
  }
  return std::sqrt(lost);
}

}  // namespace lambent::lighting
