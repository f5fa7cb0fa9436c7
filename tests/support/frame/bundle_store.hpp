// Assembles the bundles that tests write from blobs, payloads, and transfer that is exact to 16 bits.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "runtime/bundle/container.hpp"
#include "runtime/bundle/description.hpp"
#include "runtime/transfer/codebook.hpp"

namespace lambent::testing {

// Collects blobs. The view of a payload or image is the index of its blob.
struct Store {
  bundle::Description& description;
  std::vector<bundle::Blob>& blobs;

  std::uint32_t blob(bundle::Blob bytes) {
    blobs.push_back(std::move(bytes));
    return static_cast<std::uint32_t>(blobs.size() - 1);
  }
  std::uint32_t payload(bundle::PayloadType type, bundle::Blob bytes) {
    const auto priority = static_cast<std::uint32_t>(description.payloads.size());
    const std::uint64_t length = bytes.size();
    if (length == 0) bytes = bundle::compressZstd(bytes, 1);  // since glTF has no empty bufferViews
    description.payloads.push_back(
        {.type = type,
         .codec = length > 0 ? bundle::PayloadCodec::Raw : bundle::PayloadCodec::Zstd,
         .view = blob(std::move(bytes)),
         .raw_length = length,
         .priority = priority});
    return priority;
  }
};

// Stores one cluster with zero mean: plane i holds value i, with 16 bits over its range.
inline bundle::CellTransfer storeTransfer(Store& store, const transfer::TransferShape& shape,
                                          const std::vector<std::vector<float>>& vectors) {
  const std::size_t size = shape.size();
  bundle::CellTransfer transfer;
  transfer.shape = shape;
  transfer.axes = shape.size();
  transfer.error_bound = 1e-3f;
  transfer.error = 1e-4f;
  transfer::Codebook codebook{{shape.size()}, {}, std::vector<float>((1 + size) * size, 0.0f)};
  std::vector<std::vector<std::uint32_t>> codes(size);
  for (std::size_t i = 0; i < size; ++i) {
    codebook.vectors[(1 + i) * size + i] = 1.0f;
    float low = vectors[0][i], high = vectors[0][i];
    for (const auto& vector : vectors) {
      low = std::min(low, vector[i]);
      high = std::max(high, vector[i]);
    }
    const float scale = (high - low) / 65535.0f;
    codebook.axes.push_back({.offset = low, .scale = scale});
    for (const auto& vector : vectors)
      codes[i].push_back(scale > 0.0f ? static_cast<std::uint32_t>(std::lround((vector[i] - low) / scale))
                                      : 0u);
  }
  transfer.codebook = store.payload(bundle::PayloadType::Codebook, transfer::encodeCodebook(codebook));
  for (const auto& plane : codes)
    transfer.planes.push_back(
        {.payload = store.payload(bundle::PayloadType::WeightPlane, transfer::encodeWeightPlane(plane, 16)),
         .bits = 16,
         .count = static_cast<std::uint32_t>(plane.size()),
         .variance = 1.0f / static_cast<float>(size)});
  return transfer;
}

}  // namespace lambent::testing
