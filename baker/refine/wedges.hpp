// Gives a vertex several values if the faces around it see different things. Scans have faces that lean from
// their smooth normals by many degrees, up and down from one to the next; what is hidden changes with them at
// every edge, and no number of shared vertices can represent that. So the faces around a vertex (a star) are
// divided into fans, each of which has its own vertex at the same place (MeshData::fans).
//
// The fit of the vertices is minimised (trace/vertex_fit.hpp). With r_f what interpolation lacks at
// the middle of face f, and d_c the change of the value at each of its corners, it is
//   sum_f A_f (3/4 |r_f - (d_1 + d_2 + d_3) / 3|² + 1/12 (|d_1|² + |d_2|² + |d_3|²)).
// Corners of one fan change alike. With everything else fixed, splitting a fan gains 3/8 of the area times
// the square by which the means of r over its parts differ from that over the whole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "runtime/bundle/mesh.hpp"

namespace lambent::baker {

// Holds two estimates of each r with independent noise, so that the product of both is a square free of noise
// on average.
struct FaceLacks {
  std::size_t width = 0;                         // values in one estimate
  std::vector<float> values = {};                // [face][estimate][width], scaled so that squares are errors
  std::vector<double> areas = {};                // areas of the faces; 0 if they cannot be seen
  std::vector<std::uint32_t> corner_stars = {};  // [face][corner]: the vertex, without telling fans apart

  std::size_t size() const { return areas.size(); }
};

struct Wedges {
  std::vector<std::uint8_t> of_corner;  // [face][corner]
  std::size_t added = 0;                // fans beyond one for each star
};

// Splits where it gains most, until area times square error of what remains is at most `enough` or `most`
// fans were added. `stars` is their number. Deterministic; returns fewer fans if stopped.
Wedges chooseWedges(FaceLacks lacks, std::size_t stars, double enough, std::size_t most,
                    const std::stop_token& stop = {});

// Gives fans their vertices: corners with a fan other than 0 get copies of their vertex. `of_corner` belongs
// to mesh.indices.
void splitIntoWedges(bundle::MeshData& mesh, std::span<const std::uint8_t> of_corner);

}  // namespace lambent::baker
