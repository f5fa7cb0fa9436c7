#include "runtime/streaming/loader.hpp"

#include <algorithm>
#include <cassert>
#include <exception>
#include <new>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "runtime/bundle/description.hpp"
#include "runtime/streaming/resident_tables.hpp"
#include "runtime/streaming/textures.hpp"

namespace lambent::streaming {

namespace {

float meanEdge(const bundle::MeshData& mesh) {
  double sum = 0.0;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
    for (std::size_t k = 0; k < 3; ++k)
      sum += double{
          glm::distance(mesh.positions[mesh.indices[i + k]], mesh.positions[mesh.indices[i + (k + 1) % 3]])};
  return mesh.indices.empty() ? 0.0f : static_cast<float>(sum / static_cast<double>(mesh.indices.size()));
}

template <class... Fs>
struct Overloaded : Fs... {
  using Fs::operator()...;
};
template <typename... Fs>
Overloaded(Fs...) -> Overloaded<Fs...>;  // Clang 16 deduces no arguments of aggregates

struct Ranked {
  std::uint32_t priority;
  Work work;
};

void appendByPriority(std::vector<Work>& list, std::vector<Ranked> ranked) {
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const Ranked& a, const Ranked& b) { return a.priority < b.priority; });
  for (const Ranked& item : ranked) list.push_back(item.work);
}

template <class Place>  // a request with a group and a cell
const bundle::Cell& cellOf(const bundle::Description& description, const Place& at) {
  return description.groups[at.group.value].cells[at.cell.value];
}
template <class Place>
const bundle::CellTransfer& transferOf(const bundle::Description& description, const Place& at) {
  return cellOf(description, at).transfers[at.transfer.value];
}

template <class T>
std::size_t sizeInBytes(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}

using Loaded = std::optional<Result<Ready>>;

class Load {
 public:
  Load(const bundle::Reader& reader, const Reserve& reserve)
      : reader_(reader), description_(reader.description()), reserve_(reserve) {}

  Loaded operator()(const MeshRequest& work) const {
    const bundle::Primitive& primitive = description_.meshes[work.mesh].primitives[work.primitive];
    // This assumes that every attribute is present; reserving too much does no harm.
    constexpr std::size_t kVertexBytes = sizeof(float) * (3 + 3 + 2 + 2 + 4 + 4);
    if (!reserve_(primitive.vertex_count * kVertexBytes + primitive.index_count * sizeof(std::uint32_t)))
      return {};
    auto mesh = reader_.readMesh(work.mesh, work.primitive);
    if (!mesh) return failAgain(mesh.error());
    bundle::weighNormals(*mesh);
    const float mean_edge = meanEdge(*mesh);
    return MeshChunk{work.mesh, work.primitive, std::move(*mesh), mean_edge};
  }

  Loaded operator()(const WeightsRequest& work) const {
    // An entry has six bytes in the file and eight in memory.
    if (!reserve_(description_.payloads[description_.draws[work.draw].rows].raw_length * 2)) return {};
    auto rows = reader_.readRows(work.draw);
    if (!rows) return failAgain(rows.error());
    return WeightsChunk{work.draw, std::move(*rows)};
  }

  Loaded operator()(const ImageRequest& work) const {
    const bundle::Image& image = description_.images[work.image];
    const std::string subject = named(fmt::format("image {} \"{}\"", work.image, image.name));
    const auto file = reader_.readView(image.view);
    if (!file) return failAgain(file.error());
    const auto size = imageSize(*file, subject);
    if (!size) return failAgain(size.error());
    if (!reserve_(size->rgbaBytes())) return {};
    auto rgba = decodeRgba(*file, subject);
    if (!rgba) return failAgain(rgba.error());
    if (work.level == 0) return ImageChunk{work.image, size->width, size->height, std::move(*rgba)};
    const ImageUse use = imageUses(description_)[work.image];
    const ImageSize small = sizeAt(*size, work.level);
    ImageChunk ready{work.image, small.width, small.height, shrink(*rgba, *size, work.level, use.color)};
    if (use.color && use.linear) ready.linear = shrink(*rgba, *size, work.level, /*color=*/false);
    return ready;
  }

