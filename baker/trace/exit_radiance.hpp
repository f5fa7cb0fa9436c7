// Computes the exit radiance at hits. Bounce passes over diffuse and over other surfaces share it, and the
// way in which late passes are thinned out.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "baker/trace/hits.hpp"
#include "baker/trace/patches.hpp"
#include "baker/trace/transfer_field.hpp"
#include "baker/transport/group_geometry.hpp"
#include "baker/transport/samples.hpp"
#include "baker/transport/texel_samples.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::baker {

// Computes the light that leaves glossy surfaces: L_out(q -> v) = Σ_k c_k(v) l'_k, with c the exit kernel of
// q (surface_brdfs.hpp) and l' the light that the matrices of its samples transfer there. Kernels are a
// function, so that the passes know no materials.

inline constexpr std::size_t kMostGlossyOutputs = sh::coefficientCount(sh::kMaxFactoredOrder);

struct ExitKernels {
  bool grey = true;  // red, green and blue are the same
  // Computes the kernel towards the unit direction `to` (group frame, away from the surface) of the point
  // with barycentric weights u, v of corners 1 and 2: out[channel * order_out² + k], three channels, of at
  // most as many bands as the surfaces have. May be called from any thread.
  std::function<void(std::uint32_t triangle, float u, float v, const glm::vec3& to, std::span<float> out)> at;
};

// GlossyMatrices are matrices of all glossy samples: [sample][channel][output][column].
struct GlossyMatrices {
  std::size_t channels = 1, outputs = 25, columns = 25;
  std::vector<float> values;

  std::size_t matrixSize() const { return outputs * columns; }
  std::size_t sampleSize() const { return channels * matrixSize(); }
  std::span<float> at(std::size_t sample) {
    return std::span(values).subspan(sample * sampleSize(), sampleSize());
  }
  std::span<const float> at(std::size_t sample) const {
    return std::span(values).subspan(sample * sampleSize(), sampleSize());
  }
  // Returns the matrix of a channel, or the only one if all channels share it.
  std::span<const float> matrix(std::size_t sample, std::size_t channel) const {
    return at(sample).subspan((channels == 1 ? 0 : channel) * matrixSize(), matrixSize());
  }
};

// GlossyLight is what one pass brings to glossy samples, of the environment and of the group's lights. Only
// direct light of the environment has no colour, and one channel.
struct GlossyLight {
  GlossyMatrices environment, lights;
};

// The glossy surfaces of a group as senders of what the pass before brought them.
struct GlossyExit {
  const ExitKernels& kernels;  // of the triangles of glossy draws, in as many bands as the matrices
  std::size_t first_sample;    // that of SampleSet::glossy
  GlossyLight light = {};

  // Does what ExitRadiance::addGlossy does. `corners` are the triangle's samples. Returns albedo() of the
  // hit.
  glm::vec3 add(const GatherHit& hit, const glm::uvec3& corners, const glm::vec3& to, float chance,
                float weight, std::span<float> sum) const;
  // Returns how much of uniform light the hit point reflects towards `to`, for each channel.
  glm::vec3 albedo(const GatherHit& hit, const glm::vec3& to) const;
};

class ExitRadiance;

// A Bounce is one pass of bounces, as all that gather in it see it.
struct Bounce {
  int number;   // starts at 1
  bool thinly;  // if true, only a part of the hits is gathered, as late passes do
  const ExitRadiance& exit;
  const TransferField& before;  // diffuse transfer of all samples, which this pass passes on
  // The part of it that samples that are not diffuse have from patches alone, or null. They reflect it alike
  // in all directions.
  const PatchRadiance* of_patches = nullptr;
  double growth = 1.0;  // energy of what this pass passes on, relative to what the previous one brought
};

// CornerWeights says how much the corners of a triangle count, in each channel, in the light that diffuse
// hits on it send.
struct CornerWeights {
  std::uint32_t triangle = 0;
  std::array<std::array<float, 3>, 3> of_corner{};  // [corner][channel]

  static CornerWeights of(const GatherHit& hit, float weight) {
    CornerWeights corners{.triangle = hit.triangle};
    const float u = hit.uAt(), v = hit.vAt();
    for (std::size_t c = 0; c < 3; ++c) {
      const float albedo = weight * static_cast<float>(hit.albedo[c]) * (1.0f / 65535.0f);
      corners.of_corner[0][c] = albedo * (1.0f - u - v);
      corners.of_corner[1][c] = albedo * u;
      corners.of_corner[2][c] = albedo * v;
    }
    return corners;
  }
  void add(const CornerWeights& others) {
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t c = 0; c < 3; ++c) of_corner[i][c] += others.of_corner[i][c];
  }
};

// ExitRadiance returns the light that leaves hits, after the previous pass.
class ExitRadiance {
 public:
  // `glossy` is null if all surfaces are diffuse. All must outlive this.
  ExitRadiance(const GroupGeometry& geometry, const SampleSet& samples, const GlossyExit* glossy);

