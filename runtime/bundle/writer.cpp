#include "runtime/bundle/writer.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include <fmt/format.h>

#include "runtime/base/atomic_file.hpp"
#include "runtime/bundle/checksum.hpp"
#include "runtime/bundle/description_json.hpp"
#include "runtime/bundle/glb.hpp"
#include "runtime/bundle/gltf_parts.hpp"

namespace lambent::bundle {

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
