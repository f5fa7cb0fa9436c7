// Divides light from infinity into key lights, which a few SH bands cannot carry (suns, and in environment
// maps also lamps, windows and soft boxes), and the rest, which they can. It takes lights in their own frame
// and returns the keys as uniform discs, and the lights without them; keys and rest add up to all light, per
// channel. The loss (see FluxGrid) decides whether there are keys and how many. Turning, fading and
// dimming the lights later turns, fades and dims the keys but never changes which there are. Pure CPU, safe
// to call from any thread. A large picture takes a fraction of a second, and no longer than one read of it if
// there are no keys.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/sh/image_layout.hpp"
#include "runtime/spec/distant_lights.hpp"

namespace lambent::lighting {

// Gathers points of light into pieces that are small enough to be represented by one disc each. It takes
// points of luminous flux on the sphere and returns the pieces that SH bands would lose most, each with the
// position and size of the disc that has its flux and its first moment. Points that are far from all pieces
// belong to none. The same points in the same order give the same pieces. Pure CPU, safe to call from any
// thread.

// Computes what shaded surfaces lose when a light is limited to a few SH bands. It takes light from infinity
// as points of luminous flux and returns one number, the loss. Pure CPU, safe to call from any thread.
//
// A receiver's shaded radiance is sum_i t_i L_i. Over all rotations of the receiver against the light, the
// bands from n on of the light L contribute the variance sum_{l >= n} p_l |L_l|^2, where p_l is the power of
// one coefficient of the transfer in band l. Transfer that is cut by a shadow's edge is a step on the sphere,
// whose power falls as l^-2 per band and so as l^-3 per coefficient. For a clamped cosine half in shadow, p_l
// / p_0 = 1.3 (l + 1/2)^-3; the factor 1.3 is left out here. The loss of L at order n is the standard
// deviation of the missing part relative to the mean:
//
//   loss = sqrt(sum_{l = n..23} (l + 1/2)^-3 |L_l|^2) / |L_00|
//
// A sun alone loses 0.56 at order 5, a uniform half of the sky about 0.02, a sky like cos^2 nothing.

// Holds flux in the cells of a coarse lat-long picture. A point is distributed over the four cells around it,
// so that its position is kept.
class FluxGrid {
 public:
  static constexpr int kRows = 64, kColumns = 128;
  static constexpr int kBands = 24;  // higher bands vary faster than the cells (2.8 degrees) can resolve

  // Holds the cells that a point falls into. Keep it when many grids receive the same points.
  struct Place {
    std::array<std::uint16_t, 4> cells{};
    std::array<float, 4> shares{};
  };
  static Place place(const glm::dvec3& dir);

  void add(const Place& at, double flux) {
    for (std::size_t i = 0; i < 4; ++i) cells_[at.cells[i]] += flux * static_cast<double>(at.shares[i]);
  }
  double flux() const;
  // Returns sum_{l = first_band..23} p_l |L_l|^2 / |Y_00|^2 with p_0 = 1. This is the square of a flux;
  // divide it by the square of the flux of all light.
  double lostPower(int first_band) const;

 private:
  std::vector<double> cells_ = std::vector<double>(std::size_t{kRows} * kColumns);
};

// Returns the loss at this order of a uniform disc that shines alone, in closed form.
double discLoss(int order, double radius_rad);

struct LightPoint {
  glm::dvec3 dir;
  double flux = 0.0;  // luminous; at least 0
  FluxGrid::Place at;
};

// Sums the flux and first moment of some points, from which the disc that represents them is made.
struct LightMoment {
  double flux = 0.0;
  glm::dvec3 moment{0.0};

  void add(const glm::dvec3& dir, double more) {
    flux += more;
    moment += more * dir;
  }
  glm::dvec3 direction() const;  // Y if the points cancel out
  // Returns the radius of the uniform disc with this flux and first moment: |moment| / flux = (1 + cos
  // radius) / 2. For small discs it also has the same second moment.
  double radius() const;
};

struct LightPiece {
  glm::dvec3 dir;
  double flux = 0.0;
  double radius_rad = 0.0;
};

struct PieceLimits {
  int order = 5;             // pieces are ranked by their loss at this order
  std::size_t most = 16;     // maximum number of pieces
  double radius_rad = 0.14;  // a piece consists of points within this radius of its centre
  double least_flux = 0.0;   // weaker pieces are left out
};

// Returns the nearest piece to a direction, or nothing if it is much farther than limits.radius_rad.
std::optional<std::size_t> pieceOf(std::span<const LightPiece> pieces, const PieceLimits& limits,
                                   const glm::dvec3& dir);

// Returns pieces ordered by falling loss.
std::vector<LightPiece> gatherPieces(std::span<const LightPoint> points, const PieceLimits& limits);

double solidAngle(double radius_rad);  // of a disc

// Returns points spread evenly over a uniform disc, at most a degree apart, each with the same share of its
// flux.
std::vector<LightPoint> discPoints(const LightPiece& disc);
// Adds these points to a grid, times a factor.
void addDisc(FluxGrid& grid, const LightPiece& disc, double factor = 1.0);

struct DiscPiece {
  LightPiece piece;
  std::vector<LightPoint> points;  // points of the part of the disc that it represents
};
// Divides a uniform disc into pieces of about equal size and about this radius, at most `most` (at least 3).
// More pieces are used until their round shapes lose no more flux than allowed.
std::vector<DiscPiece> dividedDisc(const LightPiece& disc, double radius_rad, std::size_t most,
                                   double allowed);

// Searches pictures of light in blocks of texels for what is brighter than a threshold that is lowered step
// by step. It takes environment maps and returns all their light on a FluxGrid, and points of light above the
// threshold. Each texel is read twice, and once more when the threshold passes it, so that a whole descent
// costs little more than one threshold. Pure CPU, one thread.
double luminance(const glm::vec3& radiance);  // Rec.709

class LightBlocks {
 public:
  explicit LightBlocks(std::span<const spec::EnvironmentMap> environment_maps);

