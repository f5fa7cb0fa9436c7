// The preview_levels by which a scene gets better: at once unshadowed, then coarse transfer, then what was
// asked for. Each is a whole bundle of its own; what it is baked with is decided here and nowhere else.
#pragma once

#include <cstdint>
#include <stop_token>

#include "baker/bake/bake.hpp"

namespace lambent::baker {

enum class PreviewLevel : std::uint8_t {
  Unshadowed,  // no ray (bake_unshadowed.hpp)
  Coarse,      // few rays, one bounce, no refinement: seconds
  Final        // the options that were asked for
};

const char* previewLevelName(PreviewLevel preview_level);  // "unshadowed", "coarse", "final"

// The options of a preview_level for a bake that asked for `asked`; never finer than those.
BakeOptions previewLevelOptions(PreviewLevel preview_level, const BakeOptions& asked);

// Bakes `scene`, of which `asked` are the final options, up to one preview_level. Errors: as bake().
Result<BakeReport> bakePreviewLevel(PreviewLevel preview_level, const Scene& scene, const BakeOptions& asked,
                                    const std::filesystem::path& output, Progress& progress,
                                    std::stop_token stop, Cache* cache = nullptr);

}  // namespace lambent::baker
