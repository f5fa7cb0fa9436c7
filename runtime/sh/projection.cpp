#include "runtime/sh/projection.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstring>
#include <memory>
#include <numbers>

#include <glm/geometric.hpp>

#include "runtime/sh/image_layout.hpp"

namespace lambent::sh {

LightVector projectImage(int order, ImageLayout layout, int width, int height,
                         std::span<const glm::vec3> texels, ProjectionReport* report) {
  assert(texels.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const auto count = static_cast<std::size_t>(coefficientCount(order));
  ProjectionReport seen;
  std::array<std::array<double, kMaxCoefficients>, 3> sum{};
  std::array<double, kMaxCoefficients> basis;

  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double solid_angle_sr = texelSolidAngle(layout, width, height, x, y);
      if (solid_angle_sr <= 0) continue;
      ++seen.covered_texels;
      seen.solid_angle_sr += solid_angle_sr;

      const glm::vec3& radiance =
          texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
      if (!std::isfinite(radiance.r) || !std::isfinite(radiance.g) || !std::isfinite(radiance.b)) {
        ++seen.replaced_texels;
        continue;
      }
      if (radiance.r < 0 || radiance.g < 0 || radiance.b < 0) ++seen.negative_texels;

      evaluate(order, texelDirection(layout, width, height, x, y), basis);
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const double weight = static_cast<double>(radiance[static_cast<int>(channel)]) * solid_angle_sr;
        for (std::size_t i = 0; i < count; ++i) sum[channel][i] += weight * basis[i];
      }
    }
  }

  if (report) *report = seen;
  LightVector light{.order = order};
  for (std::size_t i = 0; i < count; ++i) light.c[i] = glm::vec3(glm::dvec3(sum[0][i], sum[1][i], sum[2][i]));
  return light;
}

namespace {

// Nodes and weights of 6-point Gauss-Legendre quadrature on [-1, 1]. Integrands are smooth over a texel: 6 x
// 6 points give the means of y to 1e-4 for a whole face, and up to rounding for faces of 4 or more texels per
// edge.
struct GaussNode {
  double at, weight;
};
constexpr std::array<GaussNode, 6> kGauss = {{{-0.93246951420315203, 0.17132449237917035},
                                              {-0.66120938646626451, 0.36076157304813861},
                                              {-0.23861918608319691, 0.46791393457269105},
                                              {0.23861918608319691, 0.46791393457269105},
                                              {0.66120938646626451, 0.36076157304813861},
                                              {0.93246951420315203, 0.17132449237917035}}};

// Writes Omega (2 y(centre) - mean y) of a texel for all coefficients.
void sharpenedWeights(int order, int size, int face, int x, int y, std::span<double> weights) {
  const double half = 1.0 / size;
  const double sc = 2 * (x + 0.5) / size - 1, tc = 2 * (y + 0.5) / size - 1;
  const auto count = static_cast<std::size_t>(coefficientCount(order));
  const double solid_angle_sr = cubeTexelSolidAngle(size, x, y);

  std::array<double, kMaxCoefficients> basis, integral{};
  double area = 0;
  for (const GaussNode& u : kGauss) {
    for (const GaussNode& v : kGauss) {
      const glm::dvec3 dir = cubeFaceDirection(face, sc + half * u.at, tc + half * v.at);
      const double squared = glm::dot(dir, dir), length = std::sqrt(squared);
      const double weight = u.weight * v.weight / (squared * length);
      evaluate(order, dir / length, basis);
      area += weight;
      for (std::size_t i = 0; i < count; ++i) integral[i] += weight * basis[i];
    }
  }
  evaluate(order, cubeTexelDirection(size, face, x, y), basis);
  for (std::size_t i = 0; i < count; ++i) weights[i] = solid_angle_sr * (2 * basis[i] - integral[i] / area);
}

// Corrects the sharpened weights, so that uniform light has no coefficient except the first. Without this,
// weights of bands 4 and up that share the cube's symmetry sum to slightly more than 0 over the whole cube.
class TexelWeights {
 public:
  TexelWeights(int order, int size) : order_(order), size_(size) {
    std::array<double, kMaxCoefficients> weights;
    for (int face = 0; face < 6; ++face)
      for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
          sharpenedWeights(order, size, face, x, y, weights);
          for (std::size_t i = 1; i < static_cast<std::size_t>(coefficientCount(order)); ++i)
            excess_[i] += weights[i] / (4 * std::numbers::pi);
        }
  }
  void at(int face, int x, int y, std::span<double> weights) const {
    sharpenedWeights(order_, size_, face, x, y, weights);
    const double solid_angle_sr = cubeTexelSolidAngle(size_, x, y);
    for (std::size_t i = 1; i < static_cast<std::size_t>(coefficientCount(order_)); ++i)
      weights[i] -= excess_[i] * solid_angle_sr;
  }

