#include "runtime/streaming/loader.hpp"

#include <algorithm>
#include <cassert>
#include <exception>
#include <functional>
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

template <class... T>
std::size_t bytesIn(const std::vector<T>&... lists) {
  return (... + (lists.size() * sizeof(T)));
}

// Reserves the bytes that an item will need in memory. Returns false if the item is not wanted any more.
using Reserve = std::function<bool(std::size_t)>;
using Loaded = std::optional<Result<Ready>>;  // nothing if `reserve` returned false

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
    return made(reader_.readMesh(work.mesh, work.primitive), [&](bundle::MeshData mesh) {
      bundle::weighNormals(mesh);
      const float mean_edge = meanEdge(mesh);
      return MeshChunk{work, std::move(mesh), mean_edge};
    });
  }

  Loaded operator()(const WeightsRequest& work) const {
    // An entry has six bytes in the file and eight in memory.
    if (!reserve_(description_.payloads[description_.draws[work.draw].rows].raw_length * 2)) return {};
    return chunkOf<WeightsChunk>(reader_.readRows(work.draw), work);
  }

  Loaded operator()(const ImageRequest& work) const {
    const bundle::Image& image = description_.images[work.image];
    const std::string subject = named(fmt::format("image {} \"{}\"", work.image, image.name));
    const auto file = reader_.readView(image.view);
    if (!file) return failAgain(file.error());
    const auto size = imageSize(*file, subject);
    if (!size) return failAgain(size.error());
    if (!reserve_(size->rgbaBytes())) return {};
    return made(decodeRgba(*file, subject), [&](std::vector<std::uint8_t> rgba) {
      if (work.level == 0) return ImageChunk{work, size->width, size->height, std::move(rgba)};
      const ImageUse use = imageUses(description_)[work.image];
      const ImageSize small = sizeAt(*size, work.level);
      ImageChunk ready{work, small.width, small.height, shrink(rgba, *size, work.level, use.color)};
      if (use.color && use.linear) ready.linear = shrink(rgba, *size, work.level, /*color=*/false);
      return ready;
    });
  }

  Loaded operator()(const CodebookRequest& work) const {
    const bundle::CellTransfer& transfer = transferOf(description_, work);
    const std::uint32_t samples = cellOf(description_, work).sample_count;
    // The codebook as on the GPU and the cluster of each sample are needed.
    if (!reserve_(codebookBytesOnGpu(transfer, samples) + 4 * std::size_t{samples})) return {};
    return made(reader_.readCodebook(work.group, work.cell, work.transfer), [&](bundle::CellCodebook found) {
      std::vector<std::uint32_t> positions = transfer::positionsOf(found.cluster_of, transfer.clusters);
      for (std::uint32_t& position : positions) position |= found.cluster_of[position] << 16;
      return CodebookChunk{work, std::move(found.codebook), std::move(positions)};
    });
  }

  Loaded operator()(const PlaneRequest& work) const {
    const bundle::WeightPlane& plane = transferOf(description_, work).planes[work.plane.value];
    if (!reserve_(5 * std::size_t{plane.count})) return {};
    auto codes = reader_.readPlane(work.group, work.cell, work.transfer, work.plane);
    return made(std::move(codes), [&](const std::vector<std::uint32_t>& numbers) {
      PlaneChunk ready{work, {}};
      ready.codes.reserve(numbers.size() * plane.bits / 8);
      for (const std::uint32_t code : numbers) {
        ready.codes.push_back(static_cast<std::byte>(code & 0xff));
        if (plane.bits == 16) ready.codes.push_back(static_cast<std::byte>(code >> 8));
      }
      return ready;
    });
  }

  Loaded operator()(const LightWeightsRequest& work) const {
    if (!reserve_(2 * sizeof(transfer::LightWeights) * cellOf(description_, work).sample_count)) return {};
    return chunkOf<LightWeightsChunk>(reader_.readLightWeights(work.group, work.cell), work);
  }

  Loaded operator()(const ProxyRequest& work) const {
    const auto payload = static_cast<std::size_t>(description_.groups[work.group.value].proxy);
    if (!reserve_(3 * description_.payloads[payload].raw_length)) return {};
    return chunkOf<ProxyChunk>(reader_.readProxy(work.group), work);
  }

  Loaded operator()(const DensityRequest& work) const {
    const bundle::VolumeGrid& grid = *description_.groups[work.group.value].volume;
    if (!reserve_(2 * description_.payloads[grid.density].raw_length)) return {};
    return made(reader_.readPayload(grid.density), [&](std::vector<std::byte> codes) {
      std::vector<float> maxima = blockMaxima(codes, grid.bits, grid.size);
      return DensityChunk{work, std::move(codes), std::move(maxima)};
    });
  }

  Loaded operator()(const VoxelsRequest& work) const {
    const bundle::VolumeGrid& grid = *description_.groups[work.group.value].volume;
    if (!reserve_(3 * description_.payloads[grid.voxels].raw_length)) return {};
    const auto decode = [&](const std::vector<std::byte>& bytes) {
      return bundle::decodeVoxels(bytes, grid.transfer_size,
                                  named(fmt::format("group {}", work.group.value)));
    };
    return chunkOf<VoxelsChunk>(reader_.readPayload(grid.voxels).and_then(decode), work);
  }

  Loaded operator()(const BrdfRequest& work) const {
    // The payload, the table and the texels have similar sizes.
    if (!reserve_(8 * description_.payloads[description_.brdf_tables[work.table].payload].raw_length))
      return {};
    return made(reader_.readBrdfTable(work.table), [&](bundle::BrdfTable table) {
      BrdfTexels texels = packBrdf(table);
      return BrdfChunk{work, std::move(table), std::move(texels)};
    });
  }

 private:
  // Makes an item of what was read.
  template <class T, class Make>
  static Loaded made(Result<T> read, const Make& make) {
    if (!read) return failAgain(std::move(read.error()));
    return Ready(make(std::move(*read)));
  }
  template <class Chunk, class T, class Request>
  static Loaded chunkOf(Result<T> read, const Request& work) {
    return made(std::move(read), [&](T value) { return Chunk{work, std::move(value)}; });
  }
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
              {priority, PlaneRequest{{group, cell, bundle::TransferIndex{t}}, bundle::PlaneIndex{p}}});
        }
      }
    }
  }
  appendByPriority(list, std::move(transfer));
  return list;
}

