// Computes the light of a group's surfaces, diffuse and glossy together: direct light of both, its fit to the
// faces, and the bounces between them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "baker/bake/group_scene.hpp"
#include "baker/bake/picture_error.hpp"
#include "baker/effects/surface/bounces.hpp"
#include "baker/effects/surface/direct.hpp"
#include "baker/jobs/bake_context.hpp"

namespace lambent::baker {

// SurfaceFigures measure the bake of one group's surfaces, whether it was done now or found in the cache.
struct SurfaceFigures {
  std::uint64_t filled_samples = 0, glossy_samples = 0;
  std::uint64_t hit_bytes = 0;  // memory of the hits kept for the bounces
  double worst_error = 0.0, worst_glossy_error = 0.0, left_out = 0.0;
  std::vector<double> pass_energy;
  struct Rays {
    std::uint64_t traced = 0,
                  kept = 0;  // in this run; saved by results of earlier runs
  };
  Rays diffuse, glossy;
  double ray_seconds = 0.0;  // of this run
  std::optional<bundle::PictureError> picture_error;
  float codes_bound = 0.0f, glossy_codes_bound = 0.0f;
};

struct SurfaceTransport {
  DirectResult direct;
  std::optional<BounceResult> bounced;
  std::array<std::size_t, 2> inside = {};  // samples inside faces that gathered bounces too, by SurfacePart
  TracedView view;
  SurfaceFigures figures;  // without the errors of coding

  const GlossyField* glossy() const { return direct.glossy.visibility.empty() ? nullptr : &direct.glossy; }
};

// The group must be prepared for rays. Returns nothing if stopped. Checkpoints of the bounces stay until
// dropTransport().
std::optional<SurfaceTransport> transportLight(const GroupScene& group, const BakeContext& context);
// Measures how wrong pictures of the surfaces are, as codes show them; without codes, if they are null.
std::optional<bundle::PictureError> shownBy(const GroupScene& group, const SurfaceTransport& light,
                                            const std::vector<std::vector<CodedTransfer>>* cells);
void dropTransport(const GroupScene& group, const SurfaceTransport& light, const BakeContext& context);

}  // namespace lambent::baker