 private:
  int order_, size_;
  std::array<double, kMaxCoefficients> excess_{};  // per steradian
};

constexpr int kLanes = 8;
using Lanes = float __attribute__((vector_size(kLanes * sizeof(float))));

Lanes load(const float* from) {
  Lanes lanes;
  std::memcpy(&lanes, from, sizeof lanes);
  return lanes;
}
float total(const Lanes& lanes) {
  return ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) + ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]));
}

// Computes three channels of `Count` coefficients of one parity class, each as a dot product over folded
// texels. `weights` has Count rows of `length`, `folded` three channels of `length`.
template <int Count>
void dotProducts(const float* weights, const float* folded, std::size_t length, const int* coefficients,
                 LightVector& light) {
  Lanes sum[Count][3] = {};
  for (std::size_t k = 0; k < length; k += kLanes) {
    const Lanes red = load(folded + k), green = load(folded + length + k),
                blue = load(folded + 2 * length + k);
    for (int i = 0; i < Count; ++i) {
      const Lanes weight = load(weights + static_cast<std::size_t>(i) * length + k);
      sum[i][0] += weight * red;
      sum[i][1] += weight * green;
      sum[i][2] += weight * blue;
    }
  }
  for (int i = 0; i < Count; ++i)
    light.c[static_cast<std::size_t>(coefficients[i])] = {total(sum[i][0]), total(sum[i][1]),
                                                          total(sum[i][2])};
}

// Returns the parity of y_lm in x, y and z as the bits 1, 2 and 4, which are set if it is odd.
int parity(int l, int m) {
  const int odd_y = m < 0 ? 1 : 0;
  const int odd_x = (std::abs(m) + odd_y) & 1;
  const int odd_z = (l - std::abs(m)) & 1;
  return odd_x | odd_y << 1 | odd_z << 2;
}

// Describes the orientation of a face: sc runs along axis_of_sc (0, 1, 2 for x, y, z), or against it if
// flipped; tc likewise.
struct FaceAxes {
  int axis_of_sc, axis_of_tc;
  bool sc_flipped, tc_flipped;
};
constexpr std::array<FaceAxes, 6> kFaceAxes = {{{2, 1, true, true},
                                                {2, 1, false, true},
                                                {0, 2, false, false},
                                                {0, 2, false, true},
                                                {0, 1, false, true},
                                                {0, 1, true, true}}};

std::size_t roundedUp(std::size_t count) {
  return (count + kLanes - 1) / kLanes * kLanes;
}

// Folds a pair of rows: computes sums and differences of each four texels of a face that mirror each other,
// for the first `half` columns. `plus` and `minus` are the rows on the positive and negative side of tc's
// axis, with `size` texels each. to[odd_sc + 2 odd_tc] points to the first of `half` red values; green and
// blue values follow at channel_step.
using FoldTargets = std::array<float*, 4>;

template <typename Value, typename Store>
void foldFour(const Value& plus_low, const Value& plus_high, const Value& minus_low, const Value& minus_high,
              float sign, Store&& store) {
  const Value low_even = plus_low + minus_low, low_odd = plus_low - minus_low;
  const Value high_even = plus_high + minus_high, high_odd = plus_high - minus_high;
  store(0, high_even + low_even);
  store(1, sign * (high_even - low_even));
  store(2, high_odd + low_odd);
  store(3, sign * (high_odd - low_odd));
}

// Holds two rows of `size` texels that mirror each other.
struct RowPair {
  const glm::vec3 *plus, *minus;
  std::size_t size;
};

void foldColumns(const RowPair& rows, std::size_t first, float sign, const FoldTargets& to,
                 std::size_t channel_step) {
  const auto& [plus, minus, size] = rows;
  for (std::size_t c = first; c < (size + 1) / 2; ++c)
    foldFour(plus[c], plus[size - 1 - c], minus[c], minus[size - 1 - c], sign,
             [&](std::size_t p, const glm::vec3& sum) {
               for (std::size_t channel = 0; channel < 3; ++channel)
                 to[p][channel * channel_step + c] = sum[static_cast<int>(channel)];
             });
}

