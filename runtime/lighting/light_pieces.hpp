// Gathers points of light into pieces that are small enough to be a disc each. In: points of luminous flux on
// the sphere. Out: the pieces that bands of SH would miss most, each with the place and size of the disc that
// has its flux and its first moment. Points that are far from all of them belong to none. The same points in
// the same order give the same pieces. Pure CPU, safe to call from any thread.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/lighting/light_loss.hpp"

namespace lambent::lighting {

struct LightPoint {
  glm::dvec3 dir;
  double flux = 0.0;  // luminous, not negative
  FluxGrid::Place at;
};

// Flux and first moment of some points; what the disc that stands for them is made from.
struct LightMoment {
  double flux = 0.0;
  glm::dvec3 moment{0.0};

  void add(const glm::dvec3& dir, double more) {
    flux += more;
    moment += more * dir;
  }
  glm::dvec3 direction() const;  // +Y where the points cancel out
  // Of the uniform disc with this flux and this first moment, |moment| / flux = (1 + cos radius) / 2. For
  // small discs that is the disc with the same second moment.
  double radius() const;
};

struct LightPiece {
  glm::dvec3 dir;
  double flux = 0.0;
  double radius_rad = 0.0;
};

struct PieceLimits {
  int order = 5;             // pieces are ranked by their loss at this order
  std::size_t most = 16;     // pieces
  double radius_rad = 0.14;  // points within this of its middle make up a piece
  double least_flux = 0.0;   // pieces with less than this are left out
};

// The piece that a direction belongs to: the nearest, if it is not farther than limits.radius_rad by much.
std::optional<std::size_t> pieceOf(std::span<const LightPiece> pieces, const PieceLimits& limits,
                                   const glm::dvec3& dir);

// Those that lose most first.
std::vector<LightPiece> gatherPieces(std::span<const LightPoint> points, const PieceLimits& limits);

double solidAngle(double radius_rad);  // of a disc

// Points spread evenly over a uniform disc, a degree apart or closer, with equal shares of its flux.
std::vector<LightPoint> discPoints(const LightPiece& disc);
// The same onto a grid, times a factor.
void addDisc(FluxGrid& grid, const LightPiece& disc, double factor = 1.0);

struct DiscPiece {
  LightPiece piece;
  std::vector<LightPoint> points;  // of the part of the disc that it stands for
};
struct DiscDivision {
  double radius_rad = 0.14;  // of a piece, about
  std::size_t most = 16;     // pieces; 3 at least
  double allowed = 0.0;      // as many more as it takes for their round shapes to lose no more: a flux
};
// A uniform disc in about equal pieces.
std::vector<DiscPiece> dividedDisc(const LightPiece& disc, const DiscDivision& division);

}  // namespace lambent::lighting