  bool isDiffuse(const GatherHit& hit) const { return triangle_samples_[hit.triangle].x < glossy_begin_; }
  bool anyGlossy() const { return glossy_ != nullptr; }
  // Adds weight * albedo * interpolated transfer to `sum`, which has the layout of a sample of `before`.
  void addDiffuse(const GatherHit& hit, float weight, const TransferField& before,
                  std::span<float> sum) const {
    if (atTexel(hit))
      addTexel(hit, weight, before, sum);
    else
      addCorners(CornerWeights::of(hit, weight), before, sum);
  }
  // Returns whether the light that leaves a diffuse hit is that of the texel there, and not of the corners.
  bool atTexel(const GatherHit& hit) const {
    return !map_of_triangle_.empty() && map_of_triangle_[hit.triangle] != nullptr;
  }
  void prefetch(const GatherHit& hit, const TransferField& before) const {
    const glm::uvec3 samples = triangle_samples_[hit.triangle];
    for (int c = 0; c < 3; ++c) {
      const std::span<const float> vector = before.at(samples[c]);
      for (std::size_t i = 0; i < vector.size(); i += 16) __builtin_prefetch(vector.data() + i);
    }
  }
  void addCorners(const CornerWeights& corners, const TransferField& before, std::span<float> sum) const;
  // Adds what leaves a hit that is not diffuse towards `to` (unit, group frame, away from the surface). A
  // negative `chance` interpolates the values at the triangle's corners. A `chance` in [0, 1) picks one of
  // the corners with the probability of its weight, which has the same mean and reads a third of the data.
  void addGlossy(const GatherHit& hit, const glm::vec3& to, float chance, float weight, const Bounce& bounce,
                 std::span<float> sum) const;
  // Returns how much of the light at a hit leaves it towards `to`.
  glm::vec3 albedo(const GatherHit& hit, const glm::vec3& to) const;
  // Calls `take` with all of these that passes between surfaces bring light from. `weight_of` returns the
  // weight of a ray.
  template <typename WeightOf>
  void visitMirrored(std::span<const MirroredLight> mirrored, const WeightOf& weight_of,
                     const TakeHit& take) const {
    for (const MirroredLight& light : mirrored) {
      if (light.from == MirroredLight::From::Base || light.from == MirroredLight::From::Diffuse)
        take(light.hit, weight_of(light.hit.ray), light.throughput());
      else if (light.from == MirroredLight::From::Kernel)
        take(light.hit, weight_of(light.hit.ray), light.throughput() * albedo(light.hit, light.direction));
    }
  }
  // Returns the samples of the corners of a hit's triangle, or three times that of the texel there.
  glm::uvec3 samplesOf(const GatherHit& hit) const;

 private:
  // Requires a hit at a texel; returns kNoSample if coding has moved the chart away from it.
  std::uint32_t texelOf(const GatherHit& hit) const;
  void addTexel(const GatherHit& hit, float weight, const TransferField& before, std::span<float> sum) const;

  const GroupGeometry& geometry_;
  std::vector<glm::uvec3> triangle_samples_;
  std::vector<const TexelMap*> map_of_triangle_;  // null: has none; empty if no triangle has one
  std::size_t glossy_begin_;
  const GlossyExit* glossy_;
};

// ExitToSample does the same for one sample, which receives the light along its rays.
class ExitToSample {
 public:
  // `table` holds the sample's rays, with z along its normal. Bounce and table must outlive this.
  ExitToSample(const Bounce& bounce, const DirectionTable& table, const glm::vec3& normal,
               std::size_t sample);

  // Adds all hits, each with the weight that weight_of returns for its ray, to `sum`. Neighbouring rays often
  // meet the same triangle, whose transfer is read once for all of them.
  template <typename WeightOf>
  void addAll(std::span<const GatherHit> hits, const WeightOf& weight_of, std::span<float> sum) const {
    CornerWeights together;
    bool any = false;
    for (std::size_t h = 0; h < hits.size(); ++h) {
      const GatherHit& hit = hits[h];
      if (h + kAhead < hits.size()) bounce_.exit.prefetch(hits[h + kAhead], bounce_.before);
      const float weight = weight_of(hit.ray);
      if (!bounce_.exit.isDiffuse(hit)) {
        addGlossy(hit, weight, sum);
      } else if (bounce_.exit.atTexel(hit)) {
        bounce_.exit.addDiffuse(hit, weight, bounce_.before, sum);
      } else if (const CornerWeights own = CornerWeights::of(hit, weight);
                 any && own.triangle == together.triangle) {
        together.add(own);
      } else {
        if (any) bounce_.exit.addCorners(together, bounce_.before, sum);
        together = own;
        any = true;
      }
    }
    if (any) bounce_.exit.addCorners(together, bounce_.before, sum);
  }
  void add(const GatherHit& hit, float weight, std::span<float> sum) const {
    if (bounce_.exit.isDiffuse(hit))
      bounce_.exit.addDiffuse(hit, weight, bounce_.before, sum);
    else
      addGlossy(hit, weight, sum);
  }
  // Adds light that came by way of mirrors. That of the sky, and what the group's lights send straight to
  // mirrors, comes with the first bounce alone. `scratch` is as long as `sum`.
  void addMirrored(const MirroredLight& light, float weight, std::span<float> scratch,
                   std::span<float> sum) const;
  // Returns whether this bounce brings such light at all.
  bool brings(const MirroredLight& light) const {
    using From = MirroredLight::From;
    return bounce_.number == 1 || light.from == From::Base || light.from == From::Kernel ||
           light.from == From::Diffuse;
  }

 private:
  void addGlossy(const GatherHit& hit, float weight, std::span<float> sum) const;

  static constexpr std::size_t kAhead = 4;  // hits whose transfer is on its way from memory

  const Bounce& bounce_;
  const DirectionTable& table_;
  glm::mat3 frame_{1.0f};
  std::uint32_t seed_ = 0;
};

// Late passes gather over every kThinned-th hit, others in each bounce. Makes `hits` refer to the kept ones,
// which are stored in `out`. Returns the factor on their weights.
template <typename Rays>
float thinHits(int bounce, const Rays& rays, std::span<const GatherHit>& hits, std::vector<GatherHit>& out) {
  out.clear();
  const auto weight_of = [&](std::uint32_t ray) { return rays.weight(ray); };
  const float scale =
      keepEvery(kThinned, static_cast<std::uint32_t>(bounce) % kThinned, hits, weight_of, out);
  hits = out;
  return scale;
}

}  // namespace lambent::baker
