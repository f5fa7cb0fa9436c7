#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "baker/compress/cpca.hpp"
#include "baker/compress/cpca_clusters.hpp"
#include "baker/jobs/parallel.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/gaunt.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::baker {

namespace {

constexpr std::size_t kSamplesPerSum = 1024;  // samples in one range of a sum
constexpr double kDarkest = 0.02;             // share of the RMS below which samples count alike

std::size_t shadowedSize(const transfer::TransferShape& shape) {
  if (shape.isVisibility()) return shape.size();
  return std::size_t{shape.shadowed_channels} * shape.outputs * shape.columns();
}

// Returns, for each of a sample's values, the sum over samples of value(sample, at)², added in a fixed order.
// `at` is where the value lies among those of all samples.
template <typename Value>
std::vector<double> energies(std::size_t size, std::size_t count, const Value& value) {
  std::vector<std::vector<double>> partial((count + kSamplesPerSum - 1) / kSamplesPerSum);
  parallelRanges(count, kSamplesPerSum, {}, [&](std::size_t begin, std::size_t end) {
    std::vector<double>& sums = partial[begin / kSamplesPerSum];
    sums.assign(size, 0.0);
    for (std::size_t s = begin; s < end; ++s)
      for (std::size_t i = 0; i < size; ++i) {
        const double v = value(s, s * size + i);
        sums[i] += v * v;
      }
  });
  std::vector<double> total(size, 0.0);
  for (const auto& sums : partial)
    for (std::size_t i = 0; i < size; ++i) total[i] += sums[i];
  return total;
}

// Returns how much an output's error shows: A_l/pi for normal maps, by the power of the lobe for glossy
// surfaces, else 1.
double outputRoot(const transfer::TransferShape& shape, int output, const BandPower& kernel_power) {
  if (shape.outputs == 1) return 1.0;
  const int band = sh::bandOf(output);
  return shape.beyondDiffuse() ? std::sqrt(kernel_power[static_cast<std::size_t>(band)])
                               : sh::clampedCosine(band) / std::numbers::pi;
}

// Averages over lights and lobes turned at random, which make errors of visibility's coefficients
// independent.
std::vector<double> visibilityRoots(const transfer::TransferShape& shape, const BandPower& kernel_power) {
  const auto bands_out = static_cast<int>(transfer::bandsOf(shape.outputs));
  const sh::GauntTable table = sh::makeGauntTable(static_cast<int>(shape.order), bands_out);
  std::vector<double> powers(shape.size(), 0.0);
  for (std::uint32_t i = 0; i < shape.outputs; ++i)
    for (std::uint32_t t = table.offsets[i]; t < table.offsets[i + 1]; ++t) {
      const sh::GauntTerm& term = table.terms[t];
      powers[term.k] += kernel_power[static_cast<std::size_t>(sh::bandOf(static_cast<int>(i)))] *
                        kBandPower[static_cast<std::size_t>(sh::bandOf(term.j))] * double{term.value} *
                        double{term.value};
    }
  for (double& power : powers) power = std::sqrt(power);
  return powers;
}

// Returns sqrt(W_i), the band power of light times the weight of the output. Columns of the group's lights
// get a band power of 1 here.
std::vector<double> bandRoots(const transfer::TransferShape& shape, const BandPower& kernel_power) {
  if (shape.isVisibility()) return visibilityRoots(shape, kernel_power);
  std::vector<double> roots;
  const std::size_t columns = shape.columns(), environment = std::size_t{shape.order} * shape.order;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const auto column = static_cast<int>(i % columns), output = static_cast<int>(i / columns % shape.outputs);
    double root = 1.0;
    if (static_cast<std::size_t>(column) < environment)
      root = std::sqrt(kBandPower[static_cast<std::size_t>(sh::bandOf(column))]);
    roots.push_back(root * outputRoot(shape, output, kernel_power));
  }
  return roots;
}

// Returns how many of red, green and blue a channel stands for.
double channelWeight(const transfer::TransferShape& shape) {
  return std::max(shape.shadowed_channels, shape.full_channels) == 3 ? 1.0 : 3.0;
}

struct Block {
  std::size_t first = 0, last = 0;
};

std::vector<Block> blocksOf(const transfer::TransferShape& shape) {
  std::vector<Block> blocks;
  if (shape.shadowed_channels > 0) blocks.push_back({0, shadowedSize(shape)});
  if (shape.full_channels > 0) blocks.push_back({shadowedSize(shape), shape.size()});
  return blocks;
}

