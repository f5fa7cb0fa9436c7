// Products of functions given by spherical harmonics: Γ_ijk = ∫ y_i y_j y_k, sparse. With V in bands_in +
// bands_out - 1 bands the product V L of a light of bands_in bands is exact in its first bands_out bands:
//   l'_i = Σ_jk Γ_ijk V_k l_j,   M_ij = Σ_k Γ_ijk V_k.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace lambent::sh {

inline constexpr int kMaxVisibilityBands = 13;  // 5 + 9 - 1

struct GauntTerm {
  std::uint16_t j = 0, k = 0;  // of the light and of the visibility
  float value = 0.0f;
};

// The terms of output i are terms[offsets[i]] .. terms[offsets[i + 1]].
struct GauntTable {
  int bands_in = 5, bands_out = 5;
  std::vector<std::uint32_t> offsets;  // bands_out² + 1
  std::vector<GauntTerm> terms;        // by i, then j, then k; only those that are not 0

  int visibilityBands() const { return bands_in + bands_out - 1; }
};

// Bands from 1, both together at most 14. Exact to float rounding (by quadrature in double that integrates
// such polynomials exactly).
GauntTable makeGauntTable(int bands_in, int bands_out);

// matrix[i * bands_in² + j] += Σ_k Γ_ijk V_k.
void addVisibilityMatrix(const GauntTable& table, std::span<const float> visibility, std::span<float> matrix);

}  // namespace lambent::sh
