#include "baker/effects/neighborhood/receiver_meter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "runtime/sh/basis.hpp"
#include "runtime/sh/gaunt.hpp"

namespace lambent::baker {

namespace {

constexpr int kCosineBands = 3;
constexpr double kCosine[kCosineBands] = {1.0, 2.0 / 3.0, 1.0 / 4.0};  // A_l / pi

double cosineOf(std::size_t i) {
  return kCosine[sh::bandOf(static_cast<int>(i))];
}

}  // namespace

ReceiverMeter::ReceiverMeter(const ChangeShape& shape, const FacingArea& facing) : shape_(shape) {
  const std::size_t columns = shape.columns();
  const sh::GauntTable gaunt = sh::makeGauntTable(shape.order, kCosineBands);
  for (std::size_t i = 0; i < kOutputs; ++i)
    for (std::uint32_t t = gaunt.offsets[i]; t < gaunt.offsets[i + 1]; ++t)
      terms_.push_back({static_cast<std::uint32_t>(i * columns) + gaunt.terms[t].j, gaunt.terms[t].k,
                        gaunt.terms[t].value});
  for (std::size_t j = 0; j < columns; ++j)
    light_power_.push_back(kBandPower[static_cast<std::size_t>(sh::bandOf(static_cast<int>(j)))]);

  // The product of two functions of three bands has five, which is what `facing` has.
  constexpr double kY0 = 0.28209479177387814;
  const double area = double{facing[0]} / kY0;
  for (auto& row : seen_) row.fill(0.0);
  const sh::GauntTable products = sh::makeGauntTable(kCosineBands, kCosineBands);
  for (std::size_t i = 0; i < kOutputs; ++i)
    for (std::uint32_t t = products.offsets[i]; t < products.offsets[i + 1]; ++t) {
      const sh::GauntTerm& term = products.terms[t];
      const double mean = area > 0.0 ? double{facing[term.k]} / area : term.k == 0 ? kY0 : 0.0;
      seen_[i][term.j] += cosineOf(i) * cosineOf(term.j) * double{term.value} * mean;
    }
  for (std::size_t i = 0; i < kOutputs && i < columns; ++i)
    light_ += light_power_[i] * cosineOf(i) * cosineOf(i) / (4.0 * std::numbers::pi);
}

double ReceiverMeter::measure(std::span<const float> visibility, std::span<const float> bounced) const {
  const std::size_t columns = shape_.columns();
  std::vector<float> shadow(kOutputs * columns, 0.0f);
  for (const Term& term : terms_) shadow[term.at] += term.value * visibility[term.k];
  const std::size_t channels = bounced.empty() ? 1 : shape_.channels;
  double sum = 0.0;
  for (std::size_t c = 0; c < channels; ++c)
    for (std::size_t j = 0; j < columns; ++j) {
      std::array<double, kOutputs> change;
      for (std::size_t i = 0; i < kOutputs; ++i) {
        change[i] = double{shadow[i * columns + j]};
        if (!bounced.empty()) change[i] += double{bounced[(c * shape_.outputs() + i) * columns + j]};
      }
      for (std::size_t i = 0; i < kOutputs; ++i)
        for (std::size_t k = 0; k < kOutputs; ++k)
          sum += light_power_[j] * seen_[i][k] * change[i] * change[k];
    }
  return std::sqrt(std::max(sum, 0.0) / (static_cast<double>(channels) * light_));
}

}  // namespace lambent::baker