  Loaded operator()(const CodebookRequest& work) const {
    const bundle::CellTransfer& transfer = transferOf(description_, work);
    const std::uint32_t samples = cellOf(description_, work).sample_count;
    // The codebook as on the GPU and the cluster of each sample are needed.
    if (!reserve_(codebookBytesOnGpu(transfer, samples) + 4 * std::size_t{samples})) return {};
    auto found = reader_.readCodebook(work.group, work.cell, work.transfer);
    if (!found) return failAgain(found.error());
    std::vector<std::uint32_t> positions = transfer::positionsOf(found->cluster_of, transfer.clusters);
    for (std::uint32_t& position : positions) position |= found->cluster_of[position] << 16;
    return CodebookChunk{work.group, work.cell, work.transfer, std::move(found->codebook),
                         std::move(positions)};
  }

  Loaded operator()(const PlaneRequest& work) const {
    const bundle::WeightPlane& plane = transferOf(description_, work).planes[work.plane.value];
    if (!reserve_(5 * std::size_t{plane.count})) return {};
    const auto codes = reader_.readPlane(work.group, work.cell, work.transfer, work.plane);
    if (!codes) return failAgain(codes.error());
    PlaneChunk ready{work.group, work.cell, work.transfer, work.plane, {}};
    ready.codes.reserve(codes->size() * plane.bits / 8);
    for (const std::uint32_t code : *codes) {
      ready.codes.push_back(static_cast<std::byte>(code & 0xff));
      if (plane.bits == 16) ready.codes.push_back(static_cast<std::byte>(code >> 8));
    }
    return ready;
  }

  Loaded operator()(const LightWeightsRequest& work) const {
    const std::size_t bytes = sizeof(transfer::LightWeights) * cellOf(description_, work).sample_count;
    if (!reserve_(2 * bytes)) return {};
    auto weights = reader_.readLightWeights(work.group, work.cell);
    if (!weights) return failAgain(weights.error());
    return LightWeightsChunk{work.group, work.cell, std::move(*weights)};
  }

  Loaded operator()(const ProxyRequest& work) const {
    const auto payload = static_cast<std::size_t>(description_.groups[work.group.value].proxy);
    if (!reserve_(3 * description_.payloads[payload].raw_length)) return {};
    auto proxy = reader_.readProxy(work.group);
    if (!proxy) return failAgain(proxy.error());
    return ProxyChunk{work.group, std::move(*proxy)};
  }

  Loaded operator()(const DensityRequest& work) const {
    const bundle::VolumeGrid& grid = *description_.groups[work.group.value].volume;
    if (!reserve_(2 * description_.payloads[grid.density].raw_length)) return {};
    auto codes = reader_.readPayload(grid.density);
    if (!codes) return failAgain(codes.error());
    std::vector<float> maxima = blockMaxima(*codes, grid.bits, grid.size);
    return DensityChunk{work.group, std::move(*codes), std::move(maxima)};
  }

  Loaded operator()(const VoxelsRequest& work) const {
    const bundle::VolumeGrid& grid = *description_.groups[work.group.value].volume;
    if (!reserve_(3 * description_.payloads[grid.voxels].raw_length)) return {};
    const auto bytes = reader_.readPayload(grid.voxels);
    if (!bytes) return failAgain(bytes.error());
    auto voxels =
        bundle::decodeVoxels(*bytes, grid.transfer_size, named(fmt::format("group {}", work.group.value)));
    if (!voxels) return failAgain(voxels.error());
    return VoxelsChunk{work.group, std::move(*voxels)};
  }

