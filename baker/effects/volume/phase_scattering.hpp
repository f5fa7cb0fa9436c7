// Computes one more scattering in a medium whose phase function has g other than 0. Of the radiance that
// arrives at each sample, with coefficients x_i in bands, g^l x_i continues, so that
//   (K x)_i(p) = int y_i(s) int sigma(x_t) tau(p, x_t) sum_j g^l(j) y_j(s) x_j(x_t) dt ds
// arrives after one scattering without absorption (light from s travels along -s before and after, so the
// cosine of the phase function is s . s'). Rays are the same for all samples. So for each ray direction the
// radiance along it is first evaluated, one number per node, and then gathered. As in scatter_rows.hpp,
// stretches of depth e have the weight tau (1 - exp(-e)) and read coarser levels where rays are far apart.
//
// Everything is stored as differences from the state in which all light stays and continues: K x = g^l x +
// (the result of apply()). These are as small as what a free path changes, so that no precision is lost in
// thick media.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "baker/effects/volume/scatter_rows.hpp"
#include "baker/effects/volume/volume.hpp"
#include "baker/effects/volume/volume_rays.hpp"
#include "baker/jobs/stage.hpp"

namespace lambent::baker {

// A RayStep stands for adjacent stretches of a ray: their mean distance in metres, and the share of the ray
// that they scatter.
struct RayStep {
  float t, share;
};
template <>
inline constexpr bool kPlainBytes<RayStep> = true;

struct PhaseSettings {
  int bands = 3;             // of arriving light
  float g = 0.0f;            // mean cosine of the phase function
  std::uint64_t memory = 0;  // bytes for the steps of rays
};

class PhaseScattering {
 public:
  // `clear` is [sample][bands²], int tau y_i ds up to the outside or to surfaces, from many rays
  // (FirstLight); uniform light is corrected to agree with it. `table` has as many bands, and at
  // least 2 bands² rays. Steps that do not fit into the memory are traced again each time, with the same
  // result. Returns nothing if stopped. Scene and table must outlive this.
  static std::optional<PhaseScattering> build(const VolumeScene& scene, const SphereTable& table,
                                              std::span<const float> clear, const PhaseSettings& settings,
                                              const BakeContext& context);
  // Removes what build() kept.
  static void drop(const BakeContext& context, std::size_t samples) { dropStage(context, samples, kChunk); }
  // Returns the number of samples whose rays were traced in this run; the others were found in the cache.
  std::size_t samplesTraced() const { return samples_traced_; }

  std::size_t samples() const { return scene_.grid.samples(); }
  std::size_t outputs() const { return factors_.size(); }
  // Returns g^l of output i.
  double factor(std::size_t i) const { return factors_[i]; }
  // Returns the share of the light leaving a sample that does not come back to it: it reaches other samples,
  // the outside or a surface.
  double away(std::size_t p) const { return away_[p]; }

  // Computes out = K x - g^l x. `x` and `out` are [sample][outputs][kBlockColumns]. Returns false if stopped.
  bool apply(std::span<const float> x, std::span<float> out, const std::stop_token& stop);

  std::uint64_t bytes() const { return chunks_.bytes(); }

 private:
  static constexpr std::size_t kChunk = 64;  // samples
  static constexpr std::size_t kRays = 2;    // rays that are handled at a time
  struct Chunk {
    std::vector<std::uint32_t> begins;  // [sample][ray], then the number of steps
    std::vector<RayStep> steps;
    std::vector<float> left;  // [sample][ray]: share that reaches the outside or a surface
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
  // Traces rays [first, end) of the samples of a chunk.
  Chunk trace(std::size_t chunk, std::size_t first, std::size_t end) const;
  // Computes away_ and amiss_ for the samples of one chunk from its rays.
  void sumUp(std::span<const float> clear, const Chunk& chunk, std::size_t begin, std::size_t end);
  bool fits(const Chunk& chunk, std::size_t samples) const;
  void findDuals();
  // Seen is the radiance along one ray direction at the samples and at the nodes above them.
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
  // For each ray these hold g^l y_i, and the dual basis, which turns sums over rays into coefficients: it is
  // orthonormal to y_i on these rays.
  std::vector<float> seen_as_, duals_;
  std::vector<float> resolved_;  // 1 where a free path is at least a voxel, 0 where it is much shorter
  std::vector<double> away_;
  std::vector<float> amiss_;  // [sample][outputs]: error of few rays against `clear`, times y_0
  KeptChunks<Chunk> chunks_;
  std::size_t samples_traced_ = 0;
};

}  // namespace lambent::baker
