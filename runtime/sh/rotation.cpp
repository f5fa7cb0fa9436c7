#include "runtime/sh/rotation.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstring>

namespace lambent::sh {

namespace {

// A block is stored by columns: column j of D takes stride(l) consecutive numbers, padded with zeros to a
// multiple of 4. Applying D adds column j times in_j. Building it works on whole rows of the inverse's block,
// since D(R)^T = D(R^-1).
constexpr int stride(int l) {
  return l == 0 ? 1 : (2 * l + 1 + 3) / 4 * 4;
}
constexpr int bandOffset(int l) {
  int offset = 0;
  for (int k = 0; k < l; ++k) offset += (2 * k + 1) * stride(k);
  return offset;
}

// Holds the factors of Ivanic and Ruedenberg for row m of band l, without the part that depends only on the
// column. Row m is u P_0(m) + v_plus P_1(.) + v_minus P_-1(.) + w (P_1(.) +- P_-1(.)), as makeBand shows.
struct RowFactors {
  double u, v, w;
};
constexpr RowFactors rowFactors(int l, int m) {
  const int a = m < 0 ? -m : m;
  const double zero = m == 0 ? 1 : 0;
  return {.u = detail::constexprSqrt(1.0 * (l + m) * (l - m)),
          .v = 0.5 * detail::constexprSqrt((1 + zero) * (l + a - 1) * (l + a)) * (1 - 2 * zero),
          .w = -0.5 * detail::constexprSqrt(1.0 * (l - a - 1) * (l - a)) * (1 - zero)};
}
// Returns 1 / sqrt(denominator) for each column n.
template <int L>
constexpr std::array<double, static_cast<std::size_t>(stride(L))> columnFactors() {
  std::array<double, static_cast<std::size_t>(stride(L))> columns{};
  for (int n = -L; n <= L; ++n) {
    const bool edge = n == L || n == -L;
    columns[static_cast<std::size_t>(n + L)] =
        1 / detail::constexprSqrt(edge ? 2.0 * L * (2.0 * L - 1) : 1.0 * (L + n) * (L - n));
  }
  return columns;
}

// Computes band L from band L-1 and from band 1 in `first` (rows and columns m = -1, 0, 1). The recurrence is
// that of Ivanic and Ruedenberg with the two published errata (additions and corrections, 1998; the V term
// for m < 0). Like ours, their real harmonics have no Condon-Shortley sign in Cartesian form.
template <int L>
void makeBand(const std::array<std::array<double, 3>, 3>& first, const double* before, double* band) {
  constexpr int kRows = 2 * L - 1, kStride = stride(L), kBefore = stride(L - 1);
  static constexpr auto kColumnFactors = columnFactors<L>();

  // p[i + 1][a + L - 1] is the row P_i(a, .), scaled by the factors of the columns.
  double p[3][kRows][kStride] = {};
  for (int i = 0; i < 3; ++i) {
    const double r_minus = first[static_cast<std::size_t>(i)][0],
                 r_zero = first[static_cast<std::size_t>(i)][1],
                 r_plus = first[static_cast<std::size_t>(i)][2];
    for (int a = 0; a < kRows; ++a) {
      const double* row = before + a * kBefore;
      double* to = p[i][a];
      to[0] = (r_plus * row[0] + r_minus * row[2 * L - 2]) * kColumnFactors[0];
      for (int n = 1; n < 2 * L; ++n)
        to[n] = r_zero * row[n - 1] * kColumnFactors[static_cast<std::size_t>(n)];
      to[2 * L] = (r_plus * row[2 * L - 2] - r_minus * row[0]) * kColumnFactors[2 * L];
    }
  }
  const auto row_of = [&p](int i, int a) { return p[i + 1][a + L - 1]; };

  detail::unrolled(std::make_integer_sequence<int, 2 * L + 1>{}, [&](auto index) {
    constexpr int m = index - L;
    constexpr RowFactors f = rowFactors(L, m);
    double* to = band + (m + L) * kStride;
    for (int n = 0; n < kStride; ++n) {
      double sum = 0;
      if constexpr (m != L && m != -L) sum += f.u * row_of(0, m)[n];
      if constexpr (m == 0) {
        sum += f.v * (row_of(1, 1)[n] + row_of(-1, -1)[n]);
      } else if constexpr (m == 1 || m == -1) {
        sum += f.v * detail::constexprSqrt(2) * (m == 1 ? row_of(1, 0)[n] : row_of(-1, 0)[n]);
      } else if constexpr (m > 1) {
        sum += f.v * (row_of(1, m - 1)[n] - row_of(-1, -m + 1)[n]);
      } else {
        sum += f.v * (row_of(1, m + 1)[n] + row_of(-1, -m - 1)[n]);
      }
      if constexpr (m > 0 && m < L - 1) sum += f.w * (row_of(1, m + 1)[n] + row_of(-1, -m - 1)[n]);
      if constexpr (m < 0 && m > 1 - L) sum += f.w * (row_of(1, m - 1)[n] - row_of(-1, -m + 1)[n]);
      to[n] = sum;
    }
  });
}

// Computes out = D in for one band of coefficients with interleaved channels. Each column is read once for
// all channels.
template <int L, int Channels, typename T>
void applyBand(const T* columns, const T* in, T* out) {
  if constexpr (L == 0) {
    for (int channel = 0; channel < Channels; ++channel) out[channel] = in[channel];
  } else {
    using Lanes __attribute__((vector_size(4 * sizeof(T)))) = T;
    constexpr int kVectors = stride(L) / 4;
    Lanes sum[Channels][kVectors] = {};
    for (int j = 0; j < 2 * L + 1; ++j)
      for (int v = 0; v < kVectors; ++v) {
        Lanes column;
        std::memcpy(&column, columns + j * stride(L) + 4 * v, sizeof column);
        for (int channel = 0; channel < Channels; ++channel)
          sum[channel][v] += column * in[j * Channels + channel];
      }
    T rows[Channels][stride(L)];
    std::memcpy(rows, sum, sizeof rows);
    for (int i = 0; i < 2 * L + 1; ++i)
      for (int channel = 0; channel < Channels; ++channel) out[i * Channels + channel] = rows[channel][i];
  }
}

template <int Channels, typename T>
void applyBands(int order, const T* columns, const T* in, T* out) {
  detail::unrolled(std::make_integer_sequence<int, kMaxBasisOrder>{}, [&](auto l) {
    if (l < order)
      applyBand<l, Channels>(columns + bandOffset(l), in + l * l * Channels, out + l * l * Channels);
  });
}

}  // namespace

bool isRotation(const glm::dmat3& matrix, double tolerance) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j)
      // The comparison is negated so that NaN fails.
      if (!(std::abs(glm::dot(matrix[i], matrix[j]) - (i == j ? 1 : 0)) <= tolerance)) return false;
  return glm::determinant(matrix) > 0;
}

