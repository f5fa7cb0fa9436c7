// Values apart where the faces around a vertex see different things. Scans have faces that lean from their
// smooth normals by many degrees, up and down from one to the next; what is hidden changes with them at every
// edge, and no number of shared vertices shows that. So the faces around a vertex are dealt out to fans, each
// with a vertex of its own at the same place (MeshData::fans).
//
// What is minimised is the fit of the vertices (effects/diffuse/vertex_fit.hpp): with r_f what interpolation
// lacks at the middle of face f and d_c the change of the value at each of its corners,
//   sum_f A_f (3/4 |r_f - (d_1 + d_2 + d_3) / 3|² + 1/12 (|d_1|² + |d_2|² + |d_3|²)).
// Corners of one fan change alike. While all else stays, a split of a fan gains 3/8 of the area times square
// by which the means of r over its parts differ from that over the whole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "runtime/bundle/mesh.hpp"

namespace lambent::baker {

// Two estimates of each r, with noise of their own: the product of both is a square free of noise on average.
struct FaceLacks {
  std::size_t width = 0;                         // of one estimate
  std::vector<float> values = {};                // [face][estimate][width], so that squares are errors
  std::vector<double> areas = {};                // of the faces; 0 where nobody sees them
  std::vector<std::uint32_t> corner_stars = {};  // [face][corner]: which vertex, fans not told apart

  std::size_t size() const { return areas.size(); }
};

struct Wedges {
  std::vector<std::uint8_t> of_corner;  // [face][corner]
  std::size_t added = 0;                // beyond one for each star
};

// Splits where it gains most, until area times square error of what is left is at most `enough`, or `most`
// fans were added. stars: how many there are.
// Deterministic; fewer if stopped.
Wedges chooseWedges(FaceLacks lacks, std::size_t stars, double enough, std::size_t most,
                    const std::stop_token& stop = {});

// Gives fans their vertices: the corners of a vertex that have another fan than 0 get copies of it.
// of_corner: of mesh.indices.
void splitIntoWedges(bundle::MeshData& mesh, std::span<const std::uint8_t> of_corner);

}  // namespace lambent::baker
