#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstring>
#include <memory>

#include <glm/geometric.hpp>

#include "runtime/sh/cube_map.hpp"
#include "runtime/sh/projection.hpp"

namespace lambent::sh {

namespace {

// Nodes and weights of 6-point Gauss-Legendre quadrature on [-1, 1]. Over one texel the integrands are smooth
// (their singularities lie at imaginary distance 1), so that 6 x 6 points are exact to 1e-7 for a whole face
// and to rounding from 4 texels an edge on.
struct GaussNode {
  double at, weight;
};
constexpr std::array<GaussNode, 6> kGauss = {{{-0.93246951420315203, 0.17132449237917035},
                                              {-0.66120938646626451, 0.36076157304813861},
                                              {-0.23861918608319691, 0.46791393457269105},
                                              {0.23861918608319691, 0.46791393457269105},
                                              {0.66120938646626451, 0.36076157304813861},
                                              {0.93246951420315203, 0.17132449237917035}}};

// Omega (2 y(centre) - mean y) of one texel for all coefficients.
void texelWeights(int order, int size, int face, int x, int y, std::span<double> weights) {
  const double half = 1.0 / size;
  const double sc = 2 * (x + 0.5) / size - 1, tc = 2 * (y + 0.5) / size - 1;
  const auto count = static_cast<std::size_t>(coefficientCount(order));
  const double solid_angle_sr = cubeTexelSolidAngle(size, x, y);

  std::array<double, kMaxCoefficients> basis;
  evaluate(order, cubeTexelDirection(size, face, x, y), basis);
  for (std::size_t i = 0; i < count; ++i) weights[i] = 2 * solid_angle_sr * basis[i];
  for (const GaussNode& u : kGauss) {
    for (const GaussNode& v : kGauss) {
      const glm::dvec3 dir = cubeFaceDirection(face, sc + half * u.at, tc + half * v.at);
      const double squared = glm::dot(dir, dir);
      const double area = half * half * u.weight * v.weight / (squared * std::sqrt(squared));
      evaluate(order, dir / std::sqrt(squared), basis);
      for (std::size_t i = 0; i < count; ++i) weights[i] -= area * basis[i];
    }
  }
}

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

// Count coefficients of one parity class times three channels, each a dot product over the folded texels.
// weights: Count rows of `length`; folded: three channels of `length`.
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

// Parity of y_lm under x -> -x, y -> -y, z -> -z as bits 1, 2, 4 (set: odd).
int parity(int l, int m) {
  const int odd_y = m < 0 ? 1 : 0;
  const int odd_x = (std::abs(m) + odd_y) & 1;
  const int odd_z = (l - std::abs(m)) & 1;
  return odd_x | odd_y << 1 | odd_z << 2;
}

// How a face lies on the axes: sc runs along axis_of_sc (0, 1, 2 for x, y, z), or against it where flipped.
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

// Sums and differences of the texels of one row pair that mirror each other: four parities of one face.
// plus and minus are the rows on the positive and negative side of tc's axis, `size` texels each.
// to[odd_sc + 2 odd_tc] points to the first of `half` numbers of the red channel; the others follow at
// `channel_step`.
void foldRows(const glm::vec3* plus, const glm::vec3* minus, std::size_t size, bool sc_flipped,
              const std::array<float*, 4>& to, std::size_t channel_step) {
  const std::size_t half = (size + 1) / 2;
  const float sign = sc_flipped ? -1.0f : 1.0f;
  const float* __restrict plus_flat = &plus->x;
  const float* __restrict minus_flat = &minus->x;
  for (std::size_t channel = 0; channel < 3; ++channel) {
    float* __restrict even_even = to[0] + channel * channel_step;
    float* __restrict odd_even = to[1] + channel * channel_step;
    float* __restrict even_odd = to[2] + channel * channel_step;
    float* __restrict odd_odd = to[3] + channel * channel_step;
    for (std::size_t c = 0; c < half; ++c) {
      const std::size_t low = 3 * c + channel, high = 3 * (size - 1 - c) + channel;
      const float low_even = plus_flat[low] + minus_flat[low], low_odd = plus_flat[low] - minus_flat[low];
      const float high_even = plus_flat[high] + minus_flat[high],
                  high_odd = plus_flat[high] - minus_flat[high];
      even_even[c] = high_even + low_even;
      odd_even[c] = sign * (high_even - low_even);
      even_odd[c] = high_odd + low_odd;
      odd_odd[c] = sign * (high_odd - low_odd);
    }
  }
}

}  // namespace

std::vector<float> cubeWeights(int order, int size) {
  assert(order >= 1 && order <= kMaxOrder && size >= 1);
  const auto count = static_cast<std::size_t>(coefficientCount(order));
  const auto edge = static_cast<std::size_t>(size);
  std::vector<float> table(count * 6 * edge * edge);
  std::array<double, kMaxCoefficients> weights;
  std::size_t k = 0;
  for (int face = 0; face < 6; ++face)
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x, ++k) {
        texelWeights(order, size, face, x, y, weights);
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

  // The weight of each texel of the octant x, y, z > 0. In the middle row or column of an odd size a texel is
  // its own mirror image and is added to itself: half the weight.
  std::array<double, kMaxCoefficients> weights;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int face = static_cast<int>(2 * axis);
    const FaceAxes& axes = kFaceAxes[2 * axis];
    for (std::size_t r = 0; r < half; ++r)
      for (std::size_t c = 0; c < half; ++c) {
        const int row = static_cast<int>(r), column = static_cast<int>(c);
        texelWeights(order, size, face, axes.sc_flipped ? column : size - 1 - column,
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
  const std::size_t class_step = 3 * folded_count_;  // red, green and blue sums of one parity class
  const auto folded = std::make_unique_for_overwrite<float[]>(8 * class_step);
  // Two faces of an axis, folded in their own planes: [face][parity in sc, tc][channel][column].
  const auto rows = std::make_unique_for_overwrite<float[]>(2 * 4 * 3 * half);

  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t r = 0; r < half; ++r) {
      for (std::size_t side = 0; side < 2; ++side) {
        const FaceAxes& axes = kFaceAxes[2 * axis + side];
        const glm::vec3* face = faces.data() + (2 * axis + side) * size * size;
        const glm::vec3* low = face + r * size;
        const glm::vec3* high = face + (size - 1 - r) * size;
        float* to = rows.get() + side * 12 * half;
        foldRows(axes.tc_flipped ? low : high, axes.tc_flipped ? high : low, size, axes.sc_flipped,
                 {to, to + 3 * half, to + 6 * half, to + 9 * half}, half);
      }
      const int bit = 1 << axis, bit_sc = 1 << kFaceAxes[2 * axis].axis_of_sc,
                bit_tc = 1 << kFaceAxes[2 * axis].axis_of_tc;
      for (int p = 0; p < 4; ++p) {
        const int in_plane = (p & 1 ? bit_sc : 0) | (p & 2 ? bit_tc : 0);
        for (std::size_t channel = 0; channel < 3; ++channel) {
          const float* __restrict plus = rows.get() + (static_cast<std::size_t>(p) * 3 + channel) * half;
          const float* __restrict minus = plus + 12 * half;
          float* const at = folded.get() + channel * folded_count_ + (axis * half + r) * half;
          float* __restrict even = at + static_cast<std::size_t>(in_plane) * class_step;
          float* __restrict odd = at + static_cast<std::size_t>(in_plane | bit) * class_step;
          for (std::size_t c = 0; c < half; ++c) {
            even[c] = plus[c] + minus[c];
            odd[c] = plus[c] - minus[c];
          }
        }
      }
    }
  }
  for (std::size_t row = 0; row < 8 * 3; ++row)
    std::fill(folded.get() + row * folded_count_ + 3 * half * half, folded.get() + (row + 1) * folded_count_,
              0.0f);

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
