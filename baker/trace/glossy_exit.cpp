#include "baker/trace/glossy_exit.hpp"

#include <array>
#include <cstring>

namespace lambent::baker {

namespace {

// Uniform light of radiance 1 has sqrt(4 pi) as its coefficient 0 and no others.
constexpr float kUniform = 3.54490770f;

// Computes for each of `Kernels` kernels of `outputs` values, stored one after the other:
//   out[n * out_stride + i] += weight Σ_k kernel_n[k] matrix[k * Columns + i].
// Vectors are written by hand, since the compiler leaves the sums in memory.
template <std::size_t Columns, std::size_t Kernels>
void contract(const float* kernels, std::size_t outputs, const float* matrix, float weight, float* out,
              std::size_t out_stride) {
  typedef float Eight __attribute__((vector_size(32)));
  constexpr std::size_t kWhole = Columns / 8, kRest = Columns % 8;
  Eight sums[Kernels][kWhole] = {};
  std::array<std::array<float, Kernels>, kRest> rest{};
  for (std::size_t k = 0; k < outputs; ++k, matrix += Columns) {
    for (std::size_t w = 0; w < kWhole; ++w) {
      Eight row;
      std::memcpy(&row, matrix + 8 * w, sizeof(row));
      for (std::size_t n = 0; n < Kernels; ++n) sums[n][w] += kernels[n * outputs + k] * row;
    }
    for (std::size_t i = 0; i < kRest; ++i)
      for (std::size_t n = 0; n < Kernels; ++n)
        rest[i][n] += kernels[n * outputs + k] * matrix[8 * kWhole + i];
  }
  for (std::size_t n = 0; n < Kernels; ++n, out += out_stride) {
    for (std::size_t w = 0; w < kWhole; ++w)
      for (std::size_t i = 0; i < 8; ++i) out[8 * w + i] += weight * sums[n][w][i];
    for (std::size_t i = 0; i < kRest; ++i) out[8 * kWhole + i] += weight * rest[i][n];
  }
}

struct MatrixView {
  const float* values;
  std::size_t outputs, columns;
};

template <std::size_t Kernels>
void contract(const float* kernels, const MatrixView& matrix, float weight, float* out,
              std::size_t out_stride) {
  const auto [values, outputs, columns] = matrix;
  switch (columns) {
    case 16:
      return contract<16, Kernels>(kernels, outputs, values, weight, out, out_stride);
    case 25:
      return contract<25, Kernels>(kernels, outputs, values, weight, out, out_stride);
    case 36:
      return contract<36, Kernels>(kernels, outputs, values, weight, out, out_stride);
    default:
      for (std::size_t n = 0; n < Kernels; ++n)
        for (std::size_t k = 0; k < outputs; ++k)
          for (std::size_t i = 0; i < columns; ++i)
            out[n * out_stride + i] += weight * kernels[n * outputs + k] * values[k * columns + i];
  }
}

}  // namespace

glm::vec3 GlossyExit::add(const GatherHit& hit, const glm::uvec3& corners, const glm::vec3& to, float chance,
                          float weight, std::span<float> sum) const {
  const float u = static_cast<float>(hit.u) * (1.0f / 65535.0f),
              v = static_cast<float>(hit.v) * (1.0f / 65535.0f);
  const std::size_t outputs = light.environment.outputs, columns = light.environment.columns,
                    lights = light.lights.columns, channels = light.lights.channels;
  const std::uint32_t picked = chance < u ? corners.y : chance < u + v ? corners.z : corners.x;
  // The matrix is fetched while the kernel is computed.
  if (const auto matrix = light.environment.at(picked - first_sample); chance >= 0.0f)
    for (std::size_t i = 0; i < matrix.size(); i += 16) __builtin_prefetch(matrix.data() + i);
  std::array<float, 3 * kMostGlossyOutputs> kernel;
  kernels.at(hit.triangle, u, v, to, std::span(kernel).first(3 * outputs));
  const auto of = [&](const GlossyMatrices& matrices, std::size_t s, float share, std::size_t first) {
    float* out = sum.data() + first;
    if (matrices.channels < channels)  // one matrix for all channels is read once
      return contract<3>(kernel.data(), {matrices.at(s).data(), outputs, matrices.columns}, share, out,
                         columns + lights);
    for (std::size_t c = 0; c < channels; ++c, out += columns + lights)
      contract<1>(kernel.data() + c * outputs, {matrices.matrix(s, c).data(), outputs, matrices.columns},
                  share, out, 0);
  };
  const auto addCorner = [&](std::uint32_t corner, float share) {
    const std::size_t s = corner - first_sample;
    of(light.environment, s, share, 0);
    if (lights > 0) of(light.lights, s, share, columns);
  };
  if (chance < 0.0f) {
    addCorner(corners.x, weight * (1.0f - u - v));
    addCorner(corners.y, weight * u);
    addCorner(corners.z, weight * v);
  } else {
    addCorner(picked, weight);
  }
  return kUniform * glm::vec3(kernel[0], kernel[outputs], kernel[2 * outputs]);
}

glm::vec3 GlossyExit::albedo(const GatherHit& hit, const glm::vec3& to) const {
  std::array<float, 3> constant;  // the kernel's first band alone
  kernels.at(hit.triangle, static_cast<float>(hit.u) * (1.0f / 65535.0f),
             static_cast<float>(hit.v) * (1.0f / 65535.0f), to, constant);
  return kUniform * glm::vec3(constant[0], constant[1], constant[2]);
}

}  // namespace lambent::baker
