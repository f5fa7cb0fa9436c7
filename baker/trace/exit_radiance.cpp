#include "baker/trace/exit_radiance.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include <glm/geometric.hpp>

#include "baker/transport/samples.hpp"
#include "runtime/sh/basis.hpp"

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
  const float u = hit.uAt(), v = hit.vAt();
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
  kernels.at(hit.triangle, hit.uAt(), hit.vAt(), to, constant);
  return kUniform * glm::vec3(constant[0], constant[1], constant[2]);
}

ExitRadiance::ExitRadiance(const GroupGeometry& geometry, const SampleSet& samples, const GlossyExit* glossy)
    : geometry_(geometry), glossy_begin_(samples.glossy.begin), glossy_(glossy) {
  triangle_samples_.reserve(geometry.triangles.size());
  for (const glm::uvec3& t : geometry.triangles)
    triangle_samples_.emplace_back(samples.vertex_sample[t.x], samples.vertex_sample[t.y],
                                   samples.vertex_sample[t.z]);
  if (!samples.texels.empty()) map_of_triangle_.resize(geometry.triangles.size(), nullptr);
  for (const TexelMap& map : samples.texels)
    std::fill_n(map_of_triangle_.begin() + map.first_triangle, map.triangle_count, &map);
}

glm::uvec3 ExitRadiance::samplesOf(const GatherHit& hit) const {
  const std::uint32_t texel = atTexel(hit) ? texelOf(hit) : kNoSample;
  return texel == kNoSample ? triangle_samples_[hit.triangle] : glm::uvec3(texel);
}

std::uint32_t ExitRadiance::texelOf(const GatherHit& hit) const {
  const float u = hit.uAt(), v = hit.vAt();
  return sampleOfTexel(geometry_, *map_of_triangle_[hit.triangle], hit.triangle, {1.0f - u - v, u, v});
}

void ExitRadiance::addTexel(const GatherHit& hit, float weight, const TransferField& before,
                            std::span<float> sum) const {
  const std::uint32_t sample = texelOf(hit);
  if (sample == kNoSample) return addCorners(CornerWeights::of(hit, weight), before, sum);
  const float* in = before.at(sample).data();
  float* out = sum.data();
  for (std::size_t c = 0; c < before.channels; ++c, in += before.columns, out += before.columns) {
    const float factor = weight * static_cast<float>(hit.albedo[c]) * (1.0f / 65535.0f);
    for (std::size_t i = 0; i < before.columns; ++i) out[i] += factor * in[i];
  }
}

void ExitRadiance::addCorners(const CornerWeights& corners, const TransferField& before,
                              std::span<float> sum) const {
  const glm::uvec3 samples = triangle_samples_[corners.triangle];
  const float* a = before.at(samples.x).data();
  const float* b = before.at(samples.y).data();
  const float* c = before.at(samples.z).data();
  float* out = sum.data();
  const std::size_t columns = before.columns;
  for (std::size_t channel = 0; channel < before.channels; ++channel) {
    const float wa = corners.of_corner[0][channel], wb = corners.of_corner[1][channel],
                wc = corners.of_corner[2][channel];
    for (std::size_t i = 0; i < columns; ++i) out[i] += wa * a[i] + wb * b[i] + wc * c[i];
    a += columns, b += columns, c += columns, out += columns;
  }
}

