// Computes pass 0: light that arrives without a bounce (Sloan 2002, the first pass of section 4), as a linear
// operator from the coefficients of distant light, and from the lights of the group at unit strength, to the
// outputs of each sample. At diffuse samples that is
//   t_p,i = (1/pi) ∫ V_p(s) max(n·s, 0) y_i(s) ds.
// The cosine uses the shading normal; the geometric normals of the faces around a sample decide what lies
// below its horizon. Glossy samples have the visibility V of their surroundings instead, from which their
// matrices follow. The hits of blocked rays are passed on to the bounces.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "baker/effects/surface/hemisphere.hpp"
#include "baker/jobs/bake_context.hpp"
#include "baker/trace/emitters.hpp"
#include "baker/trace/hits.hpp"
#include "baker/trace/traced_samples.hpp"
#include "baker/trace/transfer_field.hpp"
#include "baker/transport/ray_scene.hpp"
#include "baker/transport/samples.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/gaunt.hpp"

namespace lambent::baker {

// Returns the number of harmonics in so many bands.
inline std::size_t squared(int order) {
  return static_cast<std::size_t>(sh::coefficientCount(order));
}

// Holds the transfer of the glossy samples of a group, in the group's frame: l' = M l is the light that
// arrives at a sample after shadows and interreflection (Sloan 2002, section 4; Kautz 2002). Direct light is
// stored as visibility V in order_in + order_out - 1 bands, bounced light and light of the group's own lights
// as matrices. Below the sample's tangent plane, where the BRDF reads nothing, transferred light continues as
// its mirror image: V(s) = V(mirrored s), and bounced light alike. So V is 1 at open points and 0 in closed
// rooms, without an edge along the horizon at which few bands would ring.
struct GlossyField {
  int order_in = 5, order_out = 5;  // during bounces, order_out is the order of exit radiance
  std::uint32_t channels = 1;       // of bounced light and of the lights: 1 or 3
  std::uint32_t light_columns = 0;  // number of lights of the group
  std::uint32_t first_sample = 0;   // that of SampleSet::glossy

  std::vector<float> visibility;  // [sample][k], visibilityBands()² each
  // Bounced light of the environment: [sample][channel][output][column], order_out² by order_in²; empty
  // without bounces.
  std::vector<float> bounced;
  // Light of the group's lights, without and with bounces: [sample][channel][output][light]; empty if there
  // are none.
  std::vector<float> lights_shadowed, lights_full;

  int visibilityBands() const { return order_in + order_out - 1; }
  std::size_t visibilitySize() const { return squared(visibilityBands()); }
  std::span<const float> visibilityOf(std::size_t sample) const {
    return std::span(visibility).subspan(sample * visibilitySize(), visibilitySize());
  }
  std::size_t size() const { return visibility.size() / visibilitySize(); }
};

struct DirectSettings {
  int order = 5;           // 1..8; with glossy samples 4..9, and at most sh::kMaxVisibilityBands + 1 with
                           // order_out
  std::size_t rays = 512;  // per sample over its hemisphere, at least 128; see RayCount
  bool keep_hits = false;  // keep hits for the bounces
  // Hits of every n-th ray of diffuse samples are kept. Samples that take twice the rays keep them of every
  // 2n-th: they do so for the edges of what is near, and light that bounces is smooth.
  std::uint32_t hits_of_every = 1;
  // Bytes, for the hits of each part; those that do not fit are traced again when they are needed.
  std::size_t hit_memory = 0;
  bool colored_kernels = false;  // exit kernels of glossy surfaces are coloured: three channels
  int order_out = 5;             // of the matrices of glossy samples, as wide as their exit kernels
};

// The samples of a set are traced and gathered in two parts: diffuse and normal-mapped ones, and glossy ones.
enum class SurfacePart : std::uint8_t { Matte, Glossy };

inline SampleStretch stretchOf(const SampleSet& samples, SurfacePart part) {
  return part == SurfacePart::Glossy ? samples.glossy : SampleStretch{0, samples.glossy.begin};
}

struct TracedPart {
  HitStore hits;
  std::uint64_t rays = 0, rays_kept = 0;  // traced; saved by results in the cache
  std::uint32_t filled_samples = 0;       // inside something, and filled from their neighbours
};

struct DirectResult {
  TransferField field;   // of all samples, with 1 output; of glossy ones once diffuseFromGlossy() filled it
  TransferField mapped;  // of SampleSet::normal_mapped, with 9 outputs
  GlossyField glossy;    // visibility and lights_shadowed of SampleSet::glossy
  SampleVisibilities looks;
  std::array<TracedPart, 2> parts;

