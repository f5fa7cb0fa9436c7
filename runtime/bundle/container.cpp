#include "runtime/bundle/container.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cerrno>
#include <cmath>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>
#include <zstd.h>

#include "runtime/base/atomic_file.hpp"
#include "runtime/base/payload_bytes.hpp"
#include "runtime/bundle/description_json.hpp"
#include "runtime/transfer/codebook.hpp"

namespace lambent::bundle {

static_assert(std::endian::native == std::endian::little,
              "GLB is little endian; a big-endian port must swap here");

std::uint64_t checksum(std::span<const std::byte> bytes) {
  return XXH3_64bits(bytes.data(), bytes.size());
}

std::vector<std::byte> compressZstd(std::span<const std::byte> bytes, int level) {
  std::vector<std::byte> out(ZSTD_compressBound(bytes.size()));
  const std::size_t size = ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), level);
  assert(!ZSTD_isError(size) && "the destination is as large as ZSTD_compressBound asks");
  out.resize(size);
  return out;
}

Result<std::vector<std::byte>> decompressZstd(std::span<const std::byte> bytes, std::size_t raw_length,
                                              const std::string& subject) {
  // The frame says how much it holds: a false raw_length cannot make us allocate what is not there.
  if (ZSTD_getFrameContentSize(bytes.data(), bytes.size()) != raw_length)
    return fail(subject, "has a damaged payload: it does not hold as many bytes as it says", kCopyAgain);
  std::vector<std::byte> out(raw_length);
  const std::size_t size = ZSTD_decompress(out.data(), out.size(), bytes.data(), bytes.size());
  if (ZSTD_isError(size) || size != raw_length)
    return fail(subject, "has a damaged payload: it cannot be decompressed", kCopyAgain);
  return out;
}

Reader::File::~File() {
  if (descriptor >= 0) ::close(descriptor);
}

Result<void> Reader::File::readAt(std::uint64_t offset, std::span<std::byte> out) const {
  while (!out.empty()) {
    const ssize_t got = ::pread(descriptor, out.data(), out.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0)
      return fail(path.string(), fmt::format("cannot be read: {}", std::strerror(errno)), "check the disk");
    if (got == 0) return fail(path.string(), "is truncated", kCopyAgain);
    out = out.subspan(static_cast<std::size_t>(got));
    offset += static_cast<std::uint64_t>(got);
  }
  return {};
}

Result<std::string> Reader::File::open() {
  if (auto checked = checkRegularFile(path, "a bundle (.lmb.glb)"); !checked)
    return failAgain(checked.error());
  const std::string name = path.string();
  descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  if (descriptor < 0 || ::fstat(descriptor, &status) != 0)
    return fail(name, fmt::format("cannot be read: {}", std::strerror(errno)), "check its permissions");
  file_bytes = static_cast<std::uint64_t>(status.st_size);

  std::array<std::uint32_t, (kGlbHeaderBytes + kGlbChunkHeaderBytes) / 4> head{};
  if (file_bytes < sizeof(head))
    return fail(name, fmt::format("is not a bundle: only {} bytes long", file_bytes), kCopyAgain);
  if (auto read = readAt(0, std::as_writable_bytes(std::span(head))); !read) return failAgain(read.error());
  const auto [magic, version, length, json_length, json_type] = head;
  if (magic != kGlbMagic)
    return fail(name, "is not a bundle: it does not begin as a GLB file", "bake a scene with `lambent bake`");
  if (version != 2)
    return fail(name, fmt::format("is a GLB of version {}, not 2", version), "bake the scene again");
  if (length > file_bytes)
    return fail(name, fmt::format("is truncated: {} of {} bytes are there", file_bytes, length), kCopyAgain);
  if (length < file_bytes)
    return fail(name, fmt::format("has {} bytes after its end", file_bytes - length), kCopyAgain);
  const std::uint64_t json_end = sizeof(head) + std::uint64_t{json_length};
  if (json_type != kGlbJsonChunk || json_length % 4 != 0 || json_end + kGlbChunkHeaderBytes > length)
    return fail(name, "is damaged: its JSON chunk does not fit the file", kCopyAgain);
  std::string json(json_length, '\0');
  if (auto read = readAt(sizeof(head), std::as_writable_bytes(std::span(json))); !read)
    return failAgain(read.error());

  std::array<std::uint32_t, kGlbChunkHeaderBytes / 4> bin{};
  if (auto read = readAt(json_end, std::as_writable_bytes(std::span(bin))); !read)
    return failAgain(read.error());
  bin_offset = json_end + kGlbChunkHeaderBytes;
  bin_length = bin[0];
  if (bin[1] != kGlbBinChunk || bin_offset + bin_length != length)
    return fail(name, "is damaged: its binary chunk does not fill the file", kCopyAgain);
  return json;
}