  Loaded operator()(const BrdfRequest& work) const {
    const bundle::BrdfTableEntry& entry = description_.brdf_tables[work.table];
    // The payload, the table and the texels have similar sizes.
    if (!reserve_(8 * description_.payloads[entry.payload].raw_length)) return {};
    auto table = reader_.readBrdfTable(work.table);
    if (!table) return failAgain(table.error());
    BrdfTexels texels = packBrdf(*table);
    return BrdfChunk{work.table, std::move(*table), std::move(texels)};
  }

 private:
  // Returns "PATH: WHAT", the subject of an error.
  std::string named(const std::string& what) const { return reader_.path().string() + ": " + what; }
  static Result<Ready> failAgain(Error error) { return lambent::failAgain(std::move(error)); }

  const bundle::Reader& reader_;
  const bundle::Description& description_;
  const Reserve& reserve_;
};

}  // namespace

std::vector<Work> requestsOf(const bundle::Description& d) {
  std::vector<Work> list;
  for (std::uint32_t mesh = 0; mesh < d.meshes.size(); ++mesh) {
    for (std::uint32_t p = 0; p < d.meshes[mesh].primitives.size(); ++p) list.push_back(MeshRequest{mesh, p});
  }
  std::vector<Ranked> rows, transfer;
  for (std::uint32_t draw = 0; draw < d.draws.size(); ++draw) {
    rows.push_back({d.payloads[d.draws[draw].rows].priority, WeightsRequest{draw}});
  }
  appendByPriority(list, std::move(rows));
  for (std::uint32_t table = 0; table < d.brdf_tables.size(); ++table) list.push_back(BrdfRequest{table});
  for (std::uint32_t g = 0; g < d.groups.size(); ++g) {
    if (!d.groups[g].volume) continue;
    list.push_back(DensityRequest{bundle::GroupIndex{g}});
    list.push_back(VoxelsRequest{bundle::GroupIndex{g}});
  }
  for (std::uint32_t image = 0; image < d.images.size(); ++image) list.push_back(ImageRequest{image});
  for (std::uint32_t g = 0; g < d.groups.size(); ++g) {
    const bundle::GroupIndex group{g};
    const std::int32_t proxy = d.groups[g].proxy;
    if (proxy >= 0)
      transfer.push_back({d.payloads[static_cast<std::size_t>(proxy)].priority, ProxyRequest{group}});
    for (std::uint32_t c = 0; c < d.groups[g].cells.size(); ++c) {
      const bundle::CellIndex cell{c};
      const auto& parts = d.groups[g].cells[c].transfers;
      const std::int32_t weights = d.groups[g].cells[c].light_weights;
      if (weights >= 0)
        transfer.push_back(
            {d.payloads[static_cast<std::size_t>(weights)].priority, LightWeightsRequest{group, cell}});
      for (std::uint32_t t = 0; t < parts.size(); ++t) {
        std::uint32_t priority = d.payloads[parts[t].codebook].priority;
        transfer.push_back({priority, CodebookRequest{group, cell, bundle::TransferIndex{t}}});
        for (std::uint32_t p = 0; p < parts[t].planes.size(); ++p) {
          priority = std::max(priority, d.payloads[parts[t].planes[p].payload].priority);
          transfer.push_back(
              {priority, PlaneRequest{group, cell, bundle::TransferIndex{t}, bundle::PlaneIndex{p}}});
        }
      }
    }
  }
  appendByPriority(list, std::move(transfer));
  return list;
}

std::optional<Result<Ready>> load(const bundle::Reader& reader, const Work& work, const Reserve& reserve) {
  return std::visit(Load(reader, reserve), work);
}

