// Computes pass 0 of the diffuse effect: light that arrives without a bounce (Sloan 2002, the first pass of
// section 4),
//   t_p,i = (1/pi) ∫ V_p(s) max(n·s, 0) y_i(s) ds,
// and with it the lights of the group, at unit strength. The cosine uses the shading normal; the geometric
// normals of the faces around a sample decide what lies below its horizon. The hits of blocked rays are
// passed on to the bounces.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>

#include "baker/effects/diffuse/hemisphere.hpp"
#include "baker/jobs/bake_context.hpp"
#include "baker/trace/emitters.hpp"
#include "baker/trace/hits.hpp"
#include "baker/trace/traced_samples.hpp"
#include "baker/trace/transfer_field.hpp"
#include "baker/transport/group_geometry.hpp"
#include "baker/transport/ray_scene.hpp"
#include "baker/transport/samples.hpp"
#include "baker/transport/surface_colors.hpp"

namespace lambent::baker {

struct DirectSettings {
  int order = 5;           // 1..8
  std::size_t rays = 512;  // per sample over its hemisphere, at least 128; see RayCount
  bool keep_hits = false;  // keep hits for the bounces
  // Hits of every n-th ray are kept. Samples that take twice the rays keep them of every 2n-th: they do so
  // for the edges of what is near, and light that bounces is smooth.
  std::uint32_t hits_of_every = 1;
  std::size_t hit_memory = 0;    // bytes; hits that do not fit are traced again when they are needed
  bool colored_kernels = false;  // exit kernels of glossy surfaces are coloured: three channels
};

class DiffuseInsideFaces;
class TracedPoints;

struct DirectResult {
  TransferField field;   // of all samples, with 1 output
  TransferField mapped;  // of SampleSet::normal_mapped, with 9 outputs
  SampleVisibilities looks;
  HitStore hits;                // of all samples but glossy ones
  std::uint64_t rays_kept = 0;  // rays that results in the cache saved
  // Points inside faces, to which bounces are fitted as direct light was; null if nothing is fitted.
  std::shared_ptr<DiffuseInsideFaces> inside = {};
  // Points at which bounces are gathered too, and fitted to nothing (BounceResult::at_watched).
  std::vector<std::shared_ptr<const TracedPoints>> watched = {};
};

// A DirectPass traces pass 0 for ranges of samples, and traces the hits of a range again.
class DirectPass {
 public:
  DirectPass(const TracedScene& scene, const DirectSettings& settings);

  // Returns the directions of a sample's rays.
  const Hemisphere& hemisphereOf(std::size_t sample, RayCount count) const {
    const auto& kind = sample < scene_.samples.normal_mapped.begin ? diffuse_ : mapped_;
    return *kind[static_cast<std::size_t>(count)];
  }
  std::uint32_t columns() const { return columns_; }
  std::uint32_t channels() const { return channels_; }
  const DirectSettings& settings() const { return settings_; }
  const Emitters& emitters() const { return emitters_; }
  const InsideTestTables& glances() const { return inside_test_; }

  // Fills in the transfer and visibility of samples [begin, end). `hits` receives the hits of their rays,
  // without colours (paintHits). Returns the number of rays traced. If a stop is requested, the remaining
  // samples are left out, since with a million rays per sample a range takes seconds.
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
  // By RayCount. Those of normal-mapped samples are set if there are any.
  std::array<std::optional<Hemisphere>, kRayCounts> diffuse_, mapped_;
  Emitters emitters_;
  std::uint32_t channels_, columns_;
};

// Returns nothing if stopped. The result does not depend on the number of threads. Glossy samples are left at
// 0 for bakeGlossyDirect to fill in. The key of the context covers everything that rays depend on (geometry,
// opacity, lamps, and the settings without memory), but not what surfaces reflect. `stage` is the name that
// progress shows.
std::optional<DirectResult> bakeDirect(const DirectPass& pass, const TracedScene& scene,
                                       const BakeContext& context, const char* stage = "direct light");

}  // namespace lambent::baker
