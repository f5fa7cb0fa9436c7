#include "runtime/effects/volume/volume.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>

#include "lambent_effects_volume_embedded.hpp"
#include "runtime/base/finite.hpp"
#include "runtime/streaming/loader.hpp"
#include "runtime/transfer/codebook.hpp"

namespace lambent::effects::volume {

constexpr gpu::FindText kVolumeShaders[] = {&embedded::lambent_effects_volume::find};

static_assert(kBlock == streaming::kVolumeBlock && kMaxWorkGroupsX == gpu::WorkList::kMaxGroupsX);

namespace {

// Returns whether the samples of the cell hold nothing for the mode, so that the light itself is shown.
// Samples of matrices are filled with it.
bool isOpen(const streaming::ResidentCell& cell, const evaluate::TransferTable::Cell& transfers,
            evaluate::TransferMode mode) {
  return !cell.matrices() &&
         (mode == evaluate::TransferMode::Unshadowed || !cell.usable() || transfers.count == 0);
}

}  // namespace

SlabLayout slabLayoutOf(const glm::uvec3& transfer_size, std::uint32_t outputs) {
  SlabLayout layout;
  layout.slabs_z = std::clamp(kMaxLightSide / transfer_size.z, 1u, outputs);
  layout.slabs_x = (outputs + layout.slabs_z - 1) / layout.slabs_z;
  layout.texture_size = {transfer_size.x * layout.slabs_x, transfer_size.y, transfer_size.z * layout.slabs_z};
  return layout;
}

Volume::Volume(bool precise)
    : precise_(precise),
      kernels_(kVolumeShaders),
      records_table_("volume cells"),
      work_("volume scatter work") {}

gpu::Texture Volume::makeTexture(const streaming::ResidentVolume& volume) const {
  const glm::uvec3 size = slabLayoutOf(volume.grid.transfer_size, volume.outputs).texture_size;
  gpu::Texture texture("light of a volume", {.format = precise_ ? GLenum{GL_RGBA32F} : GLenum{GL_RGBA16F},
                                             .width = size.x,
                                             .height = size.y,
                                             .depth = size.z});
  constexpr float kNothing[] = {0.0f, 0.0f, 0.0f, 0.0f};
  glClearTexImage(texture.id(), 0, GL_RGBA, GL_FLOAT, kNothing);
  texture.interpolate();
  return texture;
}

void Volume::collect(const streaming::Residency& residency, const ShadedLight& light,
                     evaluate::TransferMode mode, std::span<const std::uint8_t> in_view) {
  const auto& [lights, samples] = light;
  work_.clear();
  records_.clear();
  for (std::uint32_t v = 0; v < held_.size(); ++v) {
    const streaming::ResidentVolume& volume = residency.volumes()[v];
    const streaming::ResidentGroup& group = residency.groups()[volume.group];
    if (!volume.ready() || volume.sample_count == 0) continue;
    if (!in_view.empty() && in_view[v] == 0) continue;
    const auto first = static_cast<std::uint32_t>(records_.size());
    const std::uint64_t shaded = samples.allVersionOf(volume.group);
    std::uint32_t open_cells = 0;
    const SlabLayout layout = slabLayoutOf(volume.grid.transfer_size, volume.outputs);
    for (std::uint32_t c = group.first_cell; c < group.first_cell + group.cell_count; ++c) {
      const streaming::ResidentCell& cell = residency.cells()[c];
      const bool open = isOpen(cell, samples.tables().cells[c], mode);
      if (open) ++open_cells;
      const glm::uvec3& size = volume.grid.transfer_size;
      records_.push_back({.first_output = cell.first_output,
                          .first_voxel = cell.first_sample,
                          .sample_count = cell.sample_count,
                          .outputs = volume.outputs,
                          .size = {size.x, size.y, size.z},
                          .slabs_z = layout.slabs_z,
                          .open = open ? group.order * group.order : 0,
                          .light = lights.firstOf(volume.group),
                          .g = volume.grid.g,
                          .pad = 0});
    }
    Held& held = held_[v];
    const std::uint64_t own_light = open_cells > 0 ? lights.versionOf(volume.group) : 0;
    if (!held.changed.renew(shaded, own_light, volume.version, open_cells, mode)) continue;
    if (!held.light) held.light = makeTexture(volume);
    ++shaded_.volumes;
    shaded_.slabs += volume.outputs;
    for (std::uint32_t r = first; r < records_.size(); ++r)
      work_.add({v, group.samples.page}, r, records_[r].sample_count, kScatterGroupSize);
  }
}

Result<void> Volume::shade(streaming::Residency& residency, const ShadedLight& light,
                           evaluate::TransferMode mode, std::span<const std::uint8_t> in_view,
                           gpu::Counters& counters) {
  shaded_ = {};
  held_.follow(residency.volumes(), &streaming::ResidentVolume::id);
  if (residency.volumes().empty()) return {};
  collect(residency, light, mode, in_view);
  if (work_.empty()) return {};
  records_table_.assign(records_, counters);
  light.lights.bindStorage(kBindLights);
  records_table_.bindStorage(kBindScatter);
  std::vector<gpu::Define> defines;
  if (precise_) defines.push_back({"LAMBENT_PRECISE", "1"});
  return evaluate::run(
      work_, counters,
      [&](const gpu::BatchKey& key) {
        residency.volumes()[key[0]].voxels.bindStorage(kBindVoxels);
        residency.samples().page(key[1]).bindStorage(kBindSamples);
        glBindImageTexture(kImageLight, held_[key[0]].light.id(), 0, GL_TRUE, 0, GL_WRITE_ONLY,
                           precise_ ? GL_RGBA32F : GL_RGBA16F);
        return kernels_.use("volume_scatter.comp", defines);
      },
      GL_TEXTURE_FETCH_BARRIER_BIT);
}

std::uint64_t Volume::textureBytes() const {
  std::uint64_t bytes = 0;
  for (const Held& held : held_) {
    if (!held.light) continue;
    const gpu::TextureDesc& desc = held.light.desc();
    bytes += std::uint64_t{desc.width} * desc.height * desc.depth * (precise_ ? 16 : 8);
  }
  return bytes;
}

namespace {

// These are the uniform locations of volume_march.frag.
constexpr GLint kScale = 0, kOffset = 1, kPictureSize = 2, kPerspective = 3, kStepVoxels = 4;

void storeRows(const glm::dmat4& affine, glm::vec4 (&rows)[3]) {
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) rows[row][column] = static_cast<float>(affine[column][row]);
}

void scissor(const Rectangle& area) {
  glScissor(area.first.x, area.first.y, area.end.x - area.first.x, area.end.y - area.first.y);
}

bool holdsAnything(const streaming::ResidentVolume& volume) {
  return volume.grid.density_max > 0.0f && std::any_of(volume.block_maxima.begin(), volume.block_maxima.end(),
                                                       [](float share) { return share > 0.0f; });
}

}  // namespace

