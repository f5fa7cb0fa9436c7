// Searches pictures of light in blocks of texels for what is brighter than a threshold that is lowered step
// by step. It takes environment maps and returns all their light on a FluxGrid, and points of light above the
// threshold. Each texel is read twice, and once more when the threshold passes it, so that a whole descent
// costs little more than one threshold. Pure CPU, one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/lighting/light_pieces.hpp"
#include "runtime/sh/image_layout.hpp"
#include "runtime/spec/environment_map.hpp"

namespace lambent::lighting {

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

}  // namespace lambent::lighting