std::size_t bytesOf(const Ready& ready) {
  return std::visit(
      Overloaded{
          [](const MeshChunk& item) {
            return sizeInBytes(item.data.positions) + sizeInBytes(item.data.normals) +
                   sizeInBytes(item.data.texcoords0) + sizeInBytes(item.data.texcoords1) +
                   sizeInBytes(item.data.colors) + sizeInBytes(item.data.tangents) +
                   sizeInBytes(item.data.indices);
          },
          [](const ImageChunk& item) { return sizeInBytes(item.rgba) + sizeInBytes(item.linear); },
          [](const WeightsChunk& item) {
            return sizeInBytes(item.rows.offsets) + sizeInBytes(item.rows.samples) +
                   sizeInBytes(item.rows.weights);
          },
          [](const CodebookChunk& item) {
            return sizeInBytes(item.codebook.axis_counts) + sizeInBytes(item.codebook.axes) +
                   sizeInBytes(item.codebook.vectors) + sizeInBytes(item.positions);
          },
          [](const PlaneChunk& item) { return sizeInBytes(item.codes); },
          [](const LightWeightsChunk& item) { return sizeInBytes(item.samples); },
          [](const ProxyChunk& item) {
            return sizeInBytes(item.proxy.positions) + sizeInBytes(item.proxy.triangles) +
                   sizeInBytes(item.proxy.entries) + sizeInBytes(item.proxy.levels);
          },
          [](const BrdfChunk& item) {
            return sizeInBytes(item.data.values) + sizeInBytes(item.texels.values);
          },
          [](const DensityChunk& item) { return sizeInBytes(item.codes) + sizeInBytes(item.block_maxima); },
          [](const VoxelsChunk& item) { return sizeInBytes(item.voxels); }},
      ready);
}

namespace {

// The blocks that a voxel contributes to: its own, and the adjacent one if it lies at the border.
struct Blocks {
  std::uint32_t first, last;
};
Blocks blocksAt(std::uint32_t voxel, std::uint32_t count) {
  const std::uint32_t own = voxel / kVolumeBlock, place = voxel % kVolumeBlock;
  return {place == 0 && own > 0 ? own - 1 : own,
          place == kVolumeBlock - 1 ? std::min(own + 1, count - 1) : own};
}

}  // namespace

std::vector<float> blockMaxima(std::span<const std::byte> codes, std::uint32_t bits, const glm::uvec3& size) {
  const std::size_t width = bits / 8;
  assert(codes.size() == width * size.x * size.y * size.z);
  const glm::uvec3 count = blocksOf(size);
  std::vector<std::uint32_t> maxima(std::size_t{count.x} * count.y * count.z, 0);
  std::size_t at = 0;
  for (std::uint32_t z = 0; z < size.z; ++z)
    for (std::uint32_t y = 0; y < size.y; ++y)
      for (std::uint32_t x = 0; x < size.x; ++x, at += width) {
        auto code = std::to_integer<std::uint32_t>(codes[at]);
        if (width == 2) code |= std::to_integer<std::uint32_t>(codes[at + 1]) << 8;
        if (code == 0) continue;
        const Blocks in_x = blocksAt(x, count.x), in_y = blocksAt(y, count.y), in_z = blocksAt(z, count.z);
        for (std::uint32_t k = in_z.first; k <= in_z.last; ++k)
          for (std::uint32_t j = in_y.first; j <= in_y.last; ++j)
            for (std::uint32_t i = in_x.first; i <= in_x.last; ++i) {
              std::uint32_t& most = maxima[i + std::size_t{count.x} * (j + std::size_t{count.y} * k)];
              most = std::max(most, code);
            }
      }
  const float largest = bits == 16 ? 65535.0f : 255.0f;
  std::vector<float> shares(maxima.size());
  std::transform(maxima.begin(), maxima.end(), shares.begin(),
                 [&](std::uint32_t code) { return static_cast<float>(code) / largest; });
  return shares;
}

namespace {

// Limit of the memory of items that are decoded, or being decoded, but not taken. The item that will be taken
// next never waits for memory, so the actual limit is one item more, and workers cannot block each other.
constexpr std::size_t kMaxHeldBytes = std::size_t{64} << 20;

}  // namespace

Loader::Loader(std::shared_ptr<const bundle::Reader> reader, ThreadPool& threads, unsigned workers)
    : Loader(reader, requestsOf(reader->description()), threads, workers) {}

