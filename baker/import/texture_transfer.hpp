// Reads extras.lambent.texture_transfer of meshes and primitives (docs/authoring.md), which asks for transfer
// at the texels of the file's own texture coordinates, and tells whether these can hold it: every point of
// the surface needs a place of its own.
#pragma once

#include <cstdint>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "baker/import/scene.hpp"

namespace lambent::baker {

// The texture is a square of so many texels; a power of two.
inline constexpr std::uint32_t kLeastTexels = 16, kMostTexels = 2048;

// Throws an Error if the mesh or primitive asks for anything else.
void checkTextureTransfer(const nlohmann::json& owner, const std::string& name);
// Returns the texels along a side that the primitive asks for, else its mesh; 0 if neither does. Both were
// checked.
std::uint32_t textureTransferOf(const nlohmann::json& mesh, const nlohmann::json& primitive);

// Returns what is wrong with a set of texture coordinates as places of transfer, seen at `texels` texels
// along a side, or an empty string if nothing is: coordinates outside 0 to 1, a triangle without area in the
// texture, or charts that overlap.
std::string faultOfCharts(const bundle::MeshData& mesh, std::uint32_t set, std::uint32_t texels);

// Gives the primitive texels, with TEXCOORD_1 if it is there and else TEXCOORD_0, or adds a warning that says
// why it keeps its vertices.
void giveTexels(std::uint32_t texels, const std::string& name, ScenePrimitive& primitive,
                std::vector<std::string>& warnings);

}  // namespace lambent::baker
