// What a medium with a phase function of g other than 0 scatters once more. Of the radiance that arrives at
// each sample, coefficients x_i in bands, g^l x_i goes on, so that
//   (K x)_i(p) = int y_i(s) int sigma(x_t) tau(p, x_t) sum_j g^l(j) y_j(s) x_j(x_t) dt ds
// arrives after one scattering that absorbs nothing (light from s travels along -s before and after: the
// cosine of the phase function is s . s'). Rays are the same for all samples, so for each ray the medium is
// first seen along it, one number per node, and then gathered. As in scatter_rows.hpp stretches of depth e
// count tau (1 - exp(-e)), and come from coarser levels where rays are far apart.
//
// Everything is kept as differences from "all light stays and goes on": K x = g^l x + (what apply() gives),
// which are as small as what a free path changes, so that no precision is lost in thick media.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "baker/effects/volume/gmres.hpp"
#include "baker/effects/volume/kept_chunks.hpp"
#include "baker/effects/volume/ray_steps.hpp"
#include "baker/effects/volume/scatter_rows.hpp"
#include "baker/effects/volume/sphere_table.hpp"
#include "baker/effects/volume/volume_scene.hpp"
#include "baker/jobs/stage.hpp"

namespace lambent::baker {

// Of stretches side by side on a ray: where on average, metres, and what share of the ray they scatter.
struct RayStep {
  float t, share;
};
template <>
inline constexpr bool kPlainBytes<RayStep> = true;

struct PhaseSettings {
  int bands = 3;             // of what arrives
  float g = 0.0f;            // mean cosine of the phase function
  std::uint64_t memory = 0;  // bytes for what rays meet
};

class PhaseScattering {
 public:
  // clear: [sample][bands²], int tau y_i ds up to the outside or to surfaces, by many rays
  // (phased_light.hpp): uniform light comes out as that says. table: of as many bands, at least 2 bands²
  // rays. What does not fit into the memory is traced again each time, with the same result. Nothing if
  // stopped. Scene and table must outlive it.
  static std::optional<PhaseScattering> build(const VolumeScene& scene, const SphereTable& table,
                                              std::span<const float> clear, const PhaseSettings& settings,
                                              const BakeContext& context);
  // Removes what build() kept.
  static void drop(const BakeContext& context, std::size_t samples) { dropStage(context, samples, kChunk); }
  // Samples whose rays were traced in this run; the others were kept.
  std::size_t samplesTraced() const { return samples_traced_; }

  std::size_t samples() const { return scene_.grid.samples(); }
  std::size_t outputs() const { return factors_.size(); }
  // g^l of output i.
  double factor(std::size_t i) const { return factors_[i]; }
  // Of what sets out from a sample, the share that does not come back to itself: to others and out.
  double away(std::size_t p) const { return away_[p]; }

  // out = K x - g^l x. x, out: [sample][outputs][kBlockColumns]. False if stopped.
  bool apply(std::span<const float> x, std::span<float> out, const std::stop_token& stop);

  std::uint64_t bytes() const { return chunks_.bytes(); }

 private:
  static constexpr std::size_t kChunk = 64;  // samples
  static constexpr std::size_t kRays = 2;    // at once
  struct Chunk {
    std::vector<std::uint32_t> begins;  // [sample][ray], and one more
    std::vector<RayStep> steps;
    std::vector<float> left;  // [sample][ray]: gets out, or to a surface
    std::uint64_t bytes() const { return 4 * (begins.size() + left.size()) + 8 * steps.size(); }
    void shrink() { steps.shrink_to_fit(); }
    friend void write(const Chunk& chunk, ByteWriter& out) {
      out.addList(chunk.begins), out.addList(chunk.steps), out.addList(chunk.left);
    }
    friend bool read(ByteReader& in, Chunk& chunk) {
      return in.readList(chunk.begins) && in.readList(chunk.steps) && in.readList(chunk.left);
    }
  };

  PhaseScattering(const VolumeScene& scene, const SphereTable& table, const PhaseSettings& settings);
  // Rays [first, end) of the samples of a chunk.
  Chunk trace(std::size_t chunk, std::size_t first, std::size_t end) const;
  // Of one chunk, from what its rays met.
  void sumUp(std::span<const float> clear, const Chunk& chunk, std::size_t begin, std::size_t end);
  bool fits(const Chunk& chunk, std::size_t samples) const;
  void findDuals();
  // What a ray sees of the samples and of the nodes over them.
  struct Seen {
    std::vector<float> near, far;
  };
  static constexpr std::size_t kNear = 4;
  std::optional<std::array<std::size_t, 3>> curveAt(std::size_t node, int axis) const;
  void bend(std::span<const float> nodes, std::span<float> bent) const;
  bool see(std::size_t ray, std::span<const float> x, std::span<const float> bent, std::span<float> near,
           std::span<float> far, const std::stop_token& stop) const;
  void gather(std::size_t chunk, std::size_t first_ray, std::span<const Seen> seen,
              std::span<float> out) const;

  VolumeScene scene_;
  const SphereTable* table_;
  RaySteps steps_;
  std::vector<double> factors_;
  // Of each ray: g^l y_i, and what makes coefficients of a sum over rays, orthonormal to y_i on these rays.
  std::vector<float> seen_as_, duals_;
  std::vector<float> resolved_;  // of nodes: 1 where a free path is not shorter than a voxel, 0 where far
  std::vector<double> away_;
  std::vector<float> amiss_;  // [sample][outputs]: by how much few rays miss `clear`, times y_0
  KeptChunks<Chunk> chunks_;
  std::size_t samples_traced_ = 0;
};

}  // namespace lambent::baker