Loader::Loader(std::shared_ptr<const bundle::Reader> reader, std::vector<Work> work, ThreadPool& threads,
               unsigned workers)
    : reader_(std::move(reader)), work_(std::move(work)), slots_(work_.size()) {
  working_ = std::min<std::size_t>(std::max(workers, 1u), work_.size());
  for (std::size_t i = 0, count = working_; i < count; ++i)
    threads.run([this] {
      runWorker();
      const std::lock_guard lock(mutex_);
      --working_;
      ended_.notify_all();  // needs the lock, because the waiting thread destroys this object
    });
}

Loader::~Loader() {
  stop();
  std::unique_lock lock(mutex_);
  ended_.wait(lock, [&] { return working_ == 0; });
}

void Loader::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  room_.notify_all();
}

void Loader::runWorker() {
  for (;;) {
    std::size_t at = 0;
    {
      const std::lock_guard lock(mutex_);
      if (stopping_ || next_claim_ >= end()) return;
      at = next_claim_++;
    }
    auto loaded = loadOne(at);
    if (!loaded) return;
    {
      const std::lock_guard lock(mutex_);
      if (*loaded) {
        hold(at, bytesOf(**loaded));
        slots_[at].ready = std::move(**loaded);
      } else {
        hold(at, 0);
        if (at < failed_at_) {
          failed_at_ = at;
          failure_ = std::move(loaded->error());
        }
      }
    }
    more_.notify_all();
    room_.notify_all();
  }
}

std::optional<Result<Ready>> Loader::loadOne(std::size_t at) {
  const std::string& path = reader_->path().string();
  try {
    return load(*reader_, work_[at], [&](std::size_t bytes) { return reserve(at, bytes); });
  } catch (const std::bad_alloc&) {
    return fail(path, "does not fit into memory", "close other programs or bake the scene at lower quality");
  } catch (const std::exception& exception) {
    return fail(path, exception.what(), "bake it again");
  }
}

bool Loader::reserve(std::size_t at, std::size_t bytes) {
  std::unique_lock lock(mutex_);
  const auto unwanted = [&] { return stopping_ || at >= end(); };
  room_.wait(lock, [&] { return unwanted() || at == next_take_ || held_bytes_ + bytes <= kMaxHeldBytes; });
  if (unwanted()) return false;
  hold(at, bytes);
  return true;
}

void Loader::hold(std::size_t at, std::size_t bytes) {
  held_bytes_ += bytes - slots_[at].held;
  slots_[at].held = bytes;
}

std::vector<Ready> Loader::take(std::size_t max_bytes) {
  std::vector<Ready> taken;
  {
    const std::lock_guard lock(mutex_);
    std::size_t bytes = 0;
    while (frontIsReady()) {
      Slot& front = slots_[next_take_];
      if (!taken.empty() && bytes + front.held > max_bytes) break;
      bytes += front.held;
      taken.push_back(std::move(*front.ready));
      front.ready.reset();
      hold(next_take_, 0);
      ++next_take_;
    }
  }
  if (!taken.empty()) room_.notify_all();
  return taken;
}

void Loader::waitForMore(std::chrono::milliseconds most) {
  std::unique_lock lock(mutex_);
  more_.wait_for(lock, most, [&] { return frontIsReady() || next_take_ >= end(); });
}

bool Loader::finished() const {
  const std::lock_guard lock(mutex_);
  return next_take_ >= end();
}

std::optional<Error> Loader::error() const {
  const std::lock_guard lock(mutex_);
  // Items before the failed one may still be loading, and one of them may fail too.
  for (std::size_t at = next_take_; at < end(); ++at)
    if (!slots_[at].ready) return std::nullopt;
  return failed_at_ == kNone ? std::nullopt : std::optional(failure_);
}

bool Loader::idle() const {
  const std::lock_guard lock(mutex_);
  return working_ == 0;
}

}  // namespace lambent::streaming
