#include "baker/compress/cpca_space.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "baker/compress/cpca.hpp"
#include "baker/compress/light_weights.hpp"
#include "baker/jobs/parallel.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/gaunt.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::baker {

namespace {

constexpr std::size_t kGrain = 1024;  // samples in a range of a sum

std::size_t shadowedSize(const bundle::TransferShape& shape) {
  if (shape.isVisibility()) return shape.size();
  return std::size_t{shape.shadowed_channels} * shape.outputs * shape.columns();
}

// Per value, the sum over samples of value(sample, i)², ordered.
template <typename Value>
std::vector<double> energies(std::size_t size, std::size_t count, const Value& value) {
  std::vector<std::vector<double>> partial((count + kGrain - 1) / kGrain);
  parallelRanges(count, kGrain, {}, [&](std::size_t begin, std::size_t end) {
    std::vector<double>& sums = partial[begin / kGrain];
    sums.assign(size, 0.0);
    for (std::size_t s = begin; s < end; ++s)
      for (std::size_t i = 0; i < size; ++i) {
        const double v = value(s * size + i);
        sums[i] += v * v;
      }
  });
  std::vector<double> total(size, 0.0);
  for (const auto& sums : partial)
    for (std::size_t i = 0; i < size; ++i) total[i] += sums[i];
  return total;
}

// How much an output's error shows: not normal-mapped 1, for normal maps A_l/pi, for glossy surfaces by the
// lobe.
double outputRoot(const bundle::TransferShape& shape, int output, const BandPower& kernel_power) {
  if (shape.outputs == 1) return 1.0;
  const int band = sh::bandOf(output);
  return shape.glossy() ? std::sqrt(kernel_power[static_cast<std::size_t>(band)])
                        : sh::clampedCosine(band) / std::numbers::pi;
}

// Of visibility: lights and lobes turned at random make errors of its coefficients independent of each other.
std::vector<double> visibilityRoots(const bundle::TransferShape& shape, const BandPower& kernel_power) {
  const auto bands_out = static_cast<int>(bundle::bandsOf(shape.outputs));
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

// sqrt(W_i) but for the lights of the group, which are 1 here: band power of light, times what the output
// counts.
std::vector<double> bandRoots(const bundle::TransferShape& shape, const BandPower& kernel_power) {
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

// How many of red, green and blue a channel stands for.
double channelWeight(const bundle::TransferShape& shape) {
  return std::max(shape.shadowed_channels, shape.full_channels) == 3 ? 1.0 : 3.0;
}

struct Block {
  std::size_t first = 0, last = 0;
};

std::vector<Block> blocksOf(const bundle::TransferShape& shape) {
  std::vector<Block> blocks;
  if (shape.shadowed_channels > 0) blocks.push_back({0, shadowedSize(shape)});
  if (shape.full_channels > 0) blocks.push_back({shadowedSize(shape), shape.size()});
  return blocks;
}

// Each block of energy 1; in it, the columns of lights of as much energy as the whole environment, each. Or
// relative to what is shown.
std::vector<double> normalisedRoots(std::span<const float> vectors, const bundle::TransferShape& shape,
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
      energies(size, vectors.size() / size, [&](std::size_t at) { return double{vectors[at]}; });
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

double transferEnergy(std::span<const float> vectors, const bundle::TransferShape& shape,
                      const BandPower& kernel_power) {
  const std::vector<double> roots = bandRoots(shape, kernel_power);
  const auto energy = energies(shape.size(), vectors.size() / shape.size(),
                               [&](std::size_t at) { return double{vectors[at]}; });
  double sum = 0.0;
  for (std::size_t i = 0; i < roots.size(); ++i) sum += roots[i] * roots[i] * energy[i];
  return channelWeight(shape) * sum;
}

WeightedSpace weightedSpace(std::span<const float> vectors, const bundle::TransferShape& shape,
                            double shown_energy, const BandPower& kernel_power) {
  WeightedSpace space{normalisedRoots(vectors, shape, shown_energy, kernel_power), 1.0};
  if (shape.full_channels > 0 && shape.shadowed_channels > 0) {
    for (std::size_t i = 0; i < shadowedSize(shape); ++i) space.roots[i] *= kShadowedRoot;
    space.blocks += kShadowedRoot * kShadowedRoot;
  }
  return space;
}

double radianceError(std::span<const float> truth, std::span<const float> coded,
                     const bundle::TransferShape& shape, double shown_energy, const BandPower& kernel_power) {
  const std::size_t size = shape.size();
  assert(truth.size() == coded.size() && truth.size() % size == 0);
  const std::vector<double> roots = normalisedRoots(truth, shape, shown_energy, kernel_power);
  const auto off = energies(size, truth.size() / size,
                            [&](std::size_t at) { return double{coded[at]} - double{truth[at]}; });
  double worst = 0.0;
  for (const Block& block : blocksOf(shape)) {
    double sum = 0.0;
    // Where the truth has no energy there is nothing to be relative to: the error counts as it is.
    for (std::size_t i = block.first; i < block.last; ++i)
      sum += (roots[i] > 0.0 ? roots[i] * roots[i] : 1.0) * off[i];
    // NaN is the worst, and stays.
    if (const double own = std::sqrt(sum); std::isnan(own) || own > worst) worst = own;
  }
  return worst;
}

}  // namespace lambent::baker
