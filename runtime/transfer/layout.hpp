// Defines what a transfer payload is. A payload belongs to samples of one domain (where they lie) and has one
// form (what their vectors hold). Its sizes follow from the form, the bands and the channels. Payloads as
// bytes are the business of codebook.hpp.
#pragma once

#include <cstdint>

namespace lambent::transfer {

// Tells where the samples of a payload lie.
enum class Domain : std::uint8_t {
  Vertex,    // on surfaces; vertices take them by their rows
  Voxel,     // in a volume: mean radiance that arrives, of which the medium scatters its albedo
  GridPoint  // around a body: the change (M - I) l that the body makes to the light there
};

// Tells what transfer gives at a sample.
enum class Form : std::uint8_t {
  Vector,        // one number per channel: E/pi at the sample's normal, or mean radiance
  NormalMapped,  // light of bands 0..2, to be convolved with A_l/pi at the pixel's normal
  Visibility,    // visibility V, whose product with the light replaces a matrix
  Matrix         // l' = M l, transferred light in bands
};

inline constexpr std::uint32_t kMappedOutputs = 9;  // of Form::NormalMapped

// Returns the number of bands for a number of outputs, which is a square.
constexpr std::uint32_t bandsOf(std::uint32_t outputs) {
  std::uint32_t bands = 0;
  while (bands * bands < outputs) ++bands;
  return bands;
}

// Returns the form in which samples of a domain hold so many outputs. Visibility counts as the matrix that it
// stands for.
constexpr Form formOf(Domain domain, std::uint32_t outputs) {
  if (outputs == 1) return Form::Vector;
  return domain == Domain::Vertex && outputs == kMappedOutputs ? Form::NormalMapped : Form::Matrix;
}

// Returns whether samples are evaluated as matrices, output by output (runtime/evaluate). This is so
// for points around bodies, and for more bands than a diffuse receiver takes. Other samples are evaluated as
// vectors.
constexpr bool evaluatedAsMatrix(Domain domain, std::uint32_t outputs) {
  return domain == Domain::GridPoint || outputs > kMappedOutputs;
}

// Describes a transfer vector. Values are indexed [channel][output][column]. The channels are those of direct
// light ("shadowed") followed by those of direct and bounced light ("full", absent if the bake had no
// bounces). For glossy surfaces the vector can instead be the visibility, which gives direct light by the
// product of spherical harmonics (runtime/sh/gaunt.hpp); bounced light then has a second transfer with
// shadowed_channels 0.
struct TransferShape {
  std::uint32_t order = 5;              // bands of the environment, 0..8; 0 if only the group's lights count
  std::uint32_t light_columns = 0;      // number of lights that belong to the group
  std::uint32_t shadowed_channels = 1;  // 1 if R, G and B are equal, 3 for RGB, or 0
  std::uint32_t full_channels = 0;      // 0, 1 or 3
  // One output is E/pi at the sample's normal. Nine are transferred light in bands 0..2 for normal maps; it
  // is convolved with A_l/pi at the pixel's normal. Glossy surfaces have 16, 25 or 36, which are transferred
  // light l' = M l in 4, 5 or 6 bands.
  std::uint32_t outputs = 1;
  // If above 0, the vector is the visibility V in this many bands and one channel. The product with the light
  // needs order + (bands of the outputs) - 1 bands.
  std::uint32_t visibility_bands = 0;

  std::uint32_t columns() const { return order * order + light_columns; }
  std::uint32_t channels() const { return shadowed_channels + full_channels; }
  bool isVisibility() const { return visibility_bands > 0; }
  // Returns whether it has more bands than a diffuse receiver takes, as glossy surfaces have.
  bool beyondDiffuse() const { return outputs > kMappedOutputs; }
  Form form(Domain domain) const { return isVisibility() ? Form::Visibility : formOf(domain, outputs); }
  std::uint32_t size() const {
    return isVisibility() ? visibility_bands * visibility_bands : channels() * outputs * columns();
  }
  bool operator==(const TransferShape&) const = default;
};

}  // namespace lambent::transfer
