#include "runtime/bundle/brdf_table.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

#include "runtime/base/payload_bytes.hpp"

namespace lambent::bundle {

namespace {

constexpr std::uint32_t kMaxBands = 6;
constexpr std::uint32_t kMaxNodes = 1024;                     // per axis
constexpr std::uint64_t kMaxValues = std::uint64_t{1} << 25;  // over all nodes
// Code of the largest value of a lobe. The rounding error is 1e-4 of that value, less than the error of
// interpolation, and the payload compresses to two thirds of the size that codes with all 16 bits need.
constexpr float kCodeMax = 5000.0f;
// Rounding of codes may lift an albedo of 1 by this much.
constexpr float kAlbedoSlack = 1e-3f;

// Describes a position between two nodes of an axis.
struct Between {
  std::size_t first = 0, second = 0;
  float share = 0.0f;  // weight of the second node
};

Between between(float position, std::uint32_t nodes) {
  const auto last = static_cast<float>(nodes - 1);
  const float clamped = position > 0.0f ? std::min(position, last) : 0.0f;  // NaN is not over 0
  const auto first = static_cast<std::size_t>(clamped);
  return {first, std::min(first + 1, std::size_t{nodes} - 1), clamped - static_cast<float>(first)};
}

float at(float unit, std::uint32_t nodes) {
  return unit * static_cast<float>(nodes - 1);
}

// Calls add(first value of a node, weight) for each node that interpolation at this point needs.
template <typename Add>
void forNodesAround(const BrdfTable& table, const BrdfView& view, float roughness, float strength,
                    Add&& add) {
  float azimuth = 0.0f;
  if (!table.isotropic())
    azimuth =
        std::atan2(std::abs(view.sin_phi), std::abs(view.cos_phi)) * (2.0f * std::numbers::inv_pi_v<float>);
  const Between s = between(at(strength, table.strengths), table.strengths),
                r = between(at(roughness, table.roughnesses), table.roughnesses),
                p = between(at(azimuth, table.azimuths), table.azimuths),
                a = between(at(angleAxis(view.cos_theta), table.angles), table.angles);
  const auto both = [](const Between& axis, auto&& f) {
    f(axis.first, 1.0f - axis.share);
    if (axis.share > 0.0f) f(axis.second, axis.share);
  };
  both(s, [&](std::size_t i, float weight_s) {
    both(r, [&](std::size_t j, float weight_r) {
      both(p, [&](std::size_t k, float weight_p) {
        const std::size_t row = ((i * table.roughnesses + j) * table.azimuths + k) * table.angles;
        both(a, [&](std::size_t angle, float weight_a) {
          add(table.values.data() + (row + angle) * table.nodeValues(),
              weight_s * weight_r * weight_p * weight_a);
        });
      });
    });
  });
}

}  // namespace

void lookUpStored(const BrdfTable& table, const BrdfView& view, float roughness, float strength,
                  std::span<float> out) {
  const std::size_t count = table.nodeValues();
  assert(out.size() >= count && table.values.size() == table.nodes() * count);
  std::fill_n(out.begin(), count, 0.0f);
  forNodesAround(table, view, roughness, strength, [&](const float* node, float weight) {
    for (std::size_t k = 0; k < count; ++k) out[k] += weight * node[k];
  });
  if (table.isotropic()) return;
  // Reflecting the view in the tangent or the bitangent flips the y axis of its frame, so sin(|m| phi)
  // changes its sign.
  if (view.cos_phi * view.sin_phi >= 0.0f) return;
  std::size_t k = 0;
  for (std::uint32_t lobe = 0; lobe < table.lobes; ++lobe)
    for (int l = 0; l < static_cast<int>(table.order); ++l)
      for (int m = -l; m <= l; ++m, ++k)
        if (m < 0) out[k] = -out[k];
}

void lookUp(const BrdfTable& table, const BrdfView& view, float roughness, float strength,
            std::span<float> out) {
  std::array<float, kMaxBrdfLobes * kMaxBands * kMaxBands> stored;
  lookUpStored(table, view, roughness, strength, stored);
  const std::size_t all = std::size_t{table.order} * table.order;
  assert(out.size() >= table.lobes * all);
  if (!table.isotropic()) {
    std::copy_n(stored.begin(), table.lobes * all, out.begin());
    return;
  }
  std::fill_n(out.begin(), table.lobes * all, 0.0f);
  const float* next = stored.data();
  for (std::size_t lobe = 0; lobe < table.lobes; ++lobe)
    for (std::size_t l = 0; l < table.order; ++l)
      for (std::size_t m = 0; m <= l; ++m) out[lobe * all + l * (l + 1) + m] = *next++;
}

std::vector<std::byte> encodeBrdfTable(const BrdfTable& table) {
  assert(table.values.size() == table.nodes() * table.nodeValues());
  const std::array<std::uint32_t, 6> head = {table.order,    table.lobes,       table.angles,
                                             table.azimuths, table.roughnesses, table.strengths};
  const std::size_t count = table.coefficients(), lobes = table.values.size() / count;
  std::vector<float> scales;
  std::vector<std::uint16_t> codes;
  for (std::size_t lobe = 0; lobe < lobes; ++lobe) {
    const auto values = std::span(table.values).subspan(lobe * count, count);
    float largest = 0.0f;
    for (const float value : values) largest = std::max(largest, std::abs(value));
    const float scale = largest / kCodeMax;
    scales.push_back(scale);
    for (const float value : values)
      codes.push_back(static_cast<std::uint16_t>(scale > 0.0f ? std::lround(value / scale) : 0l));
  }
  std::vector<std::byte> out;
  appendValues<std::uint32_t>(out, head);
  appendValues<float>(out, scales);
  appendSplit(out, codes);
  return out;
}

Result<BrdfTable> decodeBrdfTable(std::span<const std::byte> bytes, const std::string& subject) {
  const auto damaged = [&](const char* why) {
    return fail(subject, std::string("has a damaged BRDF table: ") + why, kCopyAgain);
  };
  Front front(bytes);
  const auto head = front.values<std::uint32_t>(6);
  if (head.size() != 6) return damaged("too short");
  BrdfTable table{.order = head[0],
                  .lobes = head[1],
                  .angles = head[2],
                  .azimuths = head[3],
                  .roughnesses = head[4],
                  .strengths = head[5],
                  .values = {}};
  if (table.order < 1 || table.order > kMaxBands || table.lobes < 2 || table.lobes > kMaxBrdfLobes)
    return damaged("bands or lobes out of range");
  if (table.angles < 2) return damaged("fewer than two view angles");
  std::uint64_t values = table.nodeValues();
  for (std::size_t axis = 2; axis < head.size(); ++axis) {
    if (head[axis] < 1 || head[axis] > kMaxNodes) return damaged("an axis out of range");
    values *= head[axis];
    if (values > kMaxValues) return damaged("too many nodes");
  }
  if (table.isotropic() && table.strengths > 1) return damaged("isotropic, but with strengths of anisotropy");

  const std::size_t count = table.coefficients(), lobes = table.nodes() * table.lobes;
  const auto scales = front.values<float>(lobes);
  const auto codes = front.split(values);
  if (scales.size() != lobes || codes.size() != values) return damaged("too short");
  if (!front.whole()) return damaged("too long");
  table.values.resize(values);
  for (std::size_t lobe = 0; lobe < lobes; ++lobe) {
    // No coefficient of b is over sqrt(11 / 4 pi). NaN fails every comparison.
    if (!(scales[lobe] >= 0.0f && scales[lobe] <= 1.0f)) return damaged("a value out of range");
    for (std::size_t k = lobe * count; k < (lobe + 1) * count; ++k) {
      table.values[k] = scales[lobe] * static_cast<float>(static_cast<std::int16_t>(codes[k]));
      if (!(std::abs(table.values[k]) <= 1.0f)) return damaged("a value out of range");
    }
  }
  // The lobes of F0 and F90 are summed to an albedo; red, green and blue each have their own.
  const float whole = 2.0f * std::sqrt(std::numbers::pi_v<float>);
  const std::size_t part = table.lobes == 2 ? 2 : 1;
  for (std::size_t lobe = 0; lobe < lobes; lobe += part) {
    float albedo = 0.0f;
    for (std::size_t k = lobe; k < lobe + part; ++k) {
      if (table.values[k * count] < 0.0f) return damaged("a negative albedo");
      albedo += whole * table.values[k * count];
    }
    if (albedo > 1.0f + kAlbedoSlack) return damaged("an albedo over 1");
  }
  return table;
}

}  // namespace lambent::bundle
