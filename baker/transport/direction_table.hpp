// The directions in which every sample looks, over the local hemisphere (z up): low-discrepancy, and sorted
// along a Hilbert curve so that sixteen neighbours make a coherent ray packet. One table is shared by all
// samples, so its spherical harmonics are evaluated once.
#pragma once

#include <cstddef>
#include <vector>

namespace lambent::baker {

inline constexpr std::size_t kPacketWidth = 16;

struct DirectionTable {
  // Unit vectors, one array per axis; size a multiple of kPacketWidth.
  std::vector<float> x, y, z;

  std::size_t size() const { return x.size(); }
  std::size_t packets() const { return x.size() / kPacketWidth; }
};

// `rays` is rounded up to whole packets. pdf = cos/pi: Fibonacci lattice on the unit square, concentric map
// to the disc (Shirley and Chiu 1997), lifted to the hemisphere (Malley).
DirectionTable cosineTable(std::size_t rays);

// The same points spread evenly over the hemisphere: pdf = 1/(2 pi). For light at any normal, where light
// near the horizon counts.
DirectionTable uniformTable(std::size_t rays);

}  // namespace lambent::baker