  double brightest() const { return brightest_; }  // luminance of the brightest texel, at least 0
  void addTo(FluxGrid& grid) const;                // adds all light

  // Sets thresholds from just below `brightest` (of all light) down to about `lowest`.
  void setLevels(double brightest, double lowest);
  std::size_t levels() const { return levels_.size(); }
  double threshold(std::size_t level) const;
  // Lowers the threshold to this level. points() then holds, for each block, what its texels have above it.
  void lowerTo(std::size_t level);
  std::span<const LightPoint> points() const { return points_; }

 private:
  // Describes the picture in the resolution in which it is searched: coarser or finer blocks in the same
  // layout.
  struct Search {
    const spec::EnvironmentMap* environment_map;
    int width, height;        // in blocks
    std::uint32_t texels;     // texels along a block's edge
    std::uint32_t parts;      // blocks along a texel's edge, if blocks are finer; else 1
    std::size_t first_block;  // index into blocks_
  };
  struct Block {
    LightPoint point;             // its flux is the flux above the threshold
    double texel_sr = 0.0;        // solid angle of one texel, or of one part
    double all = 0.0;             // sum of luminance over the texels
    double light = 0.0;           // sum of luminance times solid angle over the texels above the threshold
    double solid_angle_sr = 0.0;  // of these texels
  };
  struct Bright {
    std::uint32_t block;
    float luminance;
  };
  static Search searchOf(const spec::EnvironmentMap& environment_map, std::size_t first_block);
  template <typename Visit>
  static void eachBlock(const Search& search, Visit&& visit);
  std::size_t levelOf(double value) const;

  std::vector<Search> searches_;
  std::vector<Block> blocks_;
  double brightest_ = 0.0, top_ = 0.0;
  std::vector<std::vector<Bright>> levels_;
  std::size_t next_level_ = 0;
  std::vector<std::uint32_t> lit_;  // blocks with texels above the threshold
  std::vector<LightPoint> points_;  // the points of these blocks
};

struct KeyLightOptions {
  std::uint32_t most = 16;   // maximum number of key lights; 0: none are sought
  int order = 5;             // number of SH bands that carry the rest
  double least_loss = 0.01;  // the search stops when the rest loses less than this
  // Larger lights are divided into pieces of the first radius. If `most` such pieces (8 degrees) do not
  // suffice, pieces may be wider, up to the second radius. The limits are approximate: a key may be a tenth
  // larger.
  float largest_radius_rad = 0.14f, widest_radius_rad = 0.28f;
};

// States where a key light was found.
struct KeyOrigin {
  bool in_map = false;    // true: found in an environment map; false: a disc or a piece of one
  std::size_t index = 0;  // into lights.environment_maps (the one with most of it) or lights.discs
  bool piece = false;     // part of a disc that was divided
};

// Names a texel of lights.environment_maps that gave light to a key.
struct KeyTexel {
  std::uint32_t environment_map = 0, texel = 0, key = 0;
};

struct PartedLights {
  std::vector<spec::Disc> keys;    // ordered by falling loss
  std::vector<KeyOrigin> origins;  // in the order of `keys`
  std::vector<KeyTexel> texels;
  std::vector<spec::Disc> discs;  // discs in the rest, which also keeps the whole constant
  // Holds, for each of lights.environment_maps, the picture without its keys, or nothing if it is unchanged.
  std::vector<std::optional<spec::EnvironmentMap>> environment_maps;
  // The loss of all light at options.order, and the loss that remains: that of the rest together with the
  // error of representing keys as round discs.
  double loss_before = 0.0, loss_after = 0.0;
  // The rest keeps this luminance where a key was taken out of a picture; 0 if none was.
  float threshold = 0.0f;
};

PartedLights partLights(const spec::DistantLights& lights, const KeyLightOptions& options = {});

}  // namespace lambent::lighting