// Holds eight texels as three SIMD vectors of one channel each.
struct Texels {
  Lanes red, green, blue;
};
Texels loadTexels(const glm::vec3* from) {
  const Lanes a = load(&from->x), b = load(&from->x + 8), c = load(&from->x + 16);
  const Lanes red = __builtin_shufflevector(a, b, 0, 3, 6, 9, 12, 15, -1, -1);
  const Lanes green = __builtin_shufflevector(a, b, 1, 4, 7, 10, 13, -1, -1, -1);
  const Lanes blue = __builtin_shufflevector(a, b, 2, 5, 8, 11, 14, -1, -1, -1);
  return {__builtin_shufflevector(red, c, 0, 1, 2, 3, 4, 5, 10, 13),
          __builtin_shufflevector(green, c, 0, 1, 2, 3, 4, 8, 11, 14),
          __builtin_shufflevector(blue, c, 0, 1, 2, 3, 4, 9, 12, 15)};
}
Lanes reversed(const Lanes& lanes) {
  return __builtin_shufflevector(lanes, lanes, 7, 6, 5, 4, 3, 2, 1, 0);
}

void foldRows(const glm::vec3* plus, const glm::vec3* minus, std::size_t size, bool sc_flipped,
              const FoldTargets& to, std::size_t channel_step) {
  const float sign = sc_flipped ? -1.0f : 1.0f;
  std::size_t c = 0;
  for (; c + kLanes <= size / 2; c += kLanes) {
    const Texels plus_low = loadTexels(plus + c), plus_high = loadTexels(plus + size - kLanes - c);
    const Texels minus_low = loadTexels(minus + c), minus_high = loadTexels(minus + size - kLanes - c);
    const auto fold = [&](Lanes Texels::*channel, std::size_t offset) {
      foldFour(plus_low.*channel, reversed(plus_high.*channel), minus_low.*channel,
               reversed(minus_high.*channel), sign,
               [&](std::size_t p, const Lanes& sum) { std::memcpy(to[p] + offset + c, &sum, sizeof sum); });
    };
    fold(&Texels::red, 0);
    fold(&Texels::green, channel_step);
    fold(&Texels::blue, 2 * channel_step);
  }
  foldColumns({plus, minus, size}, c, sign, to, channel_step);
}

}  // namespace

std::vector<float> cubeWeights(int order, int size) {
  assert(order >= 1 && order <= kMaxOrder && size >= 1);
  const auto count = static_cast<std::size_t>(coefficientCount(order));
  const auto edge = static_cast<std::size_t>(size);
  std::vector<float> table(count * 6 * edge * edge);
  const TexelWeights texel_weights(order, size);
  std::array<double, kMaxCoefficients> weights;
  std::size_t k = 0;
  for (int face = 0; face < 6; ++face)
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x, ++k) {
        texel_weights.at(face, x, y, weights);
        for (std::size_t i = 0; i < count; ++i)
          table[i * 6 * edge * edge + k] = static_cast<float>(weights[i]);
      }
  return table;
}

CubeProjector::CubeProjector(int order, int size) : order_(order), size_(size) {
  assert(order >= 1 && order <= kMaxOrder && size >= 1);
  const auto half = static_cast<std::size_t>((size + 1) / 2);
  folded_count_ = roundedUp(3 * half * half);

  for (int l = 0; l < order; ++l)
    for (int m = -l; m <= l; ++m)
      classes_[static_cast<std::size_t>(parity(l, m))].coefficients.push_back(coefficientIndex(l, m));
  std::size_t rows = 0;
  for (ParityClass& parity_class : classes_) {
    parity_class.first_weight = rows * folded_count_;
    rows += parity_class.coefficients.size();
  }
  weights_.assign(rows * folded_count_, 0.0f);

  // Weights are needed for the octant x, y, z > 0 only. In the middle row or column of an odd size a texel is
  // its own mirror image and is added to itself, so it gets half the weight.
  const TexelWeights texel_weights(order, size);
  std::array<double, kMaxCoefficients> weights;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int face = static_cast<int>(2 * axis);
    const FaceAxes& axes = kFaceAxes[2 * axis];
    for (std::size_t r = 0; r < half; ++r)
      for (std::size_t c = 0; c < half; ++c) {
        const int row = static_cast<int>(r), column = static_cast<int>(c);
        texel_weights.at(face, axes.sc_flipped ? column : size - 1 - column,
                         axes.tc_flipped ? row : size - 1 - row, weights);
        const double share = (2 * column + 1 == size ? 0.5 : 1.0) * (2 * row + 1 == size ? 0.5 : 1.0);
        for (const ParityClass& parity_class : classes_)
          for (std::size_t i = 0; i < parity_class.coefficients.size(); ++i)
            weights_[parity_class.first_weight + i * folded_count_ + (axis * half + r) * half + c] =
                static_cast<float>(share * weights[static_cast<std::size_t>(parity_class.coefficients[i])]);
      }
  }
}

