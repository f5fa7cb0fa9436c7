#include "baker/effects/neighborhood/grid_placement.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

namespace lambent::baker {

namespace {

constexpr int kProbes = 5;      // along each axis of a face
constexpr int kBisections = 7;  // for the distance of a face, to a hundredth of kMostReach
constexpr float kFlat = 0.5f;   // a box whose shortest side is below this share of the middle one is a slab
// Distance between receivers and a face that they limit, in points: readers fade grids out over the last
// point, and interpolation takes one more.
constexpr float kBesideReceivers = 1.5f;
constexpr float kLeastThickness = 0.1f;  // relative to the body's radius
// To either side of the receivers' plane there is a cell, and beyond it another to fade out.
constexpr std::uint32_t kFlatLayers = 5;
constexpr glm::uvec3 kSlab{64, 64, 8}, kAround{32, 32, 32};
constexpr glm::uvec3 kCoarseSlab{32, 32, 8}, kCoarseAround{20, 20, 20};

class Placer {
 public:
  Placer(const PlacementWish& wish, const std::function<double(const glm::vec3&)>& change)
      : wish_(wish), change_(change), radius_(0.5f * glm::distance(wish.body.low, wish.body.high)) {}

  std::optional<GridPlacement> place() {
    if (!(radius_ > 0.0f)) return std::nullopt;
    Box3 box;
    if (wish_.extent != glm::vec3(0.0f)) {
      const glm::vec3 middle = 0.5f * (wish_.body.low + wish_.body.high);
      box = {middle - 0.5f * wish_.extent, middle + 0.5f * wish_.extent};
    } else {
      if (!reach(box)) return std::nullopt;
    }
    for (int axis = 0; axis < 3; ++axis) {
      const float lacks = kLeastThickness * radius_ - (box.high[axis] - box.low[axis]);
      if (lacks > 0.0f) box.low[axis] -= 0.5f * lacks, box.high[axis] += 0.5f * lacks;
    }
    GridPlacement grid = dealt(box);
    if (wish_.extent == glm::vec3(0.0f)) standOff(grid);
    return grid;
  }

 private:
  // Finds the box that the change reaches, cut to where receivers come. Returns false if nothing is left.
  bool reach(Box3& box) {
    const glm::vec3 most(kMostReach * radius_);
    Box3 within{wish_.body.low - most, wish_.body.high + most};
    if (wish_.receivers) {
      within.low = glm::max(within.low, wish_.receivers->low);
      within.high = glm::min(within.high, wish_.receivers->high);
      if (!glm::all(glm::lessThanEqual(within.low, within.high))) return false;
    }
    box = within;
    for (int axis = 0; axis < 3; ++axis)
      for (const bool high : {false, true}) {
        const float margin = marginOf(axis, high, within);
        float& face = high ? box.high[axis] : box.low[axis];
        const float reached = high ? wish_.body.high[axis] + margin : wish_.body.low[axis] - margin;
        const float cut = high ? within.high[axis] : within.low[axis];
        const bool by_receivers = wish_.receivers && (high ? cut < reached : cut > reached);
        face = by_receivers ? cut : reached;
        (high ? by_receivers_high_ : by_receivers_low_)[static_cast<std::size_t>(axis)] = by_receivers;
      }
    // If receivers lie beyond the reach of a face, nothing is left.
    return glm::all(glm::lessThanEqual(box.low, box.high));
  }

  // Returns the distance from the body's bounds at which the change on the face is below the bound.
  float marginOf(int axis, bool high, const Box3& within) const {
    float near = 0.0f, far = kMostReach * radius_;
    for (int step = 0; step < kBisections; ++step) {
      const float middle = 0.5f * (near + far);
      (largestOn(axis, high, middle, within) > wish_.bound ? near : far) = middle;
    }
    return far;
  }

  double largestOn(int axis, bool high, float margin, const Box3& within) const {
    const Box3 box{glm::clamp(wish_.body.low - margin, within.low, within.high),
                   glm::clamp(wish_.body.high + margin, within.low, within.high)};
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    double largest = 0.0;
    for (int i = 0; i < kProbes; ++i)
      for (int j = 0; j < kProbes; ++j) {
        glm::vec3 point;
        point[axis] = high ? wish_.body.high[axis] + margin : wish_.body.low[axis] - margin;
        point[u] = glm::mix(box.low[u], box.high[u], (static_cast<float>(i) + 0.5f) / kProbes);
        point[v] = glm::mix(box.low[v], box.high[v], (static_cast<float>(j) + 0.5f) / kProbes);
        largest = std::max(largest, change_(point));
      }
    return largest;
  }

