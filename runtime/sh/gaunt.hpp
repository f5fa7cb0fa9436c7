// Multiplies functions that are given by spherical harmonics, with a sparse table of Γ_ijk = ∫ y_i y_j y_k.
// If the visibility V has bands_in + bands_out - 1 bands, its product with a light of bands_in bands is exact
// in the first bands_out bands:
//   l'_i = Σ_jk Γ_ijk V_k l_j,   M_ij = Σ_k Γ_ijk V_k.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace lambent::sh {

inline constexpr int kMaxVisibilityBands = 13;  // 5 + 9 - 1

struct GauntTerm {
  std::uint16_t j = 0, k = 0;  // coefficients of the light and of the visibility
  float value = 0.0f;
};

// The terms of output i are terms[offsets[i]] .. terms[offsets[i + 1]].
struct GauntTable {
  int bands_in = 5, bands_out = 5;
  std::vector<std::uint32_t> offsets;  // bands_out² + 1 entries
  std::vector<GauntTerm> terms;        // nonzero terms, sorted by i, then j, then k

  int visibilityBands() const { return bands_in + bands_out - 1; }
};

// Makes the table for at least 1 band each and at most 14 together. Values are exact up to float rounding,
// because the quadrature integrates polynomials of this degree exactly.
GauntTable makeGauntTable(int bands_in, int bands_out);

// Adds Σ_k Γ_ijk V_k to matrix[i * bands_in² + j].
void addVisibilityMatrix(const GauntTable& table, std::span<const float> visibility, std::span<float> matrix);

}  // namespace lambent::sh
