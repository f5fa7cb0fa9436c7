#include "runtime/streaming/resident_tables.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <span>
#include <utility>

#include <glm/gtc/quaternion.hpp>

#include "runtime/base/normal_matrix.hpp"
#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/bundle/gltf_types.hpp"
#include "runtime/gpu/arena.hpp"

namespace lambent::streaming {

namespace {

std::uint64_t vertexBytes(const bundle::DracoAttributes& attributes) {
  std::uint64_t bytes = 12;
  if (attributes.normal >= 0) bytes += 12;
  if (attributes.texcoord0 >= 0) bytes += 8;
  if (attributes.texcoord1 >= 0) bytes += 8;
  if (attributes.color0 >= 0) bytes += 8;
  if (attributes.tangent >= 0) bytes += 16;
  return bytes;
}

}  // namespace

std::uint64_t planeBytes(const bundle::WeightPlane& plane) {
  constexpr std::uint64_t kBlock = gpu::Arena::kAlignment;
  const std::uint64_t bytes = std::uint64_t{plane.count} * plane.bits / 8;
  return std::max((bytes + kBlock - 1) / kBlock * kBlock, kBlock);
}

std::uint64_t codebookBytesOnGpu(const bundle::CellTransfer& transfer, std::uint32_t sample_count) {
  const std::uint64_t vectors = std::uint64_t{transfer.clusters} + transfer.axes;
  return 4 * (2ull * transfer.clusters + vectors * (2 + transfer.shape.size()) + sample_count);
}

std::uint64_t cellBytes(const bundle::Cell& cell) {
  std::uint64_t bytes = cell.light_probes.size() > 1 ? 4ull * kLightWeightWords * cell.sample_count : 0;
  for (const bundle::CellTransfer& transfer : cell.transfers) {
    bytes += codebookBytesOnGpu(transfer, cell.sample_count);
    for (const bundle::WeightPlane& plane : transfer.planes) bytes += planeBytes(plane);
  }
  return bytes;
}

std::uint64_t samplesOf(const bundle::Group& group) {
  std::uint64_t count = 0;
  for (const bundle::Cell& cell : group.cells) count += std::uint64_t{cell.outputs()} * cell.sample_count;
  return count;
}

std::uint64_t irradianceBytes(std::uint32_t side) {
  std::uint64_t bytes = 0;
  for (std::uint64_t level = side; level > 0; level /= 2) bytes += 8 * level * level;
  return bytes;
}

std::uint64_t volumeBytes(const bundle::VolumeGrid& grid, std::uint64_t sample_count) {
  return densityBytes(grid.size) + 4 * sample_count;
}

std::uint64_t volumeLightBytes(const bundle::Group& group) {
  if (!group.volume || group.cells.empty()) return 0;
  const glm::uvec3& size = group.volume->transfer_size;
  return std::uint64_t{8} * size.x * size.y * size.z * group.cells.front().outputs();
}

std::uint64_t proxyLodBytes(const bundle::Description& description, bundle::GroupIndex group) {
  const std::int32_t payload = description.groups[group.value].proxy;
  if (payload < 0) return 0;
  // A payload has at least emission, corners, light and flags of each triangle (docs/format.md).
  constexpr std::uint64_t kStoredBytes = 12 + 6 + 2 + 1;
  const std::uint64_t stored =
      description.payloads[static_cast<std::size_t>(payload)].raw_length / kStoredBytes;
  return kProxyLodGroupBytes +
         kProxyLodTriangleBytes * std::min<std::uint64_t>(stored, bundle::kMaxProxyTriangles);
}

Needs needsOf(const bundle::Description& description) {
  constexpr std::uint64_t kSlack = gpu::Arena::kAlignment;
  Needs needs;
  for (const bundle::Mesh& mesh : description.meshes)
    for (const bundle::Primitive& primitive : mesh.primitives)
      needs.geometry +=
          vertexBytes(primitive.attributes) * primitive.vertex_count + 4ull * primitive.index_count + kSlack;
  for (const bundle::Group& group : description.groups) {
    needs.samples += 16 * samplesOf(group);
    for (const bundle::Cell& cell : group.cells) needs.transfer += cellBytes(cell) + kSlack;
    if (group.volume)
      needs.volumes += volumeBytes(*group.volume, group.sample_count) + volumeLightBytes(group);
  }
  for (const bundle::Draw& draw : description.draws) {
    const std::uint64_t vertices = description.meshes[draw.mesh].primitives[draw.primitive].vertex_count;
    needs.rows += description.payloads[draw.rows].raw_length + 6 * vertices + 3 * kSlack;
    needs.textures += irradianceBytes(draw.texels);
    if (!draw.glossy())
      needs.radiance +=
          4ull * vertexWords(draw.form(), bundle::isLayered(description, draw)) * vertices + kSlack;
  }
  return needs;
}

namespace {

ResidentTransfer describe(const bundle::CellTransfer& transfer) {
  ResidentTransfer resident;
  resident.shape = transfer.shape;
  resident.clusters = transfer.clusters;
  resident.axes = transfer.axes;
  for (const bundle::WeightPlane& plane : transfer.planes) resident.planes.push_back({plane});
  return resident;
}

ResidentCell describe(const bundle::Cell& cell, std::uint32_t first_output) {
  ResidentCell resident{.domain = cell.domain,
                        .first_sample = cell.first_sample,
                        .sample_count = cell.sample_count,
                        .outputs = cell.outputs(),
                        .first_output = first_output,  // relative to the group's samples for now
                        .block = {},
                        .transfers = {},
                        .light_probes = cell.light_probes,
                        .light_weights_resident = cell.light_probes.size() == 1};
  for (const bundle::CellTransfer& transfer : cell.transfers)
    resident.transfers.push_back(describe(transfer));
  return resident;
}

ResidentGroup describe(const bundle::Group& group) {
  ResidentGroup resident;
  resident.light_columns = static_cast<std::uint32_t>(group.lights.size());
  resident.cell_count = static_cast<std::uint32_t>(group.cells.size());
  resident.diffuse_samples = group.samplesOf(transfer::Form::Vector);
  resident.mapped_samples = group.samplesOf(transfer::Form::NormalMapped);
  resident.light_probes = group.light_probes;
  for (const bundle::Cell& cell : group.cells) {
    for (const bundle::CellTransfer& transfer : cell.transfers)
      resident.order = std::max(resident.order, transfer.shape.order);
    if (cell.isGlossySurface()) resident.glossy_outputs = cell.outputs();
  }
  return resident;
}

ResidentVolume describeVolume(const bundle::Group& group) {
  ResidentVolume volume;
  volume.grid = *group.volume;
  volume.outputs = group.cells.empty() ? 1 : group.cells.front().outputs();
  volume.sample_count = group.samplesOf(transfer::Domain::Voxel);  // a neighborhood has its own
  return volume;
}

// Gives bundles their ranges, after entries were inserted or removed, and adjusts the indices in entries.
void renumber(ResidentTables& tables) {
  TableSizes next;
  for (std::uint32_t slot = 0; slot < tables.bundles.size(); ++slot) {
    ResidentBundle& bundle = tables.bundles[slot];
    const TableSizes before = std::exchange(bundle.first, next), &count = bundle.count;
    // Numbers wrap around, so that entries may also move towards the front.
    const std::uint32_t groups = next.groups - before.groups, meshes = next.meshes - before.meshes;
    for (ResidentGroup& group : std::span(tables.groups).subspan(next.groups, count.groups)) {
      group.bundle = slot;
      group.first_cell += next.cells - before.cells;
      if (group.volume >= 0) group.volume += static_cast<std::int32_t>(next.volumes - before.volumes);
    }
    for (ResidentCell& cell : std::span(tables.cells).subspan(next.cells, count.cells)) cell.group += groups;
    for (ResidentVolume& volume : std::span(tables.volumes).subspan(next.volumes, count.volumes))
      volume.group += groups;
    for (ResidentDraw& draw : std::span(tables.draws).subspan(next.draws, count.draws)) {
      draw.bundle = slot;
      draw.group += groups;
      draw.mesh += meshes;
    }
    next = {next.meshes + count.meshes, next.groups + count.groups, next.cells + count.cells,
            next.draws + count.draws, next.volumes + count.volumes};
  }
}

template <class Entry>
void insertAt(std::vector<Entry>& into, std::uint32_t place, std::vector<Entry>& entries) {
  into.insert(into.begin() + place, std::make_move_iterator(entries.begin()),
              std::make_move_iterator(entries.end()));
}

template <class Entry>
std::vector<Entry> takeFrom(std::vector<Entry>& from, std::uint32_t place, std::uint32_t count) {
  const auto begin = from.begin() + place, end = begin + count;
  std::vector<Entry> taken(std::make_move_iterator(begin), std::make_move_iterator(end));
  from.erase(begin, end);
  return taken;
}

}  // namespace

std::uint32_t ResidentDraw::seenWord(const ResidentMesh& of) const {
  return radiance.word() + radianceWords(form()) * of.vertex_count;
}

bool ResidentCell::usable() const {
  if (!light_weights_resident) return false;
  for (const ResidentTransfer& transfer : transfers) {
    if (!transfer.codebook_resident) return false;
    if (transfer.planes_resident == transfer.planes.size()) continue;
    float all = 0.0f, here = 0.0f;
    for (std::size_t i = 0; i < transfer.planes.size(); ++i) {
      all += transfer.planes[i].variance;
      if (i < transfer.planes_resident) here += transfer.planes[i].variance;
    }
    if (here < kUsableVariance * all || here == 0.0f) return false;
  }
  return !transfers.empty();
}

ResidentTables tablesOf(const bundle::Description& description, std::uint64_t version,
                        std::uint64_t& next_id) {
  ResidentTables tables;
  ResidentBundle bundle;
  bundle.present = true;
  bundle.materials = description.materials;
  bundle.textures = description.textures;
  bundle.images = std::vector<gpu::Texture>(description.images.size());
  bundle.linear_images = std::vector<gpu::Texture>(description.images.size());
  bundle.image_uses = imageUses(description);
  bundle.brdf_tables = std::vector<BrdfTexture>(description.brdf_tables.size());
  for (const bundle::BrdfTableEntry& entry : description.brdf_tables)
    bundle.brdf_families.push_back(entry.family);
  for (const bundle::Mesh& mesh : description.meshes) {
    bundle.first_primitive.push_back(static_cast<std::uint32_t>(tables.meshes.size()));
    for (const bundle::Primitive& primitive : mesh.primitives) {
      ResidentMesh resident;
      resident.vertex_count = primitive.vertex_count;
      resident.index_count = primitive.index_count;
      resident.center = 0.5f * (primitive.bounds_min + primitive.bounds_max);
      tables.meshes.push_back(resident);
    }
  }
  for (const bundle::Group& group : description.groups) {
    const auto index = static_cast<std::uint32_t>(tables.groups.size());
    ResidentGroup& resident = tables.groups.emplace_back(describe(group));
    resident.id = next_id++;
    resident.index = bundle::GroupIndex{index};
    resident.first_cell = static_cast<std::uint32_t>(tables.cells.size());
    std::uint32_t next_output = 0;
    for (const bundle::Cell& cell : group.cells) {
      ResidentCell& made = tables.cells.emplace_back(describe(cell, next_output));
      made.id = next_id++;
      made.group = index;
      made.version = version;
      next_output += made.outputs * made.sample_count;
    }
    if (!group.volume) continue;
    resident.volume = static_cast<std::int32_t>(tables.volumes.size());
    ResidentVolume& volume = tables.volumes.emplace_back(describeVolume(group));
    volume.id = next_id++;
    volume.group = index;
    volume.version = version;
  }
  const std::vector<glm::mat4> world_from_node = gltf::worldTransforms(description.nodes);
  for (const bundle::Draw& draw : description.draws) {
    ResidentDraw& made = tables.draws.emplace_back();
    made.id = next_id++;
    made.index = static_cast<std::uint32_t>(tables.draws.size() - 1);
    made.group = draw.group;
    made.mesh = bundle.first_primitive[draw.mesh] + draw.primitive;
    made.material = description.meshes[draw.mesh].primitives[draw.primitive].material;
    made.back = draw.back;
    made.outputs = draw.outputs;
    made.texels = draw.texels;
    made.texel_set = draw.texel_set;
    made.layered = bundle::isLayered(description, draw);
    const glm::quat group_from_world = glm::conjugate(description.groups[draw.group].rest_rotation);
    made.group_from_mesh = glm::mat3_cast(group_from_world) * glm::mat3(world_from_node[draw.node]);
    made.group_from_mesh_normal = (draw.back ? -1.0f : 1.0f) * normalMatrix(made.group_from_mesh);
    made.version = version;
  }
  const auto size = [](const auto& table) { return static_cast<std::uint32_t>(table.size()); };
  bundle.count = {size(tables.meshes), size(tables.groups), size(tables.cells), size(tables.draws),
                  size(tables.volumes)};
  tables.bundles.push_back(std::move(bundle));
  return tables;
}

void insert(ResidentTables& tables, std::uint32_t slot, ResidentTables one) {
  assert(one.bundles.size() == 1);
  if (tables.bundles.size() <= slot) tables.bundles.resize(slot + 1u);
  renumber(tables);
  assert(!tables.bundles[slot].present);
  const TableSizes at = tables.bundles[slot].first;
  insertAt(tables.meshes, at.meshes, one.meshes);
  insertAt(tables.groups, at.groups, one.groups);
  insertAt(tables.cells, at.cells, one.cells);
  insertAt(tables.draws, at.draws, one.draws);
  insertAt(tables.volumes, at.volumes, one.volumes);
  tables.bundles[slot] = std::move(one.bundles.front());
  renumber(tables);
}

ResidentTables extract(ResidentTables& tables, std::uint32_t slot) {
  const TableSizes at = tables.bundles[slot].first, count = tables.bundles[slot].count;
  ResidentTables one;
  one.bundles.push_back(std::exchange(tables.bundles[slot], {}));
  one.meshes = takeFrom(tables.meshes, at.meshes, count.meshes);
  one.groups = takeFrom(tables.groups, at.groups, count.groups);
  one.cells = takeFrom(tables.cells, at.cells, count.cells);
  one.draws = takeFrom(tables.draws, at.draws, count.draws);
  one.volumes = takeFrom(tables.volumes, at.volumes, count.volumes);
  renumber(one);
  renumber(tables);
  return one;
}

}  // namespace lambent::streaming