std::optional<MarchRecord> describeMarch(const streaming::ResidentVolume& volume,
                                         const glm::mat4& world_from_group,
                                         const glm::mat4& view_from_world) {
  const glm::dmat4 view_from_group = glm::dmat4(view_from_world) * glm::dmat4(world_from_group);
  const glm::dmat4 group_from_view = glm::inverse(view_from_group);
  const glm::dmat4 grid_from_box = glm::scale(glm::dmat4(1.0), glm::dvec3(volume.grid.size));
  const glm::dmat4 box_from_view =
      glm::inverse(view_from_group * glm::dmat4(volume.grid.group_from_grid) * grid_from_box);
  if (!isFinite(group_from_view) || !isFinite(box_from_view)) return {};
  const SlabLayout layout = slabLayoutOf(volume.grid.transfer_size, volume.outputs);
  MarchRecord record{};
  storeRows(box_from_view, record.box_from_view);
  storeRows(group_from_view, record.group_from_view);
  record.albedo = volume.grid.albedo;
  record.size = volume.grid.size;
  record.transfer_size = volume.grid.transfer_size;
  record.light_size = layout.texture_size;
  record.density_scale = volume.grid.density_max;
  record.outputs = volume.outputs;
  record.slabs_z = layout.slabs_z;
  return record;
}

