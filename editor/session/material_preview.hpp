// Draws a sphere of a material, for lists and the inspector: its factors under a lamp and a simple sky.
// Textures are not on it. Pure.
#pragma once

#include <cstdint>

#include "runtime/bundle/material_fields.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::editor {

// Returns a square picture with row 0 at the top, transparent around the sphere.
spec::Rgba8Image previewOf(const gltf::MaterialFactors& material, std::uint32_t size);

}  // namespace lambent::editor