Result<void> Reader::File::checkJson(const std::string& json) const {
  std::array<std::uint64_t, 2> stored{};
  if (bin_length < kIntegrityBytes)
    return fail(path.string(), "is not a bundle", "bake it with `lambent bake`");
  if (auto read = readAt(bin_offset, std::as_writable_bytes(std::span(stored))); !read) return read;
  const std::uint64_t found = checksum(std::as_bytes(std::span(json)));
  if (stored[0] != found || stored[1] != ~found)
    return fail(path.string(), "is damaged: its description does not match its checksum", kCopyAgain);
  return {};
}

Result<Reader> Reader::open(const std::filesystem::path& path) {
  Reader reader(path);
  File& file = *reader.file_;
  const auto json = file.open();
  if (!json) return failAgain(json.error());
  // Version and kind are checked first, so that a plain glTF file or a newer bundle is not reported as
  // damaged.
  auto description = fromJson(*json, file.bin_length, path.string());
  if (!description) return failAgain(description.error());
  if (const auto intact = file.checkJson(*json); !intact) return failAgain(intact.error());
  file.description = std::move(*description);
  Description& d = file.description;
  for (std::size_t i = 0; i < d.animations.size(); ++i) {
    const auto bytes = reader.readView(static_cast<std::uint32_t>(d.views.size() - d.animations.size() + i));
    if (!bytes) return failAgain(bytes.error());
    if (!loadAnimation(d.animations[i], *bytes))
      return fail(path.string(), fmt::format("is damaged: the keyframes of animation {} make no motion", i),
                  "bake it again");
  }
  return reader;
}

Result<std::vector<std::byte>> Reader::readView(std::uint32_t index) const {
  const View& view = file_->description.views.at(index);
  std::vector<std::byte> bytes((view.length + 7) / 8 * 8);  // includes the padding, which the checksum covers
  if (auto read = file_->readAt(file_->bin_offset + view.offset, bytes); !read)
    return failAgain(read.error());
  if (checksum(bytes) != view.checksum)
    return fail(path().string(), fmt::format("is damaged: byte range {} does not match its checksum", index),
                kCopyAgain);
  bytes.resize(view.length);
  return bytes;
}

Result<std::vector<std::byte>> Reader::readPayload(std::uint32_t index) const {
  const Payload& payload = file_->description.payloads.at(index);
  auto bytes = readView(payload.view);
  if (!bytes || payload.codec == PayloadCodec::Raw) return bytes;
  return decompressZstd(*bytes, payload.raw_length, path().string());
}

Result<MeshData> Reader::readMesh(std::uint32_t mesh, std::uint32_t primitive_index) const {
  const Primitive& primitive = file_->description.meshes.at(mesh).primitives.at(primitive_index);
  const auto bytes = readView(primitive.view);
  if (!bytes) return failAgain(bytes.error());
  auto data = decodeDraco(*bytes, primitive, path().string());
  if (data && meshDigest(*data) != primitive.digest)
    return fail(path().string(), fmt::format("mesh {} is not the one that its transfer was baked for", mesh),
                "bake it again");
  return data;
}

