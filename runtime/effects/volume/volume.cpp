#include "runtime/effects/volume/volume.hpp"

#include <algorithm>

#include "lambent_effects_volume_embedded.hpp"
#include "runtime/streaming/loader.hpp"

namespace lambent::effects::volume {

const gpu::FindText kVolumeShaders[1] = {&embedded::lambent_effects_volume::find};

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
    : precise_(precise), records_table_("volume cells"), work_("volume scatter work") {}

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
  records_table_.assign(std::span<const ScatterRecord>(records_));
  counters.uploaded_bytes += records_.size() * sizeof(ScatterRecord);
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

}  // namespace lambent::effects::volume
