// Measures the size of coded transfer in a file, by kind, after entropy coding.
#pragma once

#include <algorithm>
#include <chrono>

#include "baker/compress/cpca.hpp"
#include "baker/effects/surface/cell_vectors.hpp"
#include "runtime/bundle/container.hpp"

namespace lambent {

inline constexpr int kZstdLevel = 19;  // the level of bundles

struct CodedBytes {
  std::size_t clusters = 0, codebook = 0, ids = 0, weights = 0, codes = 0;
  double error = 0.0, seconds = 0.0;  // worst error; time of all calls

  std::size_t bytes() const { return codebook + ids + weights; }

  // Codes one transfer and adds it. Returns its error.
  double add(const baker::CellVectors& cell, const baker::CodingSettings& settings) {
    const auto packed = [](const std::vector<std::byte>& raw) {
      return std::min(raw.size(), bundle::compressZstd(raw, kZstdLevel).size());
    };
    const auto start = std::chrono::steady_clock::now();
    const baker::CodedTransfer coded =
        baker::codeTransfer(cell.vectors, cell.vectors.size() / cell.shape.size(), cell.shape, settings);
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const auto own_clusters = static_cast<std::uint32_t>(coded.codebook.clusters());
    clusters += own_clusters;
    codebook += packed(transfer::encodeCodebook(coded.codebook));
    if (own_clusters > 1) ids += packed(transfer::encodeClusterIds(coded.cluster_of, own_clusters));
    for (const baker::CodedPlane& plane : coded.planes) {
      weights += packed(transfer::encodeWeightPlane(plane.codes, plane.bits));
      codes += plane.codes.size();
    }
    if (!(double{coded.error} <= error)) error = double{coded.error};  // NaN is kept
    return double{coded.error};
  }
};

}  // namespace lambent
