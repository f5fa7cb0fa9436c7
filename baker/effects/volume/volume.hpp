// Computes the transfer of volumes.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/cache/key.hpp"
#include "baker/effects/volume/grids.hpp"
#include "baker/effects/volume/volume_rays.hpp"
#include "baker/jobs/bake_context.hpp"

namespace lambent::baker {

// Computes the transfer of a volume. At each sample of its grid this is the mean radiance that arrives,
//   T = (1/4pi) int L ds,   the medium's own albedo left out,
// per coefficient of the light, both with single scattering alone (the light that the medium and the surfaces
// around it let through) and with all scatterings (isotropic.cpp), which a linear solver computes to a
// relative residual of 1e-5. Surfaces block light; light that they reflect is not added
// (docs/design/volumes.md). Where free paths are shorter than voxels, samples are not the values at voxel
// centres, but those that interpolate best to the values at many places (isotropic.cpp).
//
// If the phase function is anisotropic (Henyey and Greenstein's, g not 0), bands of arriving radiance take
// the place of its mean: L_lm = int L y_lm ds, of which g^l L_lm y_lm continues (literature 1.8).

// A Medium is what a bake knows of a volume before light comes in.
struct Medium {
  std::shared_ptr<const DensityField> density;
  std::span<const float> values;  // densities that `density` was made from, m^-1
  glm::vec3 albedo{1.0f};
  float g = 0.0f;  // mean cosine of the phase function, between -1 and 1
};

// Returns how many bands of arriving light are kept: 1 if scattering is isotropic, 3 up to |g| = 0.5, else as
// many as the light has, but at least 3. The phase function's bands from there on, of the size g^bands and
// less, are lost.
inline int bandsOfPhase(float g, int order) {
  if (g == 0.0f) return 1;
  return order < 4 || (g <= 0.5f && g >= -0.5f) ? 3 : order;
}

// Light that is scattered ten million times and never absorbed has no finite value: without this limit, the
// system of a medium that no light leaves is singular.
inline constexpr double kLargestAlbedo = 1.0 - 1e-7;

inline constexpr std::size_t kLeastScatteringRays = 64;
inline constexpr std::size_t kRaysPerScatteringRay = 4;  // rays for unscattered per ray for scattered light

struct VolumeSettings {
  int order = 5;                    // bands of incident light, 1..8
  std::size_t rays = 1024;          // per sample over the sphere; scattered light takes a quarter of them
  int scatterings = -1;             // after the first; 0: none, -1: all
  glm::uvec3 grid{32};              // voxels
  std::uint64_t memory = 1u << 30;  // for rows of weights, bytes
  // If true, samples interpolate best to the light within voxels, instead of being the light at voxel
  // centres.
  bool fit_within_voxels = false;
};

struct VolumeTransfer {
  std::shared_ptr<const DensityField> density;
  TransferGrid grid;
  glm::vec3 albedo{1.0f};
  int order = 5;
  float g = 0.0f;
  int bands = 1;                    // of arriving light
  std::uint32_t full_channels = 0;  // 0: only single scattering; 1: grey; 3: red, green and blue
  // [sample][single scattering, then all scatterings by channel][outputs][order²]. With one output these are
  // the mean radiance, with more its coefficients.
  std::vector<float> vectors;
  // If there are more than 3 bands, this is the transmittance of unscattered light by direction, in order +
  // bands - 1 bands: [sample][visibility]. The first block of `vectors` follows from it.
  std::vector<float> visibility;

  std::uint64_t rays = 0;       // traced in this run
  std::uint64_t rays_kept = 0;  // rays that results of earlier runs saved
  int iterations = 0;           // of the solver
  double residual = 0.0;        // relative, when the solver ended
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
// Reads what a bake fills in, of a transfer whose grid, order, bands and channels are set.
bool read(ByteReader& in, VolumeTransfer& transfer);

// Returns nothing if stopped. The order is at most 6 if bandsOfPhase() is above 3. Progress shows "light into
// volumes", "scattering", "scattered light", "light within voxels". The key of the context covers medium,
// settings and occluders.
std::optional<VolumeTransfer> bakeVolumeTransfer(const Medium& medium, const VolumeSettings& settings,
                                                 const Occluders& occluders, const BakeContext& context);

// Marches a ray over 0..t_max metres through a volume as others see it. Returns the transmittance (0..1) by
// which light from beyond the ray's far end is multiplied. `scattered` receives the radiance that the volume
// adds towards the ray's origin, per light coefficient: [channel][order²], three channels. It is the sum over
// stretches of tau (1 - exp(-depth)) albedo T, where T includes all scatterings if they were baked. With more
// than one band, sum_lm g^l T_lm y_lm(direction) takes the place of T. Points and directions are in the
// volume's group frame, and the direction is unit. May be called from any thread.
float marchVolume(const VolumeTransfer& transfer, const glm::vec3& origin, const glm::vec3& direction,
                  float t_max, std::span<float> scattered);

}  // namespace lambent::baker