  TracedPart& of(SurfacePart part) { return parts[static_cast<std::size_t>(part)]; }
  const TracedPart& of(SurfacePart part) const { return parts[static_cast<std::size_t>(part)]; }
};

// A DirectPass traces pass 0 for ranges of samples, and traces the hits of a range again.
class DirectPass {
 public:
  DirectPass(const TracedScene& scene, const DirectSettings& settings);

  const TracedScene& scene() const { return scene_; }
  const DirectSettings& settings() const { return settings_; }
  // Returns the directions of a sample's rays.
  const Hemisphere& hemisphereOf(std::size_t sample, RayCount count) const;
  const sh::GauntTable& gaunt() const { return *gaunt_; }  // if there are glossy samples
  // Returns a result of the right shape, with nothing traced.
  DirectResult untraced() const;

  // Fills in the transfer and visibility of samples [begin, end) of one part. `hits` receives the hits of
  // their rays, without colours (paintHits). Returns the number of rays traced. If a stop is requested, the
  // remaining samples are left out, since with a million rays per sample a range takes seconds.
  std::uint64_t bake(std::size_t begin, std::size_t end, const std::stop_token& stop, DirectResult& out,
                     RangeHits& hits) const;
  // Gives hits of samples that begin with `first` their colours. `ray_counts` are theirs.
  void paint(std::size_t first, std::span<const RayCount> ray_counts, RangeHits& hits) const;
  // Fills in only the hits, the same as those of bake() and with colours.
  void traceAgain(std::size_t begin, std::size_t end, RangeHits& hits) const;

 private:
  class Walk;
  TracedScene scene_;
  DirectSettings settings_;
  InsideTestTables inside_test_;
  // Indexed by the kind of sample (diffuse, normal-mapped, glossy), then by RayCount; set for kinds that
  // exist.
  std::array<std::array<std::optional<Hemisphere>, kRayCounts>, 3> hemispheres_;
  std::optional<sh::GauntTable> gaunt_;
  Emitters emitters_;
  std::uint32_t channels_, columns_;
};

// Traces a part of the samples into `out`, which began as pass.untraced(). Returns false if stopped. The
// result does not depend on the number of threads. The key of the context covers everything that rays depend
// on (geometry, opacity, lamps, and the settings without memory), but not what surfaces reflect. `stage` is
// the name that progress shows.
bool traceDirect(const DirectPass& pass, SurfacePart part, const BakeContext& context, const char* stage,
                 DirectResult& out);

// Traces all samples.
bool traceDirect(const DirectPass& pass, const BakeContext& context, const char* stage, DirectResult& out);
// Traces all samples, and fills in the diffuse transfer of glossy ones. Returns nothing if stopped.
std::optional<DirectResult> bakeDirect(const DirectPass& pass, const BakeContext& context);

// Fills in the glossy samples of direct.field: the diffuse transfer of E/pi at their normals, from visibility
// and lights: t = Σ_k (A_l/pi) y_k(n) M_k. Returns false if stopped.
bool diffuseFromGlossy(const DirectPass& pass, DirectResult& direct, const std::stop_token& stop);

// Computes what a sample's matrix, in the group's frame, gives at a Lambert receiver with its normal, from
// the matrix's first order_out² rows: out[column] = Σ_k (A_l/pi) y_k(n) matrix[k * columns + column].
void diffuseTransfer(int order_out, glm::vec3 normal, std::span<const float> matrix, std::span<float> out);

}  // namespace lambent::baker