Result<transfer::VertexWeights> Reader::readRows(std::uint32_t index) const {
  const Draw& draw = description().draws.at(index);
  const Group& group = description().groups[draw.group];
  const std::string subject = fmt::format("{}: draw {}", path().string(), index);
  const auto bytes = readPayload(draw.rows);
  if (!bytes) return failAgain(bytes.error());
  auto rows = transfer::decodeRows(*bytes, rowCount(description(), draw), group.sample_count, subject);
  if (!rows) return rows;
  const std::size_t vertices = description().meshes[draw.mesh].primitives[draw.primitive].vertex_count;
  for (std::size_t row = vertices; row + 1 < rows->offsets.size(); ++row)
    if (rows->offsets[row + 1] != rows->offsets[row] + 1)
      return fail(subject, "has texels of none or several samples", "bake it again");
  // Samples are ordered by rising outputs.
  std::uint32_t first = 0;
  for (const Cell& cell : group.cells)
    if (cell.domain == transfer::Domain::Vertex && cell.form() < draw.form())
      first = cell.first_sample + cell.sample_count;
  const std::uint32_t end = first + group.samplesOf(draw.form());
  const auto other = [&](std::uint32_t sample) { return sample < first || sample >= end; };
  if (std::any_of(rows->samples.begin(), rows->samples.end(), other))
    return fail(subject, fmt::format("takes samples that do not have {} outputs", draw.outputs),
                "bake it again");
  return rows;
}

namespace {

const Cell& cellAt(const Description& d, GroupIndex group, CellIndex cell) {
  return d.groups.at(group.value).cells.at(cell.value);
}

}  // namespace

Result<CellCodebook> Reader::readCodebook(GroupIndex group, CellIndex cell_index,
                                          TransferIndex transfer_index) const {
  const Cell& cell = cellAt(description(), group, cell_index);
  const CellTransfer& transfer = cell.transfers.at(transfer_index.value);
  const std::string subject =
      fmt::format("{}: group {} cell {}", path().string(), group.value, cell_index.value);
  auto codebook = readPayload(transfer.codebook).and_then([&](const Blob& bytes) {
    return transfer::decodeCodebook(bytes, transfer.shape, transfer.clusters, subject);
  });
  if (!codebook) return failAgain(codebook.error());
  if (codebook->axes.size() != transfer.axes)  // callers reserve memory by the description
    return fail(subject, "has a codebook of another size than its description says", "bake it again");
  CellCodebook found{std::move(*codebook), std::vector<std::uint32_t>(cell.sample_count, 0)};
  if (transfer.cluster_ids >= 0) {
    auto ids = readPayload(static_cast<std::uint32_t>(transfer.cluster_ids)).and_then([&](const Blob& bytes) {
      return transfer::decodeClusterIds(bytes, transfer.clusters, cell.sample_count, subject);
    });
    if (!ids) return failAgain(ids.error());
    found.cluster_of = std::move(*ids);
  }
  const std::vector<std::uint32_t> counts = transfer::planeCounts(found.codebook, found.cluster_of);
  const auto same = [](std::uint32_t count, const WeightPlane& plane) { return count == plane.count; };
  if (!std::equal(counts.begin(), counts.end(), transfer.planes.begin(), transfer.planes.end(), same))
    return fail(subject, "has weight planes of other sizes than its clusters ask for", "bake it again");
  return found;
}

Result<std::vector<std::uint32_t>> Reader::readPlane(GroupIndex group, CellIndex cell, TransferIndex transfer,
                                                     PlaneIndex index) const {
  const WeightPlane& plane =
      cellAt(description(), group, cell).transfers.at(transfer.value).planes.at(index.value);
  const auto subject =
      fmt::format("{}: group {} cell {} plane {}", path().string(), group.value, cell.value, index.value);
  return readPayload(plane.payload).and_then([&](const Blob& bytes) {
    return transfer::decodeWeightPlane(bytes, plane.bits, plane.count, subject);
  });
}

