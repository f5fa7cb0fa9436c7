#include "runtime/bundle/glb.hpp"

#include <array>
#include <bit>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "runtime/base/atomic_file.hpp"
#include "runtime/base/payload_bytes.hpp"

namespace lambent::bundle {

static_assert(std::endian::native == std::endian::little,
              "GLB is little endian; a big-endian port must swap here");

namespace {

template <std::size_t N>
std::array<std::uint32_t, N> words(std::span<const std::byte> bytes) {
  std::array<std::uint32_t, N> out;
  std::memcpy(out.data(), bytes.data(), sizeof(out));
  return out;
}

}  // namespace

GlbFile::GlbFile(GlbFile&& other) noexcept
    : path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      file_bytes_(other.file_bytes_),
      bin_offset_(other.bin_offset_),
      bin_length_(other.bin_length_),
      json_(std::move(other.json_)) {}

GlbFile::~GlbFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<void> GlbFile::readAt(std::uint64_t offset, std::span<std::byte> out) const {
  while (!out.empty()) {
    const ssize_t got = ::pread(descriptor_, out.data(), out.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0)
      return fail(path_.string(), fmt::format("cannot be read: {}", std::strerror(errno)), "check the disk");
    if (got == 0) return fail(path_.string(), "is truncated", kCopyAgain);
    out = out.subspan(static_cast<std::size_t>(got));
    offset += static_cast<std::uint64_t>(got);
  }
  return {};
}

Result<void> GlbFile::readBinary(std::uint64_t offset, std::span<std::byte> out) const {
  return readAt(bin_offset_ + offset, out);
}

Result<void> GlbFile::readHeaders() {
  const std::string name = path_.string();
  std::array<std::byte, kGlbHeaderBytes + kGlbChunkHeaderBytes> head;
  if (file_bytes_ < head.size())
    return fail(name, fmt::format("is not a bundle: only {} bytes long", file_bytes_), kCopyAgain);
  if (auto read = readAt(0, head); !read) return read;
  const auto [magic, version, length, json_length, json_type] = words<5>(head);
  if (magic != kGlbMagic)
    return fail(name, "is not a bundle: it does not begin as a GLB file", "bake a scene with `lambent bake`");
  if (version != 2)
    return fail(name, fmt::format("is a GLB of version {}, not 2", version), "bake the scene again");
  if (length > file_bytes_)
    return fail(name, fmt::format("is truncated: {} of {} bytes are there", file_bytes_, length), kCopyAgain);
  if (length < file_bytes_)
    return fail(name, fmt::format("has {} bytes after its end", file_bytes_ - length), kCopyAgain);
  const std::uint64_t json_end = head.size() + std::uint64_t{json_length};
  if (json_type != kGlbJsonChunk || json_length % 4 != 0 || json_end + kGlbChunkHeaderBytes > length)
    return fail(name, "is damaged: its JSON chunk does not fit the file", kCopyAgain);
  json_.resize(json_length);
  if (auto read = readAt(head.size(), std::as_writable_bytes(std::span(json_))); !read) return read;

  std::array<std::byte, kGlbChunkHeaderBytes> bin;
  if (auto read = readAt(json_end, bin); !read) return read;
  const auto [bin_length, bin_type] = words<2>(bin);
  if (bin_type != kGlbBinChunk || json_end + kGlbChunkHeaderBytes + bin_length != length)
    return fail(name, "is damaged: its binary chunk does not fill the file", kCopyAgain);
  bin_offset_ = json_end + kGlbChunkHeaderBytes;
  bin_length_ = bin_length;
  return {};
}

Result<GlbFile> GlbFile::open(const std::filesystem::path& path) {
  if (auto checked = checkRegularFile(path, "a bundle (.lmb.glb)"); !checked)
    return failAgain(checked.error());
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  GlbFile file(path, descriptor);
  if (descriptor < 0 || ::fstat(descriptor, &status) != 0)
    return fail(path.string(), fmt::format("cannot be read: {}", std::strerror(errno)),
                "check its permissions");
  file.file_bytes_ = static_cast<std::uint64_t>(status.st_size);
  if (auto read = file.readHeaders(); !read) return failAgain(read.error());
  return file;
}

}  // namespace lambent::bundle
