#include "editor/session/scene_part.hpp"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

#include "editor/gizmo/projection.hpp"
#include "editor/session/small_pictures.hpp"

namespace lambent::editor {

namespace {

constexpr double kMargin = 0.1;        // on each side, as a share of the box's extent there
constexpr double kLeastPixels = 48.0;  // the longer side of what is shown

}  // namespace

std::optional<PicturePart> partWithBox(const spec::View& view, const spec::Size& size,
                                       const scene::Box& box) {
  if (box.empty()) return std::nullopt;
  const glm::dvec2 whole(size.width, size.height);
  const Projection projection(view, {0.0f, 0.0f, static_cast<float>(whole.x), static_cast<float>(whole.y)});
  glm::dvec2 low = whole, high(0.0);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 place((corner & 1) != 0 ? box.max.x : box.min.x,
                           (corner & 2) != 0 ? box.max.y : box.min.y,
                           (corner & 4) != 0 ? box.max.z : box.min.z);
    const auto pixel = projection.toScreen(place);
    if (!pixel || pixel->x < 0.0 || pixel->y < 0.0 || pixel->x > whole.x || pixel->y > whole.y)
      return std::nullopt;
    low = glm::min(low, *pixel), high = glm::max(high, *pixel);
  }
  const glm::dvec2 extent = high - low;
  if (std::max(extent.x, extent.y) < kLeastPixels) return std::nullopt;
  // The shape is that of small pictures, which would cut the box otherwise, as far as the picture reaches.
  glm::dvec2 wanted = (1.0 + 2.0 * kMargin) * extent;
  wanted = glm::min(
      glm::max(wanted, glm::dvec2(wanted.y * kSmallPictureShape, wanted.x / kSmallPictureShape)), whole);
  const glm::dvec2 begin = glm::clamp(0.5 * (low + high - wanted), glm::dvec2(0.0), whole - wanted);
  return PicturePart{static_cast<std::uint32_t>(begin.x), static_cast<std::uint32_t>(begin.y),
                     static_cast<std::uint32_t>(wanted.x), static_cast<std::uint32_t>(wanted.y)};
}

}  // namespace lambent::editor
