// What a bake can be asked for, and what each quality stands for. settings() is what the bundle records:
// everything that changes the bytes that come out, and nothing else (not the number of threads, not memory).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include <glm/vec3.hpp>

namespace lambent::baker {

enum class Quality : std::uint8_t { Draft, Standard, High };

struct BakeOptions {
  static constexpr int kMostBounces = 64;

  Quality quality = Quality::Standard;
  int order = 5;           // 1..8; with glossy surfaces 1..6
  int glossy_order = 5;    // bands of the light that glossy surfaces reflect, 4..6
  std::uint32_t rays = 0;  // per sample over its hemisphere; 0: the quality's
  // Between surfaces. 0: direct light with shadows, and single scattering in volumes, which else scatter as
  // often as they do; -1: as many as the error bound asks for.
  int bounces = -1;
  float error_bound = 0.0f;  // of the coded transfer, relative RMS; 0: the quality's
  float max_edge_m = 0.0f;   // edges longer than this are split; 0: none
  // Points of neighborhood grids along their longest, middle and shortest side, where the scene asks for no
  // other; 0: 64 x 64 x 8 in a slab, else 32 each; for bodies that the scene does not name a quarter of that.
  glm::uvec3 neighborhood_grid{0};
  // Where shadows change, edges are split until interpolation errs by less than this, relative RMS against
  // open light; 0: nowhere; under 0: the quality's.
  float refine_bound = -1.0f;
  // Light at vertices is what interpolation over the faces shows best (bake/fit_vertices.hpp), not what the
  // vertices see: of glossy surfaces direct and bounced light, of diffuse ones direct light; none: of glossy
  // surfaces alone, but for drafts.
  std::optional<bool> fit = {};
  int light_probes = 0;        // of each cell, 1..32; 0: auto, by how near light comes (local_light.hpp)
  glm::uvec3 volume_grid{32};  // voxels of a volume's transfer, 1..256 along each axis
  std::string effects = "auto";
  unsigned threads = 0;            // 0: all
  std::uint64_t memory_bytes = 0;  // that passes may keep things in; 0: half of the machine's

  std::size_t effectiveRays() const;
  float effectiveErrorBound() const;
  // Of glossy transfer, where bytes are dear: the same if it was given, else the quality's own.
  float effectiveGlossyErrorBound() const;
  // Where few components of bounced light leave out more than so many times that bound, all of them are coded
  // to as much; 0: never, as with a bound that was given, which is kept at any price, and for drafts: it may
  // take as long as all else.
  float glossyLooseness() const;
  float effectiveRefineBound() const;
  // Bands of the light at points that rays meet, of which what leaves them is made: more than glossyOrder,
  // since a kernel meets edges of shadows there that few bands do not have; 4..9, by quality. Without bounces
  // glossyOrder.
  int exitOrder() const;
  bool fitsDiffuse() const;
  bool fitsGlossy() const;
  // How far refinement may go: times as many vertices, and so many more.
  double refineGrowth() const;
  std::size_t refineAdded() const;
  double refineWedges() const;  // values apart at glossy vertices, by vertices
  std::uint64_t effectiveMemory() const;
  std::map<std::string, std::string> settings() const;
  // Options with those settings, of the quality that they differ from least; names that settings() does not
  // have are passed over. Nothing where one is missing or is no value of its kind. threads and memory are the
  // usual ones.
  static std::optional<BakeOptions> fromSettings(const std::map<std::string, std::string>& settings);
};

const char* qualityName(Quality quality);

// Points or voxels along each axis, as people write them: "48" or "64x32x64"; nothing where it is neither.
std::optional<glm::uvec3> gridSizeFrom(std::string_view text);

}  // namespace lambent::baker