// Scales each block to energy 1, in which each of the group's lights has as much energy as the whole
// environment. With shown_energy, or for visibility, the scale is relative to what is shown instead.
std::vector<double> normalisedRoots(std::span<const float> vectors, const transfer::TransferShape& shape,
                                    double shown_energy, const BandPower& kernel_power) {
  std::vector<double> roots = bandRoots(shape, kernel_power);
  if (shown_energy > 0.0 || shape.isVisibility()) {
    const double whole = shown_energy > 0.0 ? shown_energy : transferEnergy(vectors, shape, kernel_power);
    const double scale = whole > 0.0 ? std::sqrt(channelWeight(shape) / whole) : 0.0;
    for (double& root : roots) root *= scale;
    return roots;
  }
  const std::size_t size = shape.size(), columns = shape.columns(),
                    environment = std::size_t{shape.order} * shape.order;
  const auto energy =
      energies(size, vectors.size() / size, [&](std::size_t, std::size_t at) { return double{vectors[at]}; });
  for (const Block& block : blocksOf(shape)) {
    std::vector<double> of_column(columns, 0.0);
    for (std::size_t i = block.first; i < block.last; ++i)
      of_column[i % columns] += roots[i] * roots[i] * energy[i];
    double sky = 0.0, lit = 0.0;
    for (std::size_t c = 0; c < environment; ++c) sky += of_column[c];
    for (std::size_t c = environment; c < columns; ++c) lit += of_column[c] > 0.0 ? 1.0 : 0.0;
    const double parts = lit + (sky > 0.0 ? 1.0 : 0.0);
    for (std::size_t i = block.first; i < block.last; ++i) {
      const double own = i % columns < environment ? sky : of_column[i % columns];
      roots[i] = own > 0.0 ? roots[i] / std::sqrt(own * parts) : 0.0;
    }
  }
  return roots;
}

}  // namespace

double transferEnergy(std::span<const float> vectors, const transfer::TransferShape& shape,
                      const BandPower& kernel_power) {
  const std::vector<double> roots = bandRoots(shape, kernel_power);
  const auto energy = energies(shape.size(), vectors.size() / shape.size(),
                               [&](std::size_t, std::size_t at) { return double{vectors[at]}; });
  double sum = 0.0;
  for (std::size_t i = 0; i < roots.size(); ++i) sum += roots[i] * roots[i] * energy[i];
  return channelWeight(shape) * sum;
}

std::vector<float> sampleImportance(std::span<const float> vectors, const transfer::TransferShape& shape,
                                    double shown_energy, const BandPower& kernel_power,
                                    std::span<const float> weights) {
  const std::size_t size = shape.size(), count = vectors.size() / size;
  const bool eases = !(shown_energy > 0.0) && !shape.isVisibility();
  if (!eases && weights.empty()) return std::vector<float>(count, 1.0f);
  const std::vector<double> roots = normalisedRoots(vectors, shape, 0.0, kernel_power);
  std::vector<double> squares(count, 0.0);
  parallelRanges(count, kSamplesPerSum, {}, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s)
      for (std::size_t i = 0; i < size; ++i) {
        const double v = roots[i] * double{vectors[s * size + i]};
        squares[s] += v * v;
      }
  });
  double energy = 0.0;
  for (const double square : squares) energy += square;
  if (!(energy > 0.0)) return std::vector<float>(count, 1.0f);
  std::vector<double> counts(count);
  double eased = 0.0;
  for (std::size_t s = 0; s < count; ++s) {
    const double x = std::sqrt(squares[s] * static_cast<double>(count) / energy);
    counts[s] = (eases ? 1.0 / (kDarkest + x) : 1.0) * (weights.empty() ? 1.0 : double{weights[s]});
    eased += counts[s] * squares[s];
  }
  std::vector<float> importance(count);
  for (std::size_t s = 0; s < count; ++s) importance[s] = static_cast<float>(counts[s] * energy / eased);
  return importance;
}

WeightedSpace weightedSpace(std::span<const float> vectors, const transfer::TransferShape& shape,
                            double shown_energy, const BandPower& kernel_power) {
  WeightedSpace space{normalisedRoots(vectors, shape, shown_energy, kernel_power), 1.0};
  if (shape.full_channels > 0 && shape.shadowed_channels > 0) {
    for (std::size_t i = 0; i < shadowedSize(shape); ++i) space.roots[i] *= kShadowedRoot;
    space.blocks += kShadowedRoot * kShadowedRoot;
  }
  return space;
}

double radianceError(std::span<const float> truth, std::span<const float> coded,
                     const transfer::TransferShape& shape, double shown_energy, const BandPower& kernel_power,
                     std::span<const float> weights) {
  const std::size_t size = shape.size();
  assert(truth.size() == coded.size() && truth.size() % size == 0);
  const std::vector<double> roots = normalisedRoots(truth, shape, shown_energy, kernel_power);
  std::vector<float> importance = sampleImportance(truth, shape, shown_energy, kernel_power, weights);
  for (float& one : importance) one = std::sqrt(one);
  const auto off = energies(size, truth.size() / size, [&](std::size_t sample, std::size_t at) {
    return double{importance[sample]} * (double{coded[at]} - double{truth[at]});
  });
  double worst = 0.0;
  for (const Block& block : blocksOf(shape)) {
    double sum = 0.0;
    // Where the truth has no energy there is nothing to be relative to, so the absolute error counts.
    for (std::size_t i = block.first; i < block.last; ++i)
      sum += (roots[i] > 0.0 ? roots[i] * roots[i] : 1.0) * off[i];
    // NaN is the worst error, and stays.
    if (const double own = std::sqrt(sum); std::isnan(own) || own > worst) worst = own;
  }
  return worst;
}

}  // namespace lambent::baker
