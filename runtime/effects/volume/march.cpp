#include "runtime/effects/volume/march.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>

#include "runtime/base/finite.hpp"
#include "runtime/effects/volume/volume.hpp"
#include "runtime/transfer/codebook.hpp"

namespace lambent::effects::volume {

namespace {

// These are the uniform locations of volume_march.frag.
constexpr GLint kScale = 0, kOffset = 1, kPictureSize = 2, kPerspective = 3, kStepVoxels = 4;

void storeRows(const glm::dmat4& affine, glm::vec4 (&rows)[3]) {
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) rows[row][column] = static_cast<float>(affine[column][row]);
}

Rectangle unite(const Rectangle& a, const Rectangle& b) {
  const std::int32_t x = std::min(a.x, b.x), y = std::min(a.y, b.y);
  return {x, y, std::max(a.x + a.width, b.x + b.width) - x, std::max(a.y + a.height, b.y + b.height) - y};
}

Rectangle grown(const Rectangle& r, const spec::Size& picture) {
  const std::int32_t x = std::max(r.x - 1, 0), y = std::max(r.y - 1, 0);
  return {x, y, std::min(r.x + r.width + 1, static_cast<std::int32_t>(picture.width)) - x,
          std::min(r.y + r.height + 1, static_cast<std::int32_t>(picture.height)) - y};
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
  const Rectangle all{0, 0, static_cast<std::int32_t>(picture.width),
                      static_cast<std::int32_t>(picture.height)};
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
  const Rectangle grown{static_cast<std::int32_t>(std::max(first.x, 0.0f)),
                        static_cast<std::int32_t>(std::max(first.y, 0.0f)), 0, 0};
  return {grown.x, grown.y, std::min(static_cast<std::int32_t>(end.x), all.width) - grown.x,
          std::min(static_cast<std::int32_t>(end.y), all.height) - grown.y};
}

March::March(const MarchOptions& options)
    : options_(options), records_("marched volumes"), blocks_("blocks of volumes") {}

Result<const gpu::Program*> March::program(const Kind& kind) {
  if (const auto found = programs_.find(kind); found != programs_.end()) return &found->second;
  std::vector<gpu::Define> defines = {{"LAMBENT_VOLUMES", std::to_string(kind.volumes)},
                                      {"LAMBENT_BANDS", std::to_string(kind.bands)},
                                      {"LAMBENT_STOPS", kind.samples > 0 ? "2" : "1"}};
  if (kind.samples > 0) defines.push_back({"LAMBENT_SAMPLES", std::to_string(kind.samples)});
  if (options_.jitter) defines.push_back({"LAMBENT_JITTER", "1"});
  Result<gpu::Program> made = gpu::Program::create(
      fmt::format("march {} volumes {} bands", kind.volumes, kind.bands),
      {{GL_VERTEX_SHADER, "volume_march.vert"}, {GL_FRAGMENT_SHADER, "volume_march.frag"}}, kVolumeShaders,
      defines);
  if (!made) return failAgain(made.error());
  return &programs_.emplace(kind, std::move(*made)).first->second;
}

Result<const gpu::Program*> March::compositeProgram(std::uint32_t samples) {
  if (const auto found = composites_.find(samples); found != composites_.end()) return &found->second;
  const gpu::Define defines[] = {{"LAMBENT_SAMPLES", std::to_string(samples)}};
  Result<gpu::Program> made = gpu::Program::create(
      "volume composite",
      {{GL_VERTEX_SHADER, "volume_march.vert"}, {GL_FRAGMENT_SHADER, "volume_composite.frag"}},
      kVolumeShaders, defines);
  if (!made) return failAgain(made.error());
  return &composites_.emplace(samples, std::move(*made)).first->second;
}

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
  blocks_.assign(std::span<const float>(blocks));
  counters.uploaded_bytes += blocks.size() * sizeof(float);
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
  Kind kind{.volumes = static_cast<std::uint32_t>(items.size()),
            .bands = 1,
            .samples = picture.depth.desc().samples};
  std::vector<MarchRecord> records;
  Rectangle rectangle = items.front().rectangle;
  for (const Item& item : items) {
    kind.bands = std::max(kind.bands, transfer::bandsOf(item.record.outputs));
    records.push_back(item.record);
    rectangle = unite(rectangle, item.rectangle);
  }
  const Result<const gpu::Program*> march = program(kind);
  if (!march) return failAgain(march.error());
  records_.assign(std::span<const MarchRecord>(records));
  counters.uploaded_bytes += records.size() * sizeof(MarchRecord);
  records_.bindStorage(kBindMarch);
  blocks_.bindStorage(kBindBlocks);
  for (std::uint32_t v = 0; v < kind.volumes; ++v) {
    const std::uint32_t index = items[v].volume;
    residency.volumes()[index].density.bind(kUnitDensity + v);
    light.lightOf(index).bind(kUnitDensity + kind.volumes + v);
    glBindSampler(kUnitDensity + v, 0);
    glBindSampler(kUnitDensity + kind.volumes + v, 0);
  }
  picture.depth.bind(kUnitDepth);
  glBindSampler(kUnitDepth, 0);
  if (!no_vertices_) no_vertices_ = gpu::VertexArray("volumes");
  glBindVertexArray(no_vertices_.id());
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glEnable(GL_SCISSOR_TEST);
  // The rectangle is a pixel larger on each side than what is composited, because devices differ by that much
  // in how they clip pixels with several samples.
  const Rectangle marched = grown(rectangle, picture.size);
  glScissor(marched.x, marched.y, marched.width, marched.height);
  const glm::mat4& p = view.clip_from_view;
  const auto setProjection = [&] {
    glUniform4f(kScale, p[0][0], p[1][1], p[2][2], p[3][2]);
    glUniform1i(kPerspective, p[2][3] != 0.0f ? 1 : 0);
  };
  const auto drawTriangle = [&] {
    glDrawArrays(GL_TRIANGLES, 0, 3);
    ++counters.draws;
    ++counters.draw_calls;
  };
  const auto blend = [&] {
    glBindFramebuffer(GL_FRAMEBUFFER, picture.color.id());
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  };
  if (kind.samples > 0) {
    makeTargets(picture.size);
    glBindFramebuffer(GL_FRAMEBUFFER, marched_target_.id());
    glDisable(GL_BLEND);
  } else {
    blend();
  }
  (*march)->use();
  setProjection();
  glUniform4f(kOffset, p[2][0], p[2][1], p[3][0], p[3][1]);
  glUniform2f(kPictureSize, static_cast<float>(picture.size.width), static_cast<float>(picture.size.height));
  glUniform1f(kStepVoxels, options_.step_voxels);
  drawTriangle();
  if (kind.samples > 0) {
    const Result<const gpu::Program*> composite = compositeProgram(kind.samples);
    if (!composite) {
      glDisable(GL_SCISSOR_TEST);
      return failAgain(composite.error());
    }
    glScissor(rectangle.x, rectangle.y, rectangle.width, rectangle.height);
    blend();
    marched_.bind(kUnitMarched);
    (*composite)->use();
    setProjection();
    drawTriangle();
  }
  glDisable(GL_BLEND);
  glDisable(GL_SCISSOR_TEST);
  glEnable(GL_DEPTH_TEST);
  return {};
}

}  // namespace lambent::effects::volume
