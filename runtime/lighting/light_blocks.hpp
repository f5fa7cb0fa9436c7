// Pictures of light as blocks of texels, and what of each is brighter than a threshold that is lowered step
// by step. In: environment maps. Out: all their light on a FluxGrid, and points of light above the threshold.
// Each texel is looked at twice, and once more when the threshold passes it, so that a whole descent costs
// little more than one threshold. Pure CPU, one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/lighting/light_loss.hpp"
#include "runtime/lighting/light_pieces.hpp"
#include "runtime/sh/image_layout.hpp"
#include "runtime/spec/environment_map.hpp"

namespace lambent::lighting {

double luminance(const glm::vec3& radiance);  // Rec.709

class LightBlocks {
 public:
  explicit LightBlocks(std::span<const spec::EnvironmentMap> environment_maps);

  double brightest() const { return brightest_; }  // luminance of a texel, 0 or more
  void addTo(FluxGrid& grid) const;                // all light

  // Thresholds from just below `brightest` (of all light) down to about `lowest`.
  void setLevels(double brightest, double lowest);
  std::size_t levels() const { return levels_.size(); }
  double threshold(std::size_t level) const;
  // points() are then, of each block, what its texels have above this level's threshold.
  void lowerTo(std::size_t level);
  std::span<const LightPoint> points() const { return points_; }

 private:
  // A picture as it is searched: a coarser (or finer) picture of the same layout.
  struct Search {
    const spec::EnvironmentMap* environment_map;
    int width, height;        // of blocks
    std::uint32_t texels;     // along a block's edge
    std::uint32_t parts;      // along a texel's edge, else 1
    std::size_t first_block;  // in blocks_
  };
  struct Block {
    LightPoint point;             // its flux is what is above the threshold
    double texel_sr = 0.0;        // of one texel, or of one part
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
  std::vector<LightPoint> points_;  // of these
};

}  // namespace lambent::lighting