LightVector CubeProjector::project(std::span<const glm::vec3> faces) const {
  const auto size = static_cast<std::size_t>(size_), half = (size + 1) / 2;
  assert(faces.size() == 6 * size * size);
  const std::size_t class_step = 3 * folded_count_;  // size of the RGB sums of one parity class
  const auto folded = std::make_unique_for_overwrite<float[]>(8 * class_step);
  // Both faces of an axis are folded in their own planes: [face][parity in sc, tc][channel][row][column].
  const std::size_t plane = half * half;
  const auto planes = std::make_unique_for_overwrite<float[]>(2 * 4 * 3 * plane);

  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t side = 0; side < 2; ++side) {
      const FaceAxes& axes = kFaceAxes[2 * axis + side];
      const glm::vec3* face = faces.data() + (2 * axis + side) * size * size;
      for (std::size_t r = 0; r < half; ++r) {
        const glm::vec3* low = face + r * size;
        const glm::vec3* high = face + (size - 1 - r) * size;
        float* to = planes.get() + side * 12 * plane + r * half;
        foldRows(axes.tc_flipped ? low : high, axes.tc_flipped ? high : low, size, axes.sc_flipped,
                 {to, to + 3 * plane, to + 6 * plane, to + 9 * plane}, plane);
      }
    }
    const int bit = 1 << axis;
    const int bit_sc = 1 << kFaceAxes[2 * axis].axis_of_sc, bit_tc = 1 << kFaceAxes[2 * axis].axis_of_tc;
    for (int p = 0; p < 4; ++p) {
      const int in_plane = (p & 1 ? bit_sc : 0) | (p & 2 ? bit_tc : 0);
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const float* __restrict plus = planes.get() + (static_cast<std::size_t>(p) * 3 + channel) * plane;
        const float* __restrict minus = plus + 12 * plane;
        float* const at = folded.get() + channel * folded_count_ + axis * plane;
        float* __restrict even = at + static_cast<std::size_t>(in_plane) * class_step;
        float* __restrict odd = at + static_cast<std::size_t>(in_plane | bit) * class_step;
        for (std::size_t k = 0; k < plane; ++k) {
          even[k] = plus[k] + minus[k];
          odd[k] = plus[k] - minus[k];
        }
      }
    }
  }
  for (std::size_t row = 0; row < 8 * 3; ++row)
    std::fill(folded.get() + row * folded_count_ + 3 * plane, folded.get() + (row + 1) * folded_count_, 0.0f);

  LightVector light{.order = order_};
  for (std::size_t p = 0; p < classes_.size(); ++p) {
    const ParityClass& parity_class = classes_[p];
    const float* sums = folded.get() + p * class_step;
    const std::size_t count = parity_class.coefficients.size();
    for (std::size_t i = 0; i < count; i += 4) {
      const float* weights = weights_.data() + parity_class.first_weight + i * folded_count_;
      const int* coefficients = parity_class.coefficients.data() + i;
      switch (std::min<std::size_t>(count - i, 4)) {
        case 1:
          dotProducts<1>(weights, sums, folded_count_, coefficients, light);
          break;
        case 2:
          dotProducts<2>(weights, sums, folded_count_, coefficients, light);
          break;
        case 3:
          dotProducts<3>(weights, sums, folded_count_, coefficients, light);
          break;
        case 4:
          dotProducts<4>(weights, sums, folded_count_, coefficients, light);
          break;
      }
    }
  }
  return light;
}

}  // namespace lambent::sh