Result<std::vector<transfer::LightWeights>> Reader::readLightWeights(GroupIndex group,
                                                                     CellIndex cell_index) const {
  const Cell& cell = cellAt(description(), group, cell_index);
  if (cell.light_weights < 0)
    return std::vector<transfer::LightWeights>(cell.sample_count, transfer::kOneLight);
  const auto subject = fmt::format("{}: group {} cell {}", path().string(), group.value, cell_index.value);
  return readPayload(static_cast<std::uint32_t>(cell.light_weights)).and_then([&](const Blob& bytes) {
    return transfer::decodeLightWeights(bytes, cell.sample_count, cell.light_probes.size(), subject);
  });
}

Result<std::vector<std::uint8_t>> Reader::readImportance(GroupIndex group, CellIndex cell_index) const {
  const Cell& cell = cellAt(description(), group, cell_index);
  std::vector<std::uint8_t> codes;
  if (cell.importance < 0) return codes;
  const auto bytes = readPayload(static_cast<std::uint32_t>(cell.importance));
  if (!bytes) return failAgain(bytes.error());
  for (const std::byte one : *bytes) codes.push_back(std::to_integer<std::uint8_t>(one));
  return codes;
}

Result<CaptureProxy> Reader::readProxy(GroupIndex index) const {
  const Group& group = description().groups.at(index.value);
  if (group.proxy < 0) return CaptureProxy{};
  const auto subject = fmt::format("{}: group {}", path().string(), index.value);
  return readPayload(static_cast<std::uint32_t>(group.proxy)).and_then([&](const Blob& bytes) {
    return decodeCaptureProxy(bytes, group.sample_count, static_cast<std::uint32_t>(group.lights.size()),
                              subject);
  });
}

Result<BrdfTable> Reader::readBrdfTable(std::uint32_t index) const {
  const std::string subject = fmt::format("{}: BRDF table {}", path().string(), index);
  auto table = readPayload(description().brdf_tables.at(index).payload).and_then([&](const Blob& bytes) {
    return decodeBrdfTable(bytes, subject);
  });
  if (const std::uint32_t outputs = description().glossyOutputs();
      table && outputs != 0 && table->order * table->order != outputs)
    return fail(subject, "has other bands than the transfer that it is looked up for", "bake it again");
  return table;
}

Result<void> Reader::checkAll() const {
  const Description& d = description();
  for (std::uint32_t view = 0; view < d.views.size(); ++view)
    if (auto bytes = readView(view); !bytes) return failAgain(bytes.error());
  for (std::uint32_t mesh = 0; mesh < d.meshes.size(); ++mesh)
    for (std::uint32_t p = 0; p < d.meshes[mesh].primitives.size(); ++p)
      if (auto data = readMesh(mesh, p); !data) return failAgain(data.error());
  for (std::uint32_t draw = 0; draw < d.draws.size(); ++draw)
    if (auto rows = readRows(draw); !rows) return failAgain(rows.error());
  for (std::uint32_t table = 0; table < d.brdf_tables.size(); ++table)
    if (auto found = readBrdfTable(table); !found) return failAgain(found.error());
  for (std::uint32_t g = 0; g < d.groups.size(); ++g)
    if (auto proxy = readProxy(GroupIndex{g}); !proxy) return failAgain(proxy.error());
  for (std::uint32_t g = 0; g < d.groups.size(); ++g)
    for (std::uint32_t c = 0; c < d.groups[g].cells.size(); ++c) {
      const GroupIndex group{g};
      const CellIndex cell{c};
      if (auto weights = readLightWeights(group, cell); !weights) return failAgain(weights.error());
      const std::vector<CellTransfer>& transfers = d.groups[g].cells[c].transfers;
      for (std::uint32_t t = 0; t < transfers.size(); ++t) {
        if (auto found = readCodebook(group, cell, TransferIndex{t}); !found) return failAgain(found.error());
        for (std::uint32_t j = 0; j < transfers[t].planes.size(); ++j)
          if (auto codes = readPlane(group, cell, TransferIndex{t}, PlaneIndex{j}); !codes)
            return failAgain(codes.error());
      }
    }
  return {};
}

