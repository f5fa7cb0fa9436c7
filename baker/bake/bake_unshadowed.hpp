// Makes the first preview of a scene: a bundle without transfer, made without tracing rays, in about the time
// that it takes to encode the meshes. The runtime shows it lit without shadows and bounces: vertices without
// a sample show A_l y(n), and volumes have one sample that sees everything. Glossy surfaces are shown as
// diffuse, since their BRDF tables take seconds to make, and lamps of the scene shine as lights from outside.
// The bundle has the ordinary format; only its settings say "transfer": "none", so that no bake takes it for
// up to date.
#pragma once

#include <filesystem>

#include "baker/bake/bake.hpp"

namespace lambent::baker {

// Uses only the order, the effects and the longest edge of the options. Errors: those of bake().
Result<BakeReport> bakeUnshadowed(const Scene& scene, const BakeOptions& options,
                                  const std::filesystem::path& output, const BakeContext& context);

}  // namespace lambent::baker
