// Computes pass 0 of the glossy effect: the visibility V of the surroundings at each sample, and the lights
// of its group as they arrive from each direction. From both follows the diffuse transfer of E/pi at the
// sample's normal, for those who ask for it:
//   t = Σ_k (A_l/pi) y_k(n) M_k.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "baker/effects/diffuse/direct.hpp"
#include "baker/effects/glossy/glossy_transport.hpp"
#include "runtime/sh/gaunt.hpp"

namespace lambent::baker {

// A GlossyPass traces ranges of glossy samples, and traces the hits of a range again. Samples are counted
// from the first glossy one.
class GlossyPass {
 public:
  // Rays, order (in), channels and lights are those of `plain`, which must outlive this. Both orders are
  // 4..9, and together at most sh::kMaxVisibilityBands + 1.
  GlossyPass(const DirectPass& plain, const TracedScene& scene, int order_out);

  const DirectPass& plain() const { return diffuse_; }
  const TracedScene& scene() const { return scene_; }
  const GlossyHemisphere& hemisphereOf(RayCount count) const {
    return hemispheres_[static_cast<std::size_t>(count)];
  }
  const sh::GauntTable& gaunt() const { return gaunt_; }
  std::size_t first() const { return scene_.samples.glossy.begin; }
  std::size_t size() const { return scene_.samples.glossy.size(); }
  // Returns a GlossyField of the right shape without samples.
  GlossyField shape() const;

  // These do what those of DirectPass do. `looks` has all samples of the group.
  std::uint64_t bake(std::size_t begin, std::size_t end, const std::stop_token& stop, GlossyField& field,
                     SampleVisibilities& looks, RangeHits& hits) const;
  void paint(std::size_t first, std::span<const RayCount> ray_counts, RangeHits& hits) const;
  void traceAgain(std::size_t begin, std::size_t end, RangeHits& hits) const;

 private:
  class Walk;
  const DirectPass& diffuse_;
  TracedScene scene_;
  int order_in_, order_out_;
  GlossyHemisphere hemisphere(RayCount count) const {
    return {raysOf(count, diffuse_.settings().rays), order_in_ + order_out_ - 1, order_out_};
  }

  std::array<GlossyHemisphere, kRayCounts> hemispheres_;
  sh::GauntTable gaunt_;
};

class GlossyInsideFaces;
class TracedGlossyPoints;

struct GlossyDirect {
  GlossyField field;  // visibility and lights_shadowed
  HitStore hits;      // of glossy samples
  std::uint64_t rays = 0;
  std::uint64_t rays_kept = 0;  // rays that results in the cache saved
  std::uint32_t filled_samples = 0;
  // If direct light was fitted to points inside faces, these are the points; bounces are gathered there too.
  std::shared_ptr<GlossyInsideFaces> inside = {};
  // Points at which bounces are gathered too, and fitted to nothing. Passes add to `bounced` of their fields.
  std::vector<std::shared_ptr<TracedGlossyPoints>> watched = {};
};

// Returns nothing if stopped. Also fills in the glossy samples of `looks`, which has all samples of the
// group. `hit_memory` is in bytes. The result does not depend on the number of threads. Context and stage are
// as in bakeDirect.
std::optional<GlossyDirect> bakeGlossyDirect(const GlossyPass& pass, std::size_t hit_memory,
                                             SampleVisibilities& looks, const BakeContext& context,
                                             const char* stage = "glossy shadows");

// Fills in the glossy samples of direct.field from visibility and lights. Returns false if stopped.
bool diffuseFromGlossy(const GlossyPass& pass, const GlossyField& field, DirectResult& direct,
                       const std::stop_token& stop);

// Computes what a sample's matrix, in the group's frame, gives at a Lambert receiver with its normal, from
// the matrix's first order_out² rows: out[column] = Σ_k (A_l/pi) y_k(n) matrix[k * columns + column].
void diffuseTransfer(int order_out, glm::vec3 normal, std::span<const float> matrix, std::span<float> out);

}  // namespace lambent::baker
