// Makes the part of the record of a glossy or layered draw that other draws lack: its reflection parameters,
// where its rows and samples lie, and its table of b(v). Reads the residency's tables and the placement of
// the world's groups. Render thread.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "runtime/draws/surface_record.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/sh/zonal.hpp"
#include "runtime/streaming/textures.hpp"

namespace lambent::frame {

// Names the table of b(v) that a glossy draw uses: that for its current material if the bundle has such a
// table, else for the baked material. A GGX table with anisotropy also serves materials without; if there is
// only one without, anisotropy does not show.
struct BrdfChoice {
  std::int32_t table = -1;  // index in its bundle; -1: there is none
  bundle::BrdfFamily family = bundle::BrdfFamily::Ggx;
};
BrdfChoice brdfChoiceOf(std::span<const bundle::BrdfFamily> tables, const gltf::Material& now,
                        const gltf::Material& baked);

// Returns the index of a draw's table in its bundle, or -1 if no table fits.
std::int32_t brdfTableOf(const World& world, std::size_t draw);

// Returns whether the draw's mesh, rows and table are resident. Its samples always have light.
bool glossyReady(const World& world, std::size_t draw);

// Returns whether a draw with a specular layer has its table and its place for what its vertices see.
bool layerReady(const World& world, std::size_t draw);

// Requires a draw that is ready.
GlossyPart describeGlossy(const World& world, std::size_t draw);

// Names the variant of the surface program that a glossy or layered draw needs.
struct GlossyKind {
  std::uint32_t bands = 0;       // of the table; 0: a draw that reflects diffusely only
  std::uint32_t used_bands = 0;  // how many of these bands count; 0: all
  bundle::BrdfFamily family = bundle::BrdfFamily::Ggx;
  auto operator<=>(const GlossyKind&) const = default;
};
GlossyKind glossyKindOf(const World& world, std::size_t draw, std::uint32_t max_bands);
// Requires a draw whose layer is ready.
GlossyKind layerKindOf(const World& world, std::size_t draw);
// Returns the axes of the factors as an array in GLSL.
std::string axesText(const sh::ZonalFactors& factors);
std::vector<gpu::Define> definesOf(const GlossyKind& kind);

}  // namespace lambent::frame