void ExitRadiance::addGlossy(const GatherHit& hit, const glm::vec3& to, float chance, float weight,
                             const Bounce& bounce, std::span<float> sum) const {
  if (!glossy_) return;
  const glm::uvec3 corners = triangle_samples_[hit.triangle];
  const glm::vec3 reflected = weight * glossy_->add(hit, corners, to, chance, weight, sum);
  if (!bounce.of_patches) return;
  const PatchRadiance& patches = *bounce.of_patches;
  const float u = hit.uAt(), v = hit.vAt();
  const std::array<float, 3> shares = {1.0f - u - v, u, v};
  const std::size_t columns = patches.field.columns;
  for (int corner = 0; corner < 3; ++corner) {
    const float* in = patches.field.at(patches.patches.of_sample[corners[corner]]).data();
    float* out = sum.data();
    for (std::size_t c = 0; c < patches.field.channels; ++c, in += columns, out += columns) {
      const float factor = shares[static_cast<std::size_t>(corner)] * reflected[static_cast<int>(c)] *
                           patches.patches.profile[corners[corner]];
      for (std::size_t i = 0; i < columns; ++i) out[i] += factor * in[i];
    }
  }
}

glm::vec3 ExitRadiance::albedo(const GatherHit& hit, const glm::vec3& to) const {
  if (glossy_ && !isDiffuse(hit)) return glossy_->albedo(hit, to);
  return hit.albedoAt();
}

ExitToSample::ExitToSample(const Bounce& bounce, const DirectionTable& table, const glm::vec3& normal,
                           std::size_t sample)
    : bounce_(bounce), table_(table) {
  if (!bounce.exit.anyGlossy()) return;
  frame_ = glm::mat3(localFrame(glm::normalize(glm::dvec3(normal))));
  seed_ = static_cast<std::uint32_t>(sample) * 0x9E3779B9u ^
          static_cast<std::uint32_t>(bounce.number) * 0x85EBCA6Bu;
  seed_ = (seed_ ^ seed_ >> 16) * 0x7FEB352Du;
  seed_ ^= seed_ >> 15;
}

void ExitToSample::addGlossy(const GatherHit& hit, float weight, std::span<float> sum) const {
  const glm::vec3 along = frame_ * glm::vec3(table_.x[hit.ray], table_.y[hit.ray], table_.z[hit.ray]);
  // A golden-ratio sequence over neighbouring rays shares out the corners evenly.
  const std::uint32_t dealt = seed_ + hit.ray * 2654435769u;
  const float chance = static_cast<float>(dealt >> 8) * 0x1p-24f;
  bounce_.exit.addGlossy(hit, -along, chance, weight, bounce_, sum);
}

void ExitToSample::addMirrored(const MirroredLight& light, float weight, std::span<float> scratch,
                               std::span<float> sum) const {
  using From = MirroredLight::From;
  if (!brings(light)) return;
  const TransferField& before = bounce_.before;
  const auto bands = static_cast<std::size_t>(sh::coefficientCount(before.order));
  // The columns that this light has: those of the sky, and those of the group's lights.
  std::size_t begin = 0, end = before.columns;
  const glm::vec3 throughput = light.throughput();
  glm::vec3 factor = weight * throughput;
  std::fill(scratch.begin(), scratch.end(), 0.0f);
  switch (light.from) {
    case From::Sky:
      end = bands;
      for (std::size_t c = 0; c < before.channels; ++c)
        sh::evaluate(before.order, light.direction, scratch.subspan(c * before.columns, bands));
      break;
    case From::Base:
      // The kernels bring the light of lamps from the base too.
      if (bounce_.number == 1) end = bands;
      [[fallthrough]];
    case From::LightsByLayer:
    case From::Diffuse:
      if (light.from == From::LightsByLayer) begin = bands;
      bounce_.exit.addDiffuse(light.hit, weight, before, scratch);
      factor = glm::vec3(1.0f);  // it is the albedo of the hit
      break;
    case From::LightsByKernel:
      begin = bands;
      [[fallthrough]];
    case From::Kernel:
      bounce_.exit.addGlossy(light.hit, light.direction, /*chance=*/-1.0f, 1.0f, bounce_, scratch);
      break;
  }
  for (std::size_t c = 0; c < before.channels; ++c)
    for (std::size_t i = c * before.columns + begin; i < c * before.columns + end; ++i)
      sum[i] += factor[static_cast<int>(c)] * scratch[i];
}

}  // namespace lambent::baker
