#include "runtime/effects/neighborhood/atlas.hpp"

#include <algorithm>
#include <numeric>

#include <glm/common.hpp>

namespace lambent::effects::neighborhood {

AtlasLayout layOutAtlas(std::span<const GridShape> shapes, std::uint32_t max_side) {
  AtlasLayout layout;
  layout.places.resize(shapes.size(), GridPlace{});
  std::vector<std::size_t> order(shapes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return shapes[a].size.y > shapes[b].size.y; });
  // Shelves run along y, each as high as its first grid; grids are placed side by side along z.
  std::uint32_t shelf_y = 0, shelf_height = 0, next_z = 0;
  for (const std::size_t i : order) {
    const GridShape& shape = shapes[i];
    if (glm::max(shape.size.x, glm::max(shape.size.y, shape.size.z)) > max_side || shape.outputs == 0)
      continue;
    const std::uint32_t per_column = std::min(shape.outputs, max_side / shape.size.z);
    const std::uint32_t columns = (shape.outputs + per_column - 1) / per_column;
    const std::uint64_t height = std::uint64_t{columns} * shape.size.y;
    const std::uint32_t depth = per_column * shape.size.z;
    std::uint32_t y = shelf_y, z = next_z;
    const bool new_shelf = height > shelf_height || next_z + std::uint64_t{depth} > max_side;
    if (new_shelf) {
      y = shelf_y + shelf_height;
      z = 0;
    }
    if (y + height > max_side) continue;
    if (new_shelf) {
      shelf_y = y;
      shelf_height = static_cast<std::uint32_t>(height);
    }
    next_z = z + depth;
    layout.places[i] = {.size_x = shape.size.x,
                        .size_y = shape.size.y,
                        .size_z = shape.size.z,
                        .outputs = shape.outputs,
                        .first_y = y,
                        .first_z = z,
                        .slabs_per_column = per_column,
                        .scale = 1.0f};
    layout.size =
        glm::max(layout.size, glm::uvec3(shape.size.x, y + static_cast<std::uint32_t>(height), next_z));
  }
  return layout;
}

}  // namespace lambent::effects::neighborhood
