#include "runtime/sh/gaunt.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "runtime/sh/basis.hpp"

namespace lambent::sh {

namespace {

// Smaller values of Γ are rounding errors of 0. The smallest nonzero one is over 1e-4.
constexpr double kNothing = 1e-12;

struct Node {
  double z, weight;
};

// Returns Gauss-Legendre nodes on [-1, 1], which are exact for polynomials of degree 2 count - 1.
std::vector<Node> gaussLegendre(int count) {
  std::vector<Node> nodes;
  for (int i = 0; i < count; ++i) {
    double z = std::cos(std::numbers::pi * (i + 0.75) / (count + 0.5)), slope = 1;
    for (int step = 0; step < 50; ++step) {
      double before = 1, value = z;
      for (int k = 2; k <= count; ++k)
        before = std::exchange(value, ((2 * k - 1) * z * value - (k - 1) * before) / k);
      slope = count * (z * value - before) / (z * z - 1);
      const double change = value / slope;
      z -= change;
      if (std::abs(change) < 1e-16) break;
    }
    nodes.push_back({z, 2 / ((1 - z * z) * slope * slope)});
  }
  return nodes;
}

// Holds the weights of the nodes and, for each node, `stride` values of y.
struct Samples {
  std::vector<double> weights;
  std::vector<double> y;
  std::size_t stride = 0;
};

// Samples the sphere so that products of three functions are integrated exactly. Their degree in z and in
// cos(phi), sin(phi) is (in - 1) + (out - 1) + (in + out - 2).
Samples sampleSphere(int bands_in, int bands_out) {
  const int degree = 2 * (bands_in + bands_out - 2), visibility = bands_in + bands_out - 1;
  const int order = std::max({bands_in, bands_out, visibility});
  Samples samples{.weights = {}, .y = {}, .stride = static_cast<std::size_t>(coefficientCount(order))};
  const int turns = degree + 2;
  for (const Node& node : gaussLegendre(degree / 2 + 1))
    for (int k = 0; k < turns; ++k) {
      const double phi = 2 * std::numbers::pi * (k + 0.5) / turns, r = std::sqrt(1 - node.z * node.z);
      samples.weights.push_back(node.weight * 2 * std::numbers::pi / turns);
      samples.y.resize(samples.y.size() + samples.stride);
      evaluate<double>(order, r * std::cos(phi), r * std::sin(phi), node.z,
                       std::span(samples.y).last(samples.stride));
    }
  return samples;
}

}  // namespace

GauntTable makeGauntTable(int bands_in, int bands_out) {
  assert(bands_in >= 1 && bands_out >= 1 && bands_in + bands_out - 1 <= kMaxVisibilityBands);
  GauntTable table{.bands_in = bands_in, .bands_out = bands_out, .offsets = {0}, .terms = {}};
  const auto count = [](int bands) { return static_cast<std::size_t>(coefficientCount(bands)); };
  const std::size_t inputs = count(bands_in), outputs = count(bands_out),
                    visibilities = count(table.visibilityBands());
  const Samples samples = sampleSphere(bands_in, bands_out);
  std::array<double, coefficientCount(kMaxVisibilityBands)> row{};
  for (std::size_t i = 0; i < outputs; ++i) {
    for (std::size_t j = 0; j < inputs; ++j) {
      row.fill(0);
      for (std::size_t n = 0; n < samples.weights.size(); ++n) {
        const double* y = samples.y.data() + n * samples.stride;
        const double product = samples.weights[n] * y[i] * y[j];
        for (std::size_t k = 0; k < visibilities; ++k) row[k] += product * y[k];
      }
      for (std::size_t k = 0; k < visibilities; ++k)
        if (std::abs(row[k]) >= kNothing)
          table.terms.push_back({.j = static_cast<std::uint16_t>(j),
                                 .k = static_cast<std::uint16_t>(k),
                                 .value = static_cast<float>(row[k])});
    }
    table.offsets.push_back(static_cast<std::uint32_t>(table.terms.size()));
  }
  return table;
}

void addVisibilityMatrix(const GauntTable& table, std::span<const float> visibility,
                         std::span<float> matrix) {
  const auto inputs = static_cast<std::size_t>(coefficientCount(table.bands_in));
  assert(visibility.size() >= static_cast<std::size_t>(coefficientCount(table.visibilityBands())));
  assert(matrix.size() >= inputs * (table.offsets.size() - 1));
  for (std::size_t i = 0; i + 1 < table.offsets.size(); ++i)
    for (std::uint32_t t = table.offsets[i]; t < table.offsets[i + 1]; ++t) {
      const GauntTerm& term = table.terms[t];
      matrix[i * inputs + term.j] += term.value * visibility[term.k];
    }
}

}  // namespace lambent::sh
