// Makes images that bundles can keep: PNG or JPEG, whatever the file brings.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "baker/import/scene.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker {

// Returns a PNG or JPEG as it is, and WebP, BMP, GIF, TIFF and TGA as PNG. Errors: the image is of
// another kind, or cannot be decoded.
Result<SceneImage> storableImage(std::string name, std::vector<std::byte> bytes);

// Returns the metallic-roughness texture of KHR_materials_pbrSpecularGlossiness, whose images have glossiness
// in alpha: green is 1 - factor x glossiness, blue is 0.
Result<SceneImage> roughnessImage(const SceneImage& glossiness, float factor);

}  // namespace lambent::baker
