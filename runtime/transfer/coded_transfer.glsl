// Reads the quantized weights of samples and the shares of light probes in them, for the sample stages of all
// effects.
#include "transfer_shared.h"

uint codeWordAt(uint word);  // word of the transfer page

// Names the sample of the cell whose code stands at a position, the first vector of its cluster, and how many of the
// cluster's axes are resident.
struct CodedSample {
  uint sample_index, first, axes;
};
CodedSample codedSampleAt(TransferRecord transfer, uint position) {
  uint place = codeWordAt(transfer.positions_word + position);
  uint cluster = transfer.clusters_word + 2u * (place >> 16u);
  return CodedSample(place & 0xffffu, codeWordAt(cluster), min(codeWordAt(cluster + 1u), transfer.plane_count));
}

// Returns the code at a position of a plane. `codes` is the word of the plane, with kCodes16Bit.
uint codeOf(uint codes, uint position) {
  uint word = codes & ~kCodes16Bit;
  if ((codes & kCodes16Bit) != 0u) {
    uint pair = codeWordAt(word + (position >> 1u));
    return (pair >> (16u * (position & 1u))) & 0xffffu;
  }
  uint four = codeWordAt(word + (position >> 2u));
  return (four >> (8u * (position & 3u))) & 0xffu;
}

// Holds the share of a light probe in the light of a sample. Weights fall with k, so all after the first 0 are 0.
struct LightShare {
  uint light;
  float weight;
};
LightShare lightShareOf(TransferRecord transfer, uint sample_index, uint k) {
  if (transfer.light_count == 1u) return LightShare(0u, k == 0u ? 1.0 : 0.0);
  uint word = transfer.light_weights_word + 2u * sample_index;
  return LightShare(codeWordAt(word) >> (8u * k) & 0xffu, float(codeWordAt(word + 1u) >> (8u * k) & 0xffu) / 255.0);
}
