#include "runtime/streaming/image_levels.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>

#include "runtime/spec/rec709.hpp"

namespace lambent::streaming {

namespace {

// Codes by sRGB (IEC 61966-2-1).
float toSrgb(float light) {
  return light <= 0.0031308f ? 12.92f * light : 1.055f * std::pow(light, 1.0f / 2.4f) - 0.055f;
}

std::uint8_t byteOf(float value) {
  return static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(value, 0.0f, 1.0f)));
}

// The part of a row of `count` texels that lies in texel `at` of a row of `fewer` texels: the index of the
// first one, and weights that sum to 1.
struct Span {
  std::uint32_t first = 0;
  std::vector<float> weights;
};
Span spanOf(std::uint32_t at, std::uint32_t fewer, std::uint32_t count) {
  const double width = double{1} * count / fewer, begin = width * at, end = begin + width;
  Span span{.first = static_cast<std::uint32_t>(begin), .weights = {}};
  for (std::uint32_t i = span.first; i < count && i < end; ++i)
    span.weights.push_back(
        static_cast<float>((std::min(end, i + 1.0) - std::max(begin, double{1} * i)) / width));
  return span;
}

}  // namespace

ImageSize sizeAt(const ImageSize& size, std::uint32_t level) {
  return {std::max(size.width >> level, 1u), std::max(size.height >> level, 1u)};
}

std::uint32_t levelCount(const ImageSize& size) {
  return static_cast<std::uint32_t>(std::bit_width(std::max(size.width, size.height)));
}

std::uint64_t textureBytes(const ImageSize& size) {
  return std::uint64_t{size.rgbaBytes()} * 4 / 3;
}

std::uint32_t coarseLevel(const ImageSize& size) {
  std::uint32_t level = 0;
  while (std::max(size.width, size.height) >> level > kCoarseSide) ++level;
  return level;
}

std::vector<std::uint8_t> shrink(std::span<const std::uint8_t> rgba, const ImageSize& size,
                                 std::uint32_t level, bool color) {
  assert(rgba.size() == size.rgbaBytes());
  const ImageSize small = sizeAt(size, level);
  std::array<float, 256> codes{}, light{};  // values of codes as numbers and as colours
  for (std::size_t code = 0; code < 256; ++code) {
    codes[code] = static_cast<float>(code) / 255.0f;
    light[code] = color ? spec::linearFromSrgb(codes[code]) : codes[code];
  }
  std::vector<Span> across;
  for (std::uint32_t x = 0; x < small.width; ++x) across.push_back(spanOf(x, small.width, size.width));
  std::vector<std::uint8_t> result;
  result.reserve(small.rgbaBytes());
  std::vector<std::array<float, 4>> row(small.width);
  for (std::uint32_t y = 0; y < small.height; ++y) {
    std::ranges::fill(row, std::array<float, 4>{});
    const Span down = spanOf(y, small.height, size.height);
    for (std::uint32_t j = 0; j < down.weights.size(); ++j) {
      const std::uint8_t* const from = rgba.data() + std::size_t{4} * size.width * (down.first + j);
      for (std::uint32_t x = 0; x < small.width; ++x)
        for (std::uint32_t i = 0; i < across[x].weights.size(); ++i) {
          const float weight = down.weights[j] * across[x].weights[i];
          const std::uint8_t* const texel = from + std::size_t{4} * (across[x].first + i);
          for (std::size_t c = 0; c < 3; ++c) row[x][c] += weight * light[texel[c]];
          row[x][3] += weight * codes[texel[3]];
        }
    }
    for (const std::array<float, 4>& texel : row) {
      for (std::size_t c = 0; c < 3; ++c) result.push_back(byteOf(color ? toSrgb(texel[c]) : texel[c]));
      result.push_back(byteOf(texel[3]));
    }
  }
  return result;
}

}  // namespace lambent::streaming
