// Provides what the tests of this room compare with: exact quadrature over the sphere, reproducible random
// directions and rotations, and real SH by the textbook recurrence with the Condon-Shortley sign.
#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

namespace lambent::sh::testing {

inline constexpr double kDegree = std::numbers::pi / 180;

struct Node {
  double at, weight;
};

// Returns Gauss-Legendre nodes on [from, to], exact for polynomials up to degree 2 count - 1.
inline std::vector<Node> gaussLegendre(int count, double from, double to) {
  std::vector<Node> nodes;
  for (int i = 0; i < count; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (count + 0.5)), slope = 1;
    for (int step = 0; step < 100; ++step) {
      double before = 1, value = x;
      for (int k = 2; k <= count; ++k) {
        const double next = ((2 * k - 1) * x * value - (k - 1) * before) / k;
        before = value;
        value = next;
      }
      slope = count * (x * value - before) / (x * x - 1);
      const double change = value / slope;
      x -= change;
      if (std::abs(change) < 1e-15) break;
    }
    const double half = 0.5 * (to - from);
    nodes.push_back({0.5 * (from + to) + half * x, half * 2 / ((1 - x * x) * slope * slope)});
  }
  return nodes;
}

// Calls f(direction, weight) for polar angles (from +Z) and azimuths in the given ranges.
template <typename F>
void overSphere(int count, double polar0, double polar1, double phi0, double phi1, F&& f) {
  for (const Node& polar : gaussLegendre(count, polar0, polar1))
    for (const Node& phi : gaussLegendre(count, phi0, phi1)) {
      const double r = std::sin(polar.at);
      f(glm::dvec3(r * std::cos(phi.at), r * std::sin(phi.at), std::cos(polar.at)),
        polar.weight * phi.weight * r);
    }
}

template <typename F>
void overSphere(int count, F&& f) {
  overSphere(count, 0, std::numbers::pi, 0, 2 * std::numbers::pi, f);
}

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double uniform() {
    return (static_cast<double>(engine_()) + 0.5) / 4294967296.0;
  }  // the same on every standard library
  glm::dvec3 direction() {
    const double z = 2 * uniform() - 1, phi = 2 * std::numbers::pi * uniform(), r = std::sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
  }
  glm::dquat rotation() {
    const double u = uniform(), a = 2 * std::numbers::pi * uniform(), b = 2 * std::numbers::pi * uniform();
    return {std::sqrt(u) * std::cos(b), std::sqrt(1 - u) * std::sin(a), std::sqrt(1 - u) * std::cos(a),
            std::sqrt(u) * std::sin(b)};
  }

 private:
  std::mt19937 engine_;
};

// Returns the k-th of count nearly uniform directions.
inline glm::dvec3 fibonacciDirection(int k, int count) {
  const double z = 1 - (2.0 * k + 1) / count, r = std::sqrt(1 - z * z);
  const double phi = std::numbers::pi * (3 - std::sqrt(5.0)) * k;
  return {r * std::cos(phi), r * std::sin(phi), z};
}

// Returns order² real orthonormal SH with the Condon-Shortley sign, in double and by a recurrence of its own
// (unnormalised associated Legendre functions and factorials).
inline std::vector<double> condonShortleySh(const glm::dvec3& dir, int order) {
  std::vector<double> out(static_cast<std::size_t>(order * order));
  const double sine = std::sqrt(std::max(0.0, 1 - dir.z * dir.z)), phi = std::atan2(dir.y, dir.x);
  for (int m = 0; m < order; ++m) {
    double before = 0, value = 1;
    for (int k = 1; k <= m; ++k) value *= -(2 * k - 1) * sine;
    for (int l = m; l < order; ++l) {
      if (l > m) {
        const double next = ((2 * l - 1) * dir.z * value - (l + m - 1) * before) / (l - m);
        before = value;
        value = next;
      }
      const double scale =
          std::sqrt((2 * l + 1) / (4 * std::numbers::pi) * std::tgamma(l - m + 1) / std::tgamma(l + m + 1));
      if (m == 0) {
        out[static_cast<std::size_t>(l * (l + 1))] = scale * value;
      } else {
        out[static_cast<std::size_t>(l * (l + 1) + m)] =
            std::numbers::sqrt2 * scale * value * std::cos(m * phi);
        out[static_cast<std::size_t>(l * (l + 1) - m)] =
            std::numbers::sqrt2 * scale * value * std::sin(m * phi);
      }
    }
  }
  return out;
}

}  // namespace lambent::sh::testing