Result<glm::dmat3> orthonormalised(const glm::dmat3& matrix) {
  glm::dmat3 unit;
  for (int i = 0; i < 3; ++i) {
    const double length = glm::length(matrix[i]);
    if (!(length > 0) || !std::isfinite(length))
      return fail("rotation", "a column of its matrix is zero or not finite",
                  "give the node a scale above 0");
    unit[i] = matrix[i] / length;
  }
  const double determinant = glm::determinant(unit);
  if (determinant < 0)
    return fail("rotation", "its matrix is a mirror (negative determinant)",
                "take the negative scale into the mesh");
  if (determinant < 1e-3)
    return fail("rotation", "its matrix is flat or strongly sheared", "remove the shear");
  return glm::mat3_cast(glm::normalize(glm::quat_cast(unit)));
}

Rotation::Rotation(const glm::dmat3& rotation, int order) : order_(order) {
  assert(order >= 1 && order <= kMaxBasisOrder);
  columns_.resize(static_cast<std::size_t>(bandOffset(order)));
  columns_float_.resize(columns_.size());
  set(rotation);
}

Rotation::Rotation(const glm::dquat& quaternion, int order)
    : Rotation(glm::mat3_cast(glm::normalize(quaternion)), order) {}

void Rotation::set(const glm::dmat3& rotation) {
  assert(isRotation(rotation));
  // Band 1 of the inverse has the order m = -1, 0, 1, which is y, z, x. Row i of R^-1 = R^T is column i of R,
  // which is rotation[i] in GLM.
  constexpr std::array<int, 3> kAxis = {1, 2, 0};
  std::array<std::array<double, 3>, 3> first;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) first[i][j] = rotation[kAxis[i]][kAxis[j]];

  double* columns = columns_.data();
  columns[0] = 1;
  if (order_ > 1)
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        columns[static_cast<std::size_t>(bandOffset(1)) + i * 4 + j] = first[i][j];
  detail::unrolled(std::make_integer_sequence<int, kMaxBasisOrder - 2>{}, [&](auto index) {
    constexpr int l = index + 2;
    if (l < order_) makeBand<l>(first, columns + bandOffset(l - 1), columns + bandOffset(l));
  });
  std::transform(columns_.begin(), columns_.end(), columns_float_.begin(),
                 [](double value) { return static_cast<float>(value); });
}

double Rotation::entry(int i, int j) const {
  const int l = bandOf(i);
  if (bandOf(j) != l) return 0;
  return columns_[static_cast<std::size_t>(bandOffset(l) + (j - l * l) * stride(l) + i - l * l)];
}

void Rotation::apply(std::span<const float> in, std::span<float> out) const {
  assert(static_cast<int>(in.size()) >= coefficientCount(order_) && out.size() >= in.size());
  applyBands<1>(order_, columns_float_.data(), in.data(), out.data());
}

void Rotation::apply(std::span<const double> in, std::span<double> out) const {
  assert(static_cast<int>(in.size()) >= coefficientCount(order_) && out.size() >= in.size());
  applyBands<1>(order_, columns_.data(), in.data(), out.data());
}

void Rotation::apply(std::span<const glm::vec3> in, std::span<glm::vec3> out) const {
  assert(static_cast<int>(in.size()) >= coefficientCount(order_) && out.size() >= in.size());
  applyBands<3>(order_, columns_float_.data(), &in[0].x, &out[0].x);
}

LightVector Rotation::apply(const LightVector& light) const {
  assert(light.order <= order_);
  LightVector result{.order = light.order};
  applyBands<3>(light.order, columns_float_.data(), &light.c[0].x, &result.c[0].x);
  return result;
}

}  // namespace lambent::sh