namespace {

constexpr std::uint64_t padded8(std::uint64_t bytes) {
  return (bytes + 7) / 8 * 8;
}

// Places the views after the integrity view in the order of the parts, each at a multiple of 8. Returns the
// end.
std::uint64_t placeViews(const std::vector<std::span<const std::byte>>& parts, std::vector<View>& views) {
  std::uint64_t offset = kIntegrityBytes;
  views.clear();
  for (const std::span<const std::byte> part : parts) {
    Blob with_padding(part.begin(), part.end());
    with_padding.resize(padded8(part.size()));
    views.push_back({offset, part.size(), checksum(with_padding)});
    offset += with_padding.size();
  }
  return offset;
}

template <typename T>
std::span<const std::byte> bytesOf(const T& words) {
  return std::as_bytes(std::span(words));
}

bool isANumber(const CellTransfer& transfer) {
  return std::isfinite(transfer.error) &&
         std::all_of(transfer.planes.begin(), transfer.planes.end(),
                     [](const WeightPlane& plane) { return std::isfinite(plane.variance); });
}

}  // namespace

Result<void> write(const std::filesystem::path& path, Description description, const std::vector<Blob>& blobs,
                   const PartCheck& check) {
  assert(std::none_of(blobs.begin(), blobs.end(), [](const Blob& blob) { return blob.empty(); }) &&
         "glTF has no empty bufferViews");
  for (const Group& group : description.groups)
    for (const Cell& cell : group.cells)
      if (!std::all_of(cell.transfers.begin(), cell.transfers.end(), isANumber))
        return fail(path.string(), fmt::format("the transfer of group \"{}\" is not a number", group.name),
                    "this is a fault of the program: please report it with the scene");
  std::vector<Blob> animations;  // their views come last
  for (const gltf::Animation& animation : description.animations)
    animations.push_back(animationBytes(animation));
  std::vector<std::span<const std::byte>> parts(blobs.begin(), blobs.end());
  parts.insert(parts.end(), animations.begin(), animations.end());
  const std::uint64_t binary_bytes = placeViews(parts, description.views);
  std::string json = toJson(description, binary_bytes);
  json.resize((json.size() + 7) / 8 * 8 + 4, ' ');  // aligns the binary data to a multiple of 8

  const std::uint64_t file_bytes = kGlbHeaderBytes + 2 * kGlbChunkHeaderBytes + json.size() + binary_bytes;
  if (file_bytes > 0xffffffffu)
    return fail(path.string(), fmt::format("would be {} bytes; a GLB holds at most 4 GiB", file_bytes),
                "bake the scene in parts");

  auto file = AtomicFile::open(path);
  if (!file) return failAgain(file.error());
  const auto word = [](std::uint64_t value) { return static_cast<std::uint32_t>(value); };
  const std::array head = {kGlbMagic, 2u, word(file_bytes), word(json.size()), kGlbJsonChunk};
  const std::array bin_head = {word(binary_bytes), kGlbBinChunk};
  const std::uint64_t json_checksum = checksum(bytesOf(json));
  const std::array integrity = {json_checksum, ~json_checksum};
  for (const auto words : {bytesOf(head), bytesOf(json), bytesOf(bin_head), bytesOf(integrity)})
    if (auto written = file->write(words); !written) return written;

  constexpr std::array<std::byte, 8> kZeros{};
  for (const std::span<const std::byte> part : parts) {
    if (auto written = file->write(part); !written) return written;
    const auto padding = std::span(kZeros).first(padded8(part.size()) - part.size());
    if (auto written = file->write(padding); !written) return written;
  }
  if (check)
    if (auto good = check(file->part()); !good)
      return fail(path.string(), "cannot be opened after it was written: it " + good.error().problem,
                  "this is a fault of the program: please report it with the scene");
  return file->commit();
}

}  // namespace lambent::bundle