  static bool isSlab(const glm::vec3& length, const std::array<int, 3>& by_length) {
    return length[by_length[2]] < kFlat * length[by_length[1]];
  }
  // Returns a size with about this many points, equally far apart along each axis.
  static glm::uvec3 evenly(const glm::vec3& length, float points) {
    const float per_metre = std::cbrt(points / (length.x * length.y * length.z));
    return glm::uvec3(glm::max(glm::round(per_metre * length), glm::vec3(2.0f)));
  }

  bool flatAlong(int axis) const {
    return wish_.receivers &&
           wish_.receivers->high[axis] - wish_.receivers->low[axis] <= kLeastThickness * radius_;
  }
  // Returns a size with as many points, in layers of which the middle one lies in the plane of the receivers.
  static glm::uvec3 inFewLayers(glm::uvec3 size) {
    std::uint32_t* const counts[] = {&size.x, &size.y, &size.z};
    std::uint32_t& layers = **std::min_element(std::begin(counts), std::end(counts),
                                               [](const auto* a, const auto* b) { return *a < *b; });
    if (layers <= kFlatLayers) return size;
    const float finer = std::sqrt(static_cast<float>(layers) / static_cast<float>(kFlatLayers));
    layers = kFlatLayers;
    for (std::uint32_t* count : counts)
      if (count != &layers) *count = static_cast<std::uint32_t>(finer * static_cast<float>(*count));
    return size;
  }

  // Decides how many points lie along each axis of the box.
  GridPlacement dealt(const Box3& box) const {
    const glm::vec3 length = box.high - box.low;
    std::array<int, 3> by_length;
    std::iota(by_length.begin(), by_length.end(), 0);
    std::stable_sort(by_length.begin(), by_length.end(), [&](int a, int b) { return length[a] > length[b]; });
    glm::uvec3 wanted = wish_.size != glm::uvec3(0u) ? wish_.size : wish_.by_length;
    if (wanted == glm::uvec3(0u)) {
      const bool slab = isSlab(length, by_length);
      wanted = slab ? (wish_.few_points ? kCoarseSlab : kSlab) : wish_.few_points ? kCoarseAround : kAround;
    }
    const bool few_layers = wish_.extent == glm::vec3(0.0f) && wish_.by_length == glm::uvec3(0u) &&
                            isSlab(length, by_length) && flatAlong(by_length[2]);
    if (few_layers) wanted = inFewLayers(wanted);
    std::array<std::uint32_t, 3> counts{wanted.x, wanted.y, wanted.z};
    std::sort(counts.begin(), counts.end(), std::greater<>());
    GridPlacement grid{.size = {}, .box = box};
    for (std::size_t k = 0; k < 3; ++k) grid.size[by_length[k]] = counts[k];
    if (wish_.size != glm::uvec3(0u) && wish_.extent != glm::vec3(0.0f)) grid.size = wish_.size;
    if (wish_.size != glm::uvec3(0u) && wish_.extent == glm::vec3(0.0f) && !isSlab(length, by_length))
      grid.size = evenly(length, static_cast<float>(wanted.x) * static_cast<float>(wanted.y * wanted.z));
    for (int axis = 0; axis < 3; ++axis) grid.size[axis] = std::clamp(grid.size[axis], 2u, kMostGridPoints);
    // An odd number of layers has a middle one, in the plane of the receivers.
    if (few_layers) grid.on_layer[by_length[2]] = grid.size[by_length[2]] % 2 == 1;
    return grid;
  }

  // Moves faces that receivers limit away from them.
  void standOff(GridPlacement& grid) const {
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const float sides = (by_receivers_low_[a] ? 1.0f : 0.0f) + (by_receivers_high_[a] ? 1.0f : 0.0f);
      const float cells = static_cast<float>(grid.size[axis] - 1);
      // The receivers keep at least half of the side.
      const float points = std::min(kBesideReceivers, 0.25f * cells);
      const float length = grid.box.high[axis] - grid.box.low[axis];
      const float off = points * length / (cells - sides * points);
      if (by_receivers_low_[a]) grid.box.low[axis] -= off;
      if (by_receivers_high_[a]) grid.box.high[axis] += off;
    }
  }

  const PlacementWish& wish_;
  const std::function<double(const glm::vec3&)>& change_;
  float radius_;
  std::array<bool, 3> by_receivers_low_{}, by_receivers_high_{};
};

}  // namespace

std::optional<GridPlacement> placeGrid(const PlacementWish& wish,
                                       const std::function<double(const glm::vec3&)>& changeAt) {
  return Placer(wish, changeAt).place();
}

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
