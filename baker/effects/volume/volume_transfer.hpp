// Transfer of a volume: at each sample of its grid the mean radiance that arrives,
//   T = (1/4pi) int L ds,   the medium's own albedo left out,
// per coefficient of the light: by single scattering (what the medium and the surfaces around it let
// through), and with light that was scattered any number of times (scatter_rows.hpp), until a linear solver
// has what remains under 1e-5 of it. Surfaces block; what they send back is not added
// (docs/decisions/volumes.md). Where free paths are shorter than voxels, samples are not what is at their
// centres, but what interpolates best to what is at many places (fit_within_voxels.hpp). With a phase
// function that prefers directions (Henyey and Greenstein's, g not 0) the radiance that arrives, in bands, in
// place of its mean: L_lm = int L y_lm ds, of which g^l L_lm y_lm goes on (literature 1.8).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/cache/bytes.hpp"
#include "baker/effects/volume/density_field.hpp"
#include "baker/effects/volume/occluders.hpp"
#include "baker/effects/volume/transfer_grid.hpp"
#include "baker/jobs/bake_context.hpp"

namespace lambent::baker {

// What a bake knows of a volume before light comes in.
struct Medium {
  std::shared_ptr<const DensityField> density;
  std::span<const float> values;  // that `density` was made from
  glm::vec3 albedo{1.0f};
  float g = 0.0f;  // mean cosine of the phase function, between -1 and 1
};

// Bands of arriving light that are kept: 1 where light scatters evenly, 3 up to |g| = 0.5, else as many as
// the light has, at least 3. g^bands of the phase function's narrowest part are lost.
inline int bandsOfPhase(float g, int order) {
  if (g == 0.0f) return 1;
  return order < 4 || (g <= 0.5f && g >= -0.5f) ? 3 : order;
}

// Light that is scattered ten million times and never absorbed has no number: without this the system of a
// medium that nothing gets out of is singular.
inline constexpr double kLargestAlbedo = 1.0 - 1e-7;

inline constexpr std::size_t kRaysPerScatteringRay = 4;  // of those that look for unscattered light

struct VolumeSettings {
  int order = 5;                    // bands of the light, 1..8
  std::size_t rays = 1024;          // per sample over the sphere; a quarter of them for scattered light
  int scatterings = -1;             // after the first; 0: none, -1: all
  glm::uvec3 grid{32};              // voxels
  std::uint64_t memory = 1u << 30;  // for rows of weights, bytes
  // Samples are what interpolates best to the light within voxels, in place of the light at their centres.
  bool fit_within_voxels = false;
};

struct VolumeTransfer {
  std::shared_ptr<const DensityField> density;
  TransferGrid grid;
  glm::vec3 albedo{1.0f};
  int order = 5;
  float g = 0.0f;
  int bands = 1;                    // of what arrives
  std::uint32_t full_channels = 0;  // 0: single scattering is all; 1: grey; 3
  // [sample][single scattering, then with all scatterings by channel][outputs][order²]. One output: the mean
  // radiance; more: its coefficients.
  std::vector<float> vectors;
  // Of more than 3 bands, what is not scattered once more: how much comes through in each direction, in
  // order + bands - 1 bands, [sample][visibility]; the first block of `vectors` follows from it.
  std::vector<float> visibility;

  std::uint64_t rays = 0;       // traced in this run
  std::uint64_t rays_kept = 0;  // that results of earlier runs stand for
  int iterations = 0;           // of the solver
  double residual = 0.0;        // that it reached, relative
  std::uint64_t row_bytes = 0;

  std::size_t columns() const { return static_cast<std::size_t>(order) * static_cast<std::size_t>(order); }
  std::size_t outputs() const { return static_cast<std::size_t>(bands) * static_cast<std::size_t>(bands); }
  std::size_t vectorSize() const { return (1 + full_channels) * outputs() * columns(); }
  std::size_t visibilitySize() const {
    const auto b = static_cast<std::size_t>(order + bands - 1);
    return b * b;
  }
};

void write(const VolumeTransfer& transfer, ByteWriter& out);
// Reads what a bake filled in of a transfer whose grid, order, bands and channels are there.
bool read(ByteReader& in, VolumeTransfer& transfer);

// Returns nothing if stopped. order is at most 6 where bandsOfPhase() is over 3. Progress shows "light into
// volumes", "scattering", "scattered light", "light within voxels". The key of the context is that of medium,
// settings and occluders.
std::optional<VolumeTransfer> bakeVolumeTransfer(const Medium& medium, const VolumeSettings& settings,
                                                 const Occluders& occluders, const BakeContext& context);

}  // namespace lambent::baker
