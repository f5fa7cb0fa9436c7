#include "baker/effects/neighborhood/fit_between_points.hpp"

#include <algorithm>
#include <cassert>
#include <utility>
#include <vector>

namespace lambent::baker {

void fitBetweenPoints(const GridPlacement& grid, std::span<const std::uint8_t> outside, std::size_t width,
                      std::span<float> values) {
  assert(outside.size() == grid.count() && values.size() == width * grid.count());
  // A parabola differs from its chord by x (h - x) f''/2 between points h apart, and by h² f''/12 on average.
  constexpr float kMeanOfBend = 1.0f / 12.0f;
  const std::size_t strides[3] = {1, grid.size.x, std::size_t{grid.size.x} * grid.size.y};
  const auto of = [&](std::size_t point) { return values.subspan(point * width, width); };
  // These are the values of the previous point and of this one before they were changed.
  std::vector<float> last(width), here(width);
  for (int axis = 0; axis < 3; ++axis) {
    if (grid.on_layer[axis]) continue;
    const std::size_t stride = strides[axis], count = grid.size[axis];
    for (std::size_t first = 0; first < grid.count(); ++first) {
      if (first / stride % count != 0) continue;
      std::ranges::copy(of(first), last.begin());
      for (std::size_t k = 1; k + 1 < count; ++k) {
        const std::size_t p = first + k * stride;
        const std::span<float> value = of(p), next = of(p + stride);
        std::ranges::copy(value, here.begin());
        if (outside[p - stride] && outside[p] && outside[p + stride])
          for (std::size_t i = 0; i < width; ++i)
            value[i] -= kMeanOfBend * (last[i] - 2.0f * here[i] + next[i]);
        std::swap(last, here);
      }
    }
  }
}

}  // namespace lambent::baker
