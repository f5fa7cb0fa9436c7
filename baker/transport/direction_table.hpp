// A DirectionTable holds the directions of every sample's rays over the local hemisphere (z up). They are
// low-discrepancy and sorted along a Hilbert curve, so that sixteen neighbours make a coherent ray packet.
// All samples share one table, so its spherical harmonics are evaluated once.
#pragma once

#include <cstddef>
#include <vector>

namespace lambent::baker {

inline constexpr std::size_t kPacketWidth = 16;

struct DirectionTable {
  // These are unit vectors, with one array per axis; the size is a multiple of kPacketWidth.
  std::vector<float> x, y, z;

  std::size_t size() const { return x.size(); }
  std::size_t packets() const { return x.size() / kPacketWidth; }
};

// Makes directions with pdf = cos/pi: a Fibonacci lattice on the unit square goes through the concentric map
// to the disc (Shirley and Chiu 1997) and is lifted to the hemisphere (Malley). `rays` is rounded up to whole
// packets.
DirectionTable cosineTable(std::size_t rays);

// Spreads the same points evenly over the hemisphere: pdf = 1/(2 pi). This serves light that is evaluated at
// any normal, for which light near the horizon counts.
DirectionTable uniformTable(std::size_t rays);

}  // namespace lambent::baker
