#include "runtime/effects/neighborhood/neighborhood.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string_view>

#include <glm/common.hpp>

#include "lambent_effects_neighborhood_embedded.hpp"
#include "lambent_transfer_embedded.hpp"

namespace lambent::effects::neighborhood {

const gpu::FindText kNeighborhoodShaders[2] = {&embedded::lambent_effects_neighborhood::find,
                                               &embedded::lambent_transfer::find};

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

static_assert(kWriteGroupsX == gpu::WorkList::kMaxGroupsX);

namespace {

gpu::Texture makeAtlas(const glm::uvec3& size) {
  gpu::Texture texture("neighborhoods",
                       {.format = GL_RGBA16F, .width = size.x, .height = size.y, .depth = size.z});
  texture.interpolate();
  constexpr float kNothing[] = {0.0f, 0.0f, 0.0f, 0.0f};
  glClearTexImage(texture.id(), 0, GL_RGBA, GL_FLOAT, kNothing);
  return texture;
}

template <typename Each>
void forCells(const streaming::Residency& residency, const Grid& grid, const Each& each) {
  const streaming::ResidentGroup& group = residency.groups()[grid.group];
  for (std::uint32_t c = group.first_cell; c < group.first_cell + group.cell_count; ++c)
    if (residency.cells()[c].domain == transfer::Domain::GridPoint) each(residency.cells()[c]);
}

// Returns whether all points have arrived that can improve the picture.
bool complete(const streaming::Residency& residency, const Grid& grid) {
  std::uint64_t points = 0;
  bool usable = true;
  forCells(residency, grid, [&](const streaming::ResidentCell& cell) {
    points += cell.sample_count;
    usable &= cell.usable();
  });
  const glm::uvec3& size = grid.points.size;
  return usable && points == std::uint64_t{size.x} * size.y * size.z;
}

// Returns a power of two near the group's light, so that half floats suit light of any strength.
float scaleOf(const lighting::GroupLights& lights, const streaming::ResidentGroup& group,
              std::uint32_t index) {
  float largest = 0.0f;
  const std::uint32_t end = lights.lampsOf(index) + group.light_columns;
  for (std::uint32_t i = lights.firstOf(index); i < end; ++i) {
    const glm::vec3 size = glm::abs(glm::vec3(lights.coefficients()[i]));
    largest = std::max({largest, size.r, size.g, size.b});
  }
  if (!(largest > 0.0f) || !std::isfinite(largest)) return 1.0f;
  return std::exp2(std::clamp(std::ceil(std::log2(largest)), -100.0f, 100.0f));
}

}  // namespace

Neighborhood::Neighborhood() : writes_("neighborhood writes"), work_("neighborhood work") {}

void Neighborhood::setGrids(std::vector<Grid> grids, const streaming::Residency& residency) {
  const auto same = [](const Grid& a, const Grid& b) {
    return a.id == b.id && a.points.size == b.points.size && a.points.bounds_min == b.points.bounds_min &&
           a.points.bounds_max == b.points.bounds_max;
  };
  if (std::ranges::equal(grids, grids_, same)) {
    for (std::size_t i = 0; i < grids_.size(); ++i) grids_[i].group = grids[i].group;
    return;
  }
  std::swap(grids, grids_);
  written_versions_.assign(grids_.size(), 0);
  ++version_;
  std::vector<GridShape> shapes;
  for (const Grid& grid : grids_) {
    GridShape& shape = shapes.emplace_back(grid.points.size, 0);
    forCells(residency, grid, [&](const streaming::ResidentCell& cell) { shape.outputs = cell.outputs; });
  }
  GLint max_side = 0;
  glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &max_side);
  const AtlasLayout layout = layOutAtlas(shapes, static_cast<std::uint32_t>(max_side));
  for (std::size_t i = 0; i < grids_.size(); ++i) {
    grids_[i].place = layout.places[i];
    grids_[i].ready = false;
    for (const Grid& before : grids) {
      if (before.key != grids_[i].key || !before.ready || layout.places[i].outputs == 0) continue;
      grids_[i].ready = complete(residency, grids_[i]);
      grids_[i].place.scale = before.place.scale;
    }
  }
  atlas_size_ = layout.size;
  atlas_ = layout.size.x > 0 ? makeAtlas(layout.size) : gpu::Texture();
}

Result<void> Neighborhood::update(streaming::Residency& residency, const lighting::GroupLights& lights,
                                  const evaluate::Samples& samples, gpu::Counters& counters) {
  written_ = 0;
  records_.clear();
  work_.clear();
  for (std::size_t i = 0; i < grids_.size(); ++i) {
    Grid& grid = grids_[i];
    const std::uint64_t shaded = samples.matricesVersionOf(grid.group);
    if (grid.place.outputs == 0 || shaded == written_versions_[i]) continue;
    written_versions_[i] = shaded;
    ++written_;
    const bool ready = complete(residency, grid);
    const float scale = scaleOf(lights, residency.groups()[grid.group], grid.group);
    if (ready != grid.ready || scale != grid.place.scale) ++version_;
    grid.ready = ready;
    grid.place.scale = scale;
    const std::uint32_t page = residency.groups()[grid.group].samples.page;
    std::uint32_t first_point = 0;
    forCells(residency, grid, [&](const streaming::ResidentCell& cell) {
      records_.push_back({.grid = grid.place,
                          .first_output = cell.first_output,
                          .first_point = first_point,
                          .point_count = cell.sample_count,
                          .pad = 0});
      first_point += cell.sample_count;
      work_.add({page}, static_cast<std::uint32_t>(records_.size() - 1), cell.outputs * cell.sample_count,
                kWriteGroupSize);
    });
  }
  return work_.empty() ? Result<void>{} : write(residency, counters);
}

Result<void> Neighborhood::write(streaming::Residency& residency, gpu::Counters& counters) {
  writes_.assign(std::span<const WriteRecord>(records_));
  counters.uploaded_bytes += records_.size() * sizeof(WriteRecord);
  writes_.bindStorage(kBindWrites);
  glBindImageTexture(kImageAtlas, atlas_.id(), 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_RGBA16F);
  return evaluate::run(
      work_, counters,
      [&](const gpu::BatchKey& key) {
        residency.samples().page(key[0]).bindStorage(kBindWriteSamples);
        return kernels_.use("neighborhood_write.comp");
      },
      GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
}

}  // namespace lambent::effects::neighborhood
