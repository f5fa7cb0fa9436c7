#include "baker/effects/neighborhood/point_change.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <numbers>

#include "runtime/sh/basis.hpp"
#include "runtime/sh/gaunt.hpp"

namespace lambent::baker {

namespace {

constexpr double kInsideShare = 0.5;
constexpr BandPower kDiffusePower = {1.0, 4.0 / 9.0, 1.0 / 16.0, 0.0, 1.0 / 576.0, 0.0};
constexpr BandPower kShadowedPower = {1.0, 0.625, 0.25, 0.072, 0.019, 0.01};

}  // namespace

PointChange::PointChange(const Body& body, const CapDirections& directions, const ChangeShape& shape)
    : body_(body),
      directions_(directions),
      shape_(shape),
      harmonics_(shape.visibilitySize() * kPacketWidth),
      visibility_(shape.visibilitySize()),
      bounced_(shape.bouncedSize()),
      sums_(shape.bouncedSize()) {
  assert(shape.channels == 0 || shape.channels == body.channels());
  assert(shape.order == body.order());
  look_.sent.resize(kPacketWidth * shape.channels * shape.columns());
}

void PointChange::look(const glm::vec3& point) {
  cap_ = capOf(point, body_.centre(), body_.radius());
  weight_ = cap_.steradians() / static_cast<double>(directions_.size());
  std::fill(visibility_.begin(), visibility_.end(), 0.0f);
  std::fill(sums_.begin(), sums_.end(), 0.0f);
  backs_ = 0.0;
  nearest_back_ = std::numeric_limits<float>::infinity();
  std::array<float, kPacketWidth> x, y, z;
  for (std::size_t p = 0; p < directions_.packets(); ++p) {
    directions_.packet(p, cap_, along_);
    body_.look(point, along_, p * kPacketWidth, shape_.channels > 0, look_);
    const bool stops =
        std::any_of(look_.stopped.begin(), look_.stopped.end(), [](float s) { return s != 0.0f; });
    if (!stops && look_.sends == 0) continue;
    for (std::size_t k = 0; k < kPacketWidth; ++k) x[k] = along_[k].x, y[k] = along_[k].y, z[k] = along_[k].z;
    sh::evaluateBatch<float>(shape_.visibilityBands(), x.data(), y.data(), z.data(), kPacketWidth,
                             harmonics_.data(), kPacketWidth);
    addVisibility();
    if (shape_.channels > 0 && look_.sends != 0) addBounced();
    backs_ += weight_ * std::popcount(look_.backs);
    if (look_.backs != 0 && look_.nearest_back < nearest_back_)
      nearest_back_ = look_.nearest_back, nearest_point_ = look_.nearest_point,
      nearest_normal_ = look_.nearest_normal;
  }
  const std::size_t columns = shape_.columns(), row = shape_.channels * columns;
  for (std::size_t c = 0; c < shape_.channels; ++c)
    for (std::size_t i = 0; i < shape_.outputs(); ++i)
      for (std::size_t j = 0; j < columns; ++j)
        bounced_[(c * shape_.outputs() + i) * columns + j] = sums_[i * row + c * columns + j];
}

void PointChange::addVisibility() {
  const auto weight = static_cast<float>(weight_);
  for (std::size_t i = 0; i < visibility_.size(); ++i) {
    float sum = 0.0f;
    const float* of = harmonics_.data() + i * kPacketWidth;
    for (std::size_t k = 0; k < kPacketWidth; ++k) sum += of[k] * look_.stopped[k];
    visibility_[i] -= weight * sum;
  }
}

void PointChange::addBounced() {
  const std::size_t row = shape_.channels * shape_.columns();
  const auto weight = static_cast<float>(weight_);
  for (std::uint32_t left = look_.sends; left != 0; left &= left - 1) {
    const auto k = static_cast<std::size_t>(std::countr_zero(left));
    const float* sent = look_.sent.data() + k * row;
    for (std::size_t i = 0; i < shape_.outputs(); ++i) {
      const float factor = weight * harmonics_[i * kPacketWidth + k];
      float* out = sums_.data() + i * row;
      for (std::size_t j = 0; j < row; ++j) out[j] += factor * sent[j];
    }
  }
}

bool PointChange::inside() const {
  return backs_ > kInsideShare * 4.0 * std::numbers::pi;
}

const BandPower& receiverPower(const ChangeShape& shape) {
  return shape.order_out > kDiffuseBands ? kShadowedPower : kDiffusePower;
}

ChangeMeter::ChangeMeter(const ChangeShape& shape) : shape_(shape) {
  const sh::GauntTable gaunt = sh::makeGauntTable(shape.order, shape.order_out);
  const std::size_t columns = shape.columns();
  weights_.resize(shape.outputs() * columns);
  for (std::size_t i = 0; i < shape.outputs(); ++i) {
    const auto band_out = static_cast<std::size_t>(sh::bandOf(static_cast<int>(i)));
    for (std::uint32_t t = gaunt.offsets[i]; t < gaunt.offsets[i + 1]; ++t)
      terms_.push_back({static_cast<std::uint32_t>(i * columns) + gaunt.terms[t].j, gaunt.terms[t].k,
                        gaunt.terms[t].value});
    for (std::size_t j = 0; j < columns; ++j)
      weights_[i * columns + j] =
          static_cast<float>(receiverPower(shape)[band_out] *
                             kBandPower[static_cast<std::size_t>(sh::bandOf(static_cast<int>(j)))]);
    if (i < columns) light_ += double{weights_[i * columns + i]};
  }
}

double ChangeMeter::measure(std::span<const float> visibility, std::span<const float> bounced) const {
  std::vector<float> shadow(weights_.size(), 0.0f);
  for (const Term& term : terms_) shadow[term.at] += term.value * visibility[term.k];
  double sum = 0.0;
  const std::size_t channels = bounced.empty() ? 1 : shape_.channels;
  for (std::size_t c = 0; c < channels; ++c)
    for (std::size_t at = 0; at < shadow.size(); ++at) {
      const float change = shadow[at] + (bounced.empty() ? 0.0f : bounced[c * shadow.size() + at]);
      sum += double{weights_[at] * change * change};
    }
  return std::sqrt(sum / (static_cast<double>(channels) * light_));
}

double ChangeMeter::lightEnergy() const {
  return 3.0 * light_;
}

}  // namespace lambent::baker
