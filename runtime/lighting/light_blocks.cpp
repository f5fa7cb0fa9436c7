#include "runtime/lighting/light_blocks.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace lambent::lighting {

namespace {

// The number of blocks in a picture lies in this range if its size has a suitable divisor.
constexpr std::size_t kMostBlocks = 60'000, kFewestBlocks = 8'000;
// Pictures with fewer rows are searched in parts of texels, because points too far apart would show up as
// light in high bands.
constexpr std::uint32_t kFewestRows = 64;
// Each threshold is one such step below the previous one.
constexpr double kStepsPerOctave = 4.0;
constexpr std::size_t kMostLevels = 400;

}  // namespace

double luminance(const glm::vec3& radiance) {
  const glm::dvec3 rgb(radiance);
  return 0.2126 * rgb.r + 0.7152 * rgb.g + 0.0722 * rgb.b;
}

LightBlocks::Search LightBlocks::searchOf(const spec::EnvironmentMap& environment_map,
                                          std::size_t first_block) {
  const spec::RgbImage& image = environment_map.image;
  Search search{&environment_map, static_cast<int>(image.width), static_cast<int>(image.height), 1, 1,
                first_block};
  const bool cross =
      environment_map.layout == sh::ImageLayout::VerticalCross;  // blocks must stay within a face
  const std::uint32_t side = cross ? image.width / 3 : image.width;
  const auto blocks = [&](std::uint32_t texels) { return image.texels.size() / texels / texels; };
  for (std::uint32_t n = 2; n <= side && blocks(search.texels) > kMostBlocks; ++n)
    if (side % n == 0 && (cross || image.height % n == 0) && blocks(n) >= kFewestBlocks) search.texels = n;
  if (image.height < kFewestRows) search.parts = (kFewestRows - 1) / image.height + 1;
  search.width = search.width * static_cast<int>(search.parts) / static_cast<int>(search.texels);
  search.height = search.height * static_cast<int>(search.parts) / static_cast<int>(search.texels);
  return search;
}

// Calls visit(block, luminance) for every texel, or for every part of each texel.
template <typename Visit>
void LightBlocks::eachBlock(const Search& search, Visit&& visit) {
  const spec::RgbImage& image = search.environment_map->image;
  const std::uint32_t parts = search.parts, texels = search.texels;
  const auto width = static_cast<std::size_t>(search.width);
  for (std::uint32_t y = 0; y < image.height; ++y)
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const double value = luminance(image.texels[std::size_t{y} * image.width + x]);
      for (std::uint32_t part = 0; part < parts * parts; ++part) {
        const std::uint32_t column = (x * parts + part % parts) / texels;
        const std::uint32_t row = (y * parts + part / parts) / texels;
        visit(search.first_block + row * width + column, value);
      }
    }
}

LightBlocks::LightBlocks(std::span<const spec::EnvironmentMap> environment_maps) {
  for (const spec::EnvironmentMap& environment_map : environment_maps) {
    const Search search = searchOf(environment_map, blocks_.size());
    searches_.push_back(search);
    for (int y = 0; y < search.height; ++y)
      for (int x = 0; x < search.width; ++x) {
        Block block;
        block.texel_sr = sh::texelSolidAngle(environment_map.layout, search.width, search.height, x, y) /
                         (search.texels * search.texels);
        block.point.dir = sh::texelDirection(environment_map.layout, search.width, search.height, x, y);
        if (block.texel_sr > 0.0) block.point.at = FluxGrid::place(block.point.dir);
        blocks_.push_back(block);
      }
    eachBlock(search, [&](std::size_t i, double value) {
      if (blocks_[i].texel_sr <= 0.0) return;
      blocks_[i].all += value;
      brightest_ = std::max(brightest_, value);
    });
  }
}

void LightBlocks::addTo(FluxGrid& grid) const {
  for (const Block& block : blocks_)
    if (block.texel_sr > 0.0) grid.add(block.point.at, block.all * block.texel_sr);
}

double LightBlocks::threshold(std::size_t level) const {
  return top_ * std::exp2(-static_cast<double>(level + 1) / kStepsPerOctave);
}

std::size_t LightBlocks::levelOf(double value) const {
  return static_cast<std::size_t>(std::max(0.0, std::floor(kStepsPerOctave * std::log2(top_ / value))));
}

void LightBlocks::setLevels(double brightest, double lowest) {
  assert(brightest > 0.0 && lowest > 0.0);
  top_ = brightest;
  levels_.assign(std::min(levelOf(lowest) + 1, kMostLevels), {});
  const double least = threshold(levels_.size() - 1);
  for (const Search& search : searches_)
    eachBlock(search, [&](std::size_t block, double value) {
      if (value <= least || blocks_[block].texel_sr <= 0.0) return;
      levels_[std::min(levelOf(value), levels_.size() - 1)].push_back(
          {static_cast<std::uint32_t>(block), static_cast<float>(value)});
    });
}

void LightBlocks::lowerTo(std::size_t level) {
  if (level < next_level_) {  // the threshold rises: start at the top
    for (Block& block : blocks_) block.light = block.solid_angle_sr = 0.0;
    lit_.clear();
    next_level_ = 0;
  }
  for (; next_level_ <= level; ++next_level_)
    for (const Bright& texel : levels_[next_level_]) {
      Block& block = blocks_[texel.block];
      if (block.solid_angle_sr <= 0.0) lit_.push_back(texel.block);
      block.solid_angle_sr += block.texel_sr;
      block.light += block.texel_sr * static_cast<double>(texel.luminance);
    }
  points_.clear();
  for (const std::uint32_t i : lit_) {
    Block& block = blocks_[i];
    block.point.flux = std::max(0.0, block.light - threshold(level) * block.solid_angle_sr);
    points_.push_back(block.point);
  }
}

}  // namespace lambent::lighting