Rectangle rectangleOf(const glm::mat4& clip_from_grid, const glm::uvec3& size, const spec::Size& picture) {
  glm::vec2 low(1.0f), high(-1.0f);
  bool beyond_near = true, beyond_far = true;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec3 at = glm::vec3(size) * glm::vec3(corner & 1, corner >> 1 & 1, corner >> 2);
    const glm::vec4 clip = clip_from_grid * glm::vec4(at, 1.0f);
    beyond_near &= clip.z < -clip.w;
    beyond_far &= clip.z > clip.w && clip.w > 0.0f;
    if (!(clip.w > 1e-6f)) {
      low = glm::vec2(-1.0f);
      high = glm::vec2(1.0f);
      continue;
    }
    low = glm::min(low, glm::vec2(clip) / clip.w);
    high = glm::max(high, glm::vec2(clip) / clip.w);
  }
  if (beyond_near || beyond_far) return {};
  low = glm::clamp(low, -1.0f, 1.0f);
  high = glm::clamp(high, -1.0f, 1.0f);
  if (!(low.x < high.x && low.y < high.y)) return {};
  const glm::vec2 extent(static_cast<float>(picture.width), static_cast<float>(picture.height));
  const glm::vec2 first = glm::floor((0.5f + 0.5f * low) * extent - 1.0f);
  const glm::vec2 end = glm::ceil((0.5f + 0.5f * high) * extent + 1.0f);
  return {glm::ivec2(glm::max(first, 0.0f)), glm::ivec2(glm::min(end, extent))};
}

March::March()
    : programs_(kVolumeShaders),
      records_("marched volumes"),
      blocks_("blocks of volumes"),
      no_vertices_("volumes") {}

void March::uploadBlocks(const streaming::Residency& residency, gpu::Counters& counters) {
  std::vector<std::uint64_t> versions;
  for (const streaming::ResidentVolume& volume : residency.volumes()) versions.push_back(volume.version);
  if (!blocks_changed_.renew(versions)) return;
  std::vector<float> blocks;
  first_block_.clear();
  for (const streaming::ResidentVolume& volume : residency.volumes()) {
    first_block_.push_back(static_cast<std::uint32_t>(blocks.size()));
    blocks.insert(blocks.end(), volume.block_maxima.begin(), volume.block_maxima.end());
  }
  blocks_.assign(blocks, counters);
}

void March::makeTargets(const spec::Size& size) {
  if (marched_ && marched_.desc().width == size.width && marched_.desc().height == size.height) return;
  marched_ = gpu::Texture("marched",
                          {.format = GL_RGBA16F, .width = size.width, .height = size.height, .layers = 2});
  marched_target_ = gpu::Framebuffer("marched", marched_);
}

Result<void> March::draw(const streaming::Residency& residency, const Volume& light,
                         std::span<const PlacedVolume> volumes, const spec::View& view,
                         const Picture& picture, gpu::Counters& counters) {
  drawn_ = 0;
  std::vector<Item> items;
  for (const PlacedVolume& placed : volumes) {
    const streaming::ResidentVolume& volume = residency.volumes()[placed.volume];
    if (!volume.ready() || placed.volume >= light.volumeCount() || !light.lightOf(placed.volume) ||
        !holdsAnything(volume))
      continue;
    const auto record = describeMarch(volume, placed.world_from_group, view.view_from_world);
    if (!record) continue;
    const glm::mat4 view_from_grid =
        view.view_from_world * placed.world_from_group * volume.grid.group_from_grid;
    const Rectangle rectangle =
        rectangleOf(view.clip_from_view * view_from_grid, volume.grid.size, picture.size);
    if (rectangle.empty()) continue;
    const glm::vec3 center(view_from_grid * glm::vec4(0.5f * glm::vec3(volume.grid.size), 1.0f));
    items.push_back({placed.volume, *record, rectangle, glm::length(center)});
  }
  if (items.empty()) return {};
  uploadBlocks(residency, counters);
  for (Item& item : items) item.record.first_block = first_block_[item.volume];
  std::stable_sort(items.begin(), items.end(),
                   [](const Item& a, const Item& b) { return a.distance > b.distance; });
  // All batches but the one drawn first are full, so that near volumes are marched together.
  for (std::size_t first = 0; first < items.size();) {
    const std::size_t left = items.size() - first;
    const std::size_t count = left % kMaxMarched != 0 ? left % kMaxMarched : kMaxMarched;
    if (Result<void> done =
            drawBatch(residency, light, std::span(items).subspan(first, count), view, picture, counters);
        !done)
      return done;
    first += count;
  }
  drawn_ = static_cast<std::uint32_t>(items.size());
  return {};
}

