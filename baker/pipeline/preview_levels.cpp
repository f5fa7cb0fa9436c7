#include "baker/pipeline/preview_levels.hpp"

#include <algorithm>
#include <array>

#include "baker/bake/bake_unshadowed.hpp"

namespace lambent::baker {

namespace {

constexpr std::uint32_t kCoarseRays = 128;
constexpr float kCoarseErrorBound = 0.03f;
constexpr std::uint32_t kCoarseVolumeGrid = 12;
constexpr glm::uvec3 kCoarseNeighborhoodGrid{12, 12, 6};

}  // namespace

const char* previewLevelName(PreviewLevel preview_level) {
  static constexpr std::array kNames = {"unshadowed", "coarse", "final"};
  return kNames[static_cast<std::size_t>(preview_level)];
}

BakeOptions previewLevelOptions(PreviewLevel preview_level, const BakeOptions& asked) {
  BakeOptions options = asked;
  if (preview_level != PreviewLevel::Coarse) return options;
  options.quality = Quality::Draft;
  options.rays = kCoarseRays;
  options.bounces = asked.bounces == 0 ? 0 : 1;
  options.picture_bound = 0.0f;
  options.error_bound = std::max(kCoarseErrorBound, asked.effectiveErrorBound());
  options.refine_bound = 0.0f;
  options.fit = false;
  options.volume_grid = glm::min(asked.volume_grid, glm::uvec3(kCoarseVolumeGrid));
  options.neighborhood_grid = asked.neighborhood_grid == glm::uvec3(0u)
                                  ? kCoarseNeighborhoodGrid
                                  : glm::min(asked.neighborhood_grid, kCoarseNeighborhoodGrid);
  return options;
}

Result<BakeReport> bakePreviewLevel(PreviewLevel preview_level, const Scene& scene, const BakeOptions& asked,
                                    const std::filesystem::path& output, const BakeContext& context) {
  const BakeOptions options = previewLevelOptions(preview_level, asked);
  if (preview_level == PreviewLevel::Unshadowed) return bakeUnshadowed(scene, options, output, context);
  return bake(scene, options, output, context);
}

}  // namespace lambent::baker
