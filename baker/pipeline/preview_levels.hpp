// A scene gets better in preview levels: at once unshadowed, then coarse transfer, then what was asked for.
// Each is a complete bundle. Only this file decides with which options a level is baked.
#pragma once

#include <cstdint>

#include "baker/bake/bake.hpp"

namespace lambent::baker {

enum class PreviewLevel : std::uint8_t {
  Unshadowed,  // traces no rays (bake_unshadowed.hpp)
  Coarse,      // few rays, one bounce, no refinement; takes seconds
  Final        // the options that were asked for
};

const char* previewLevelName(PreviewLevel preview_level);  // "unshadowed", "coarse", "final"

// Returns the options of a level for a bake that asked for `asked`; they are never finer than those.
BakeOptions previewLevelOptions(PreviewLevel preview_level, const BakeOptions& asked);

// Bakes `scene` at one level, where `asked` holds the final options. Errors: those of bake().
Result<BakeReport> bakePreviewLevel(PreviewLevel preview_level, const Scene& scene, const BakeOptions& asked,
                                    const std::filesystem::path& output, const BakeContext& context);

}  // namespace lambent::baker