Result<void> March::drawBatch(const streaming::Residency& residency, const Volume& light,
                              std::span<const Item> items, const spec::View& view, const Picture& picture,
                              gpu::Counters& counters) {
  const auto count = static_cast<std::uint32_t>(items.size());
  const std::uint32_t samples = picture.depth.desc().samples;
  std::uint32_t bands = 1;
  std::vector<MarchRecord> records;
  Rectangle rectangle = items.front().rectangle;
  for (const Item& item : items) {
    bands = std::max(bands, transfer::bandsOf(item.record.outputs));
    records.push_back(item.record);
    rectangle = {glm::min(rectangle.first, item.rectangle.first),
                 glm::max(rectangle.end, item.rectangle.end)};
  }
  std::vector<gpu::Define> defines = {{"LAMBENT_VOLUMES", std::to_string(count)},
                                      {"LAMBENT_BANDS", std::to_string(bands)},
                                      {"LAMBENT_STOPS", samples > 0 ? "2" : "1"}};
  if (samples > 0) defines.push_back({"LAMBENT_SAMPLES", std::to_string(samples)});
  if (options_.jitter) defines.push_back({"LAMBENT_JITTER", "1"});
  const gpu::Stage triangle{GL_VERTEX_SHADER, "volume_march.vert"};
  if (Result<void> done = programs_.use({triangle, {GL_FRAGMENT_SHADER, "volume_march.frag"}}, defines);
      !done)
    return done;
  records_.assign(records, counters);
  records_.bindStorage(kBindMarch);
  blocks_.bindStorage(kBindBlocks);
  for (std::uint32_t v = 0; v < count; ++v) {
    const std::uint32_t index = items[v].volume;
    residency.volumes()[index].density.bind(kUnitDensity + v);
    light.lightOf(index).bind(kUnitDensity + count + v);
  }
  picture.depth.bind(kUnitDepth);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glEnable(GL_SCISSOR_TEST);
  // The rectangle is a pixel larger on each side than what is composited, because devices differ by that much
  // in how they clip pixels with several samples.
  scissor({glm::max(rectangle.first - 1, 0),
           glm::min(rectangle.end + 1, glm::ivec2(picture.size.width, picture.size.height))});
  const glm::mat4& p = view.clip_from_view;
  const auto setProjection = [&] {
    glUniform4f(kScale, p[0][0], p[1][1], p[2][2], p[3][2]);
    glUniform1i(kPerspective, p[2][3] != 0.0f ? 1 : 0);
  };
  const auto blend = [&] {
    glBindFramebuffer(GL_FRAMEBUFFER, picture.color.id());
    gpu::blendPremultiplied();
  };
  if (samples > 0) {
    makeTargets(picture.size);
    glBindFramebuffer(GL_FRAMEBUFFER, marched_target_.id());
    glDisable(GL_BLEND);
  } else {
    blend();
  }
  setProjection();
  glUniform4f(kOffset, p[2][0], p[2][1], p[3][0], p[3][1]);
  glUniform2f(kPictureSize, static_cast<float>(picture.size.width), static_cast<float>(picture.size.height));
  glUniform1f(kStepVoxels, options_.step_voxels);
  no_vertices_.draw(3, counters);
  if (samples > 0) {
    if (Result<void> done =
            programs_.use({triangle, {GL_FRAGMENT_SHADER, "volume_march.frag"}},
                          {{"LAMBENT_COMPOSITE", "1"}, {"LAMBENT_SAMPLES", std::to_string(samples)}});
        !done) {
      glDisable(GL_SCISSOR_TEST);
      return done;
    }
    scissor(rectangle);
    blend();
    marched_.bind(kUnitMarched);
    setProjection();
    no_vertices_.draw(3, counters);
  }
  glDisable(GL_BLEND);
  glDisable(GL_SCISSOR_TEST);
  glEnable(GL_DEPTH_TEST);
  return {};
}

}  // namespace lambent::effects::volume