std::size_t bytesOf(const Ready& ready) {
  return std::visit(
      Overloaded{[](const MeshChunk& item) {
                   const bundle::MeshData& mesh = item.data;
                   return bytesIn(mesh.positions, mesh.normals, mesh.texcoords0, mesh.texcoords1, mesh.colors,
                                  mesh.tangents, mesh.indices);
                 },
                 [](const ImageChunk& item) { return bytesIn(item.rgba, item.linear); },
                 [](const WeightsChunk& item) {
                   return bytesIn(item.rows.offsets, item.rows.samples, item.rows.weights);
                 },
                 [](const CodebookChunk& item) {
                   const transfer::Codebook& codebook = item.codebook;
                   return bytesIn(codebook.axis_counts, codebook.axes, codebook.vectors, item.positions);
                 },
                 [](const PlaneChunk& item) { return bytesIn(item.codes); },
                 [](const LightWeightsChunk& item) { return bytesIn(item.samples); },
                 [](const ProxyChunk& item) {
                   const bundle::CaptureProxy& proxy = item.proxy;
                   return bytesIn(proxy.positions, proxy.triangles, proxy.entries, proxy.levels);
                 },
                 [](const BrdfChunk& item) { return bytesIn(item.data.values, item.texels.values); },
                 [](const DensityChunk& item) { return bytesIn(item.codes, item.block_maxima); },
                 [](const VoxelsChunk& item) { return bytesIn(item.voxels); }},
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
    const Reserve room = [&](std::size_t bytes) { return reserve(at, bytes); };
    return std::visit(Load(*reader_, room), work_[at]);
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
