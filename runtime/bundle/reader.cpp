#include "runtime/bundle/reader.hpp"

#include <array>
#include <cstring>

#include <fmt/format.h>

#include "runtime/bundle/checksum.hpp"
#include "runtime/bundle/description_json.hpp"
#include "runtime/bundle/glb.hpp"
#include "runtime/bundle/gltf_parts.hpp"
#include "runtime/bundle/transfer_codec.hpp"

namespace lambent::bundle {

struct Reader::File {
  GlbFile glb;
  Description description;
};

Reader::Reader(std::unique_ptr<File> file) : file_(std::move(file)) {}
Reader::Reader(Reader&&) noexcept = default;
Reader& Reader::operator=(Reader&&) noexcept = default;
Reader::~Reader() = default;

namespace {

// The integrity view: the checksum of the JSON chunk and its complement (description_json.hpp).
Result<void> checkJson(const GlbFile& glb) {
  std::array<std::uint64_t, 2> stored{};
  if (glb.binaryBytes() < kIntegrityBytes)
    return fail(glb.path().string(), "is not a bundle", "bake it with `lambent bake`");
  if (auto read = glb.readBinary(0, std::as_writable_bytes(std::span(stored))); !read) return read;
  const std::uint64_t found = checksum(std::as_bytes(std::span(glb.json())));
  if (stored[0] != found || stored[1] != ~found)
    return fail(glb.path().string(), "is damaged: its description does not match its checksum",
                "copy it again or bake it again");
  return {};
}

}  // namespace

Result<Reader> Reader::open(const std::filesystem::path& path) {
  auto glb = GlbFile::open(path);
  if (!glb) return failAgain(glb.error());
  // Version and kind come first, so that a plain glTF file or a newer bundle is called what it is, not
  // damaged.
  auto description = fromJson(glb->json(), glb->binaryBytes(), path.string());
  const auto intact = checkJson(*glb);
  if (!description) return failAgain(description.error());
  if (!intact) return failAgain(intact.error());
  Reader reader(std::make_unique<File>(File{std::move(*glb), std::move(*description)}));
  Description& d = reader.file_->description;
  for (std::size_t i = 0; i < d.animations.size(); ++i) {
    const auto bytes = reader.readView(static_cast<std::uint32_t>(d.views.size() - d.animations.size() + i));
    if (!bytes) return failAgain(bytes.error());
    if (!loadAnimation(d.animations[i], *bytes))
      return fail(path.string(), fmt::format("is damaged: the keyframes of animation {} make no motion", i),
                  "bake it again");
  }
  return reader;
}

const std::filesystem::path& Reader::path() const {
  return file_->glb.path();
}
const Description& Reader::description() const {
  return file_->description;
}
std::uint64_t Reader::fileBytes() const {
  return file_->glb.fileBytes();
}

Result<std::vector<std::byte>> Reader::readView(std::uint32_t index) const {
  const View& view = file_->description.views.at(index);
  std::vector<std::byte> bytes((view.length + 7) / 8 * 8);  // with the padding, which the checksum covers
  if (auto read = file_->glb.readBinary(view.offset, bytes); !read) return failAgain(read.error());
  if (checksum(bytes) != view.checksum)
    return fail(path().string(), fmt::format("is damaged: byte range {} does not match its checksum", index),
                "copy it again or bake it again");
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

Result<void> Reader::checkAll() const {
  const Description& d = description();
  for (std::uint32_t view = 0; view < d.views.size(); ++view)
    if (auto bytes = readView(view); !bytes) return failAgain(bytes.error());
  for (std::uint32_t mesh = 0; mesh < d.meshes.size(); ++mesh)
    for (std::uint32_t p = 0; p < d.meshes[mesh].primitives.size(); ++p)
      if (auto data = readMesh(mesh, p); !data) return failAgain(data.error());
  for (const Draw& draw : d.draws) {
    const auto bytes = readPayload(draw.rows);
    if (!bytes) return failAgain(bytes.error());
    const auto rows = decodeRows(*bytes, d.meshes[draw.mesh].primitives[draw.primitive].vertex_count,
                                 d.groups[draw.group].sample_count, path().string());
    if (!rows) return failAgain(rows.error());
  }
  for (std::uint32_t payload = 0; payload < d.payloads.size(); ++payload)
    if (auto bytes = readPayload(payload); !bytes) return failAgain(bytes.error());
  return {};
}

}  // namespace lambent::bundle
