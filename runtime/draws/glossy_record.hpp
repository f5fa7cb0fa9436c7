// What the raster pass knows of a glossy draw beyond what every draw has: its reflection, where its rows and
// samples lie, and the table of b(v) that serves it. Reads the residency's tables and where the world's
// groups stand.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "runtime/draws/surface_record.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/streaming/brdf_texture.hpp"

namespace lambent::frame {

// By what a glossy draw looks up b(v): that of its material as it is now, where the bundle has a table for
// it, else as it was baked. A GGX table with anisotropy serves materials without; where there is only one
// without, anisotropy does not show.
struct BrdfChoice {
  std::int32_t table = -1;  // by index in its bundle; -1: there is none
  bundle::BrdfFamily family = bundle::BrdfFamily::Ggx;
};
BrdfChoice brdfChoiceOf(std::span<const bundle::BrdfFamily> tables, const gltf::Material& now,
                        const gltf::Material& baked);

// The table of a draw, by index in its bundle; -1 where the bundle has none that fits.
std::int32_t brdfTableOf(const World& world, std::size_t draw);

// Whether everything is there that the draw needs: mesh, rows, table. Its samples always have light.
bool glossyReady(const World& world, std::size_t draw);

// Only of draws that are ready.
GlossyPart describeGlossy(const World& world, std::size_t draw);

// What the surface program of a glossy draw is compiled for.
struct GlossyKind {
  std::uint32_t bands = 0;       // 0: no glossy draw
  std::uint32_t used_bands = 0;  // of these, that count; 0: all
  bundle::BrdfFamily family = bundle::BrdfFamily::Ggx;
  auto operator<=>(const GlossyKind&) const = default;
};
GlossyKind glossyKindOf(const World& world, std::size_t draw, std::uint32_t max_bands);
std::vector<gpu::Define> definesOf(const GlossyKind& kind);

}  // namespace lambent::frame
