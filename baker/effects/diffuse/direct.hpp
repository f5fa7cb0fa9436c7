// Pass 0 of the diffuse effect: light that arrives without a bounce (Sloan 2002, the first pass of section
// 4):
//   t_p,i = (1/pi) ∫ V_p(s) max(n·s, 0) y_i(s) ds,
// and beside it the lights of the group, at unit strength. The shading normal gives the cosine; the geometric
// normals of the faces around a sample decide what lies below its horizon. What the blocked rays met is
// handed on, for the passes that follow.
#pragma once

#include <optional>
#include <span>
#include <stop_token>

#include "baker/effects/diffuse/hemisphere.hpp"
#include "baker/jobs/bake_context.hpp"
#include "baker/trace/emitters.hpp"
#include "baker/trace/hits.hpp"
#include "baker/trace/sample_visibility.hpp"
#include "baker/trace/traced_scene.hpp"
#include "baker/trace/transfer_field.hpp"
#include "baker/transport/group_geometry.hpp"
#include "baker/transport/ray_scene.hpp"
#include "baker/transport/samples.hpp"
#include "baker/transport/surface_colors.hpp"

namespace lambent::baker {

struct DirectSettings {
  int order = 5;                 // 1..8
  std::size_t rays = 512;        // per sample over its hemisphere, at least 128; some take twice as many
  bool keep_hits = false;        // for bounces
  std::size_t hit_memory = 0;    // bytes; what does not fit is traced again when asked for
  bool colored_kernels = false;  // of glossy surfaces: three channels even where all colours are grey
};

struct DirectResult {
  TransferField field;   // outputs 1, all samples
  TransferField mapped;  // outputs 9, samples of SampleSet::normal_mapped
  SampleVisibilities looks;
  HitStore hits;                // of all samples but glossy ones
  std::uint64_t rays_kept = 0;  // that what was found in the cache stands for
};

// Pass 0 of ranges of samples; also traces a range's hits again.
class DirectPass {
 public:
  DirectPass(const TracedScene& scene, const DirectSettings& settings);

  // `double_rays`: with twice the rays.
  const Hemisphere& hemisphereOf(std::size_t sample, bool double_rays) const {
    if (sample < scene_.samples.normal_mapped.begin) return double_rays ? diffuse_double_rays_ : diffuse_;
    return double_rays ? *mapped_double_rays_ : *mapped_;
  }
  std::uint32_t columns() const { return columns_; }
  std::uint32_t channels() const { return channels_; }
  const DirectSettings& settings() const { return settings_; }
  const Emitters& emitters() const { return emitters_; }
  const InsideTestTables& glances() const { return inside_test_; }

  // Fills in the transfer of samples [begin, end) and how each looked; `hits` gets what its rays met, not
  // painted yet (paintHits). Returns the rays traced. Leaves the rest of them when a stop is requested: a
  // million rays a sample take seconds a range.
  std::uint64_t bake(std::size_t begin, std::size_t end, const std::stop_token& stop, DirectResult& out,
                     RangeHits& hits) const;
  // The hits alone, as bake() gave them and painted.
  void traceAgain(std::size_t begin, std::size_t end, RangeHits& hits) const;

 private:
  class Walk;
  TracedScene scene_;
  DirectSettings settings_;
  InsideTestTables inside_test_;
  Hemisphere diffuse_, diffuse_double_rays_;
  std::optional<Hemisphere> mapped_, mapped_double_rays_;  // where there are such samples
  Emitters emitters_;
  std::uint32_t channels_, columns_;
};

// Returns nothing if stopped. The result does not depend on the number of threads. Glossy samples are left at
// 0 and not looked at: bakeGlossyDirect fills them in. The key of the context is that of all that rays ask
// for (geometry, what lets rays through, lamps, the settings but for memory), not of what surfaces reflect.
// `stage` is the name that progress shows.
std::optional<DirectResult> bakeDirect(const DirectPass& pass, const TracedScene& scene,
                                       const BakeContext& context, const char* stage = "direct light");

}  // namespace lambent::baker
