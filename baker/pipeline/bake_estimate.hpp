// Says beforehand what a bake will take, for each group: samples, rays, time, memory and bytes. It rehearses
// the bake with 128 rays, refinement included, and scales what was measured. This takes about
// as long as a draft, and a third to a half of a bake of standard quality. An estimate can be kept in the
// cache, so that the bake that follows says how far off it was. Errors: those of the bake.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "baker/bake/bake.hpp"
#include "baker/pipeline/job_estimate.hpp"

namespace lambent::baker {

struct BakeEstimate {
  struct Group {
    std::string name;
    double samples = 0.0, rays = 0.0, seconds = 0.0;
    double memory_bytes = 0.0;  // of hits and light that its passes keep
    double bytes = 0.0;         // of its transfer in the bundle
    double hit_bytes = 0.0;     // memory of hits, which bounces are gathered from
    StageSeconds processor_stages;
  };
  std::vector<Group> groups;
  // Of the whole: with refinement, meshes and images, and of the whole program.
  double samples = 0.0, rays = 0.0, seconds = 0.0, memory_bytes = 0.0, bytes = 0.0;
  PartSeconds parts;
  double processor_seconds = 0.0;  // of all threads
  StageSeconds processor_stages;
};

Result<BakeEstimate> estimateBake(const Scene& scene, const BakeOptions& options, const BakeContext& context);

// Keeps the estimate for the bake of this scene with these options, and finds it.
void keepEstimate(const Scene& scene, const BakeOptions& options, const BakeEstimate& estimate, Cache& cache);
std::optional<BakeEstimate> findEstimate(const Scene& scene, const BakeOptions& options, Cache& cache);

}  // namespace lambent::baker
