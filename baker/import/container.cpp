#include "baker/import/container.hpp"

#include <cstdint>
#include <cstring>
#include <fstream>
#include <span>
#include <system_error>

#include <fmt/format.h>

#include "baker/import/hints.hpp"
#include "runtime/base/atomic_file.hpp"
#include "runtime/bundle/glb.hpp"

namespace lambent::baker {
namespace {

using bundle::kGlbChunkHeaderBytes, bundle::kGlbHeaderBytes, bundle::kGlbMagic;

std::uint32_t readU32(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= std::to_integer<std::uint32_t>(bytes[at + i]) << (8 * i);
  return value;
}

struct Chunk {
  std::uint32_t type = 0;
  std::span<const std::byte> bytes;
};

// Reads the chunk at `at` and moves `at` past it.
Result<Chunk> readChunk(std::span<const std::byte> glb, std::size_t& at, const std::string& file) {
  if (glb.size() - at < kGlbChunkHeaderBytes)
    return fail(file, fmt::format("GLB chunk at byte {} has no header", at), kExportAgain);
  const std::uint32_t length = readU32(glb, at);
  const std::uint32_t type = readU32(glb, at + 4);
  at += kGlbChunkHeaderBytes;
  if (length > glb.size() - at)
    return fail(file, fmt::format("GLB chunk at byte {} claims {} bytes of {}", at, length, glb.size() - at),
                kExportAgain);
  const Chunk chunk{type, glb.subspan(at, length)};
  at += length;
  return chunk;
}

Result<Container> takeApart(std::span<const std::byte> glb, const std::string& file) {
  if (glb.size() < kGlbHeaderBytes) return fail(file, "GLB is truncated", kExportAgain);
  if (readU32(glb, 4) != 2)
    return fail(file, fmt::format("GLB has version {}, not 2", readU32(glb, 4)),
                "convert the scene to glTF 2.0");
  const std::uint32_t length = readU32(glb, 8);
  if (length > glb.size() || length < kGlbHeaderBytes)
    return fail(file, fmt::format("GLB is truncated: {} bytes of {}", glb.size(), length), kExportAgain);
  glb = glb.first(length);

  std::size_t at = kGlbHeaderBytes;
  auto json = readChunk(glb, at, file);
  if (!json) return failAgain(std::move(json.error()));
  if (json->type != bundle::kGlbJsonChunk)
    return fail(file, "GLB does not start with a JSON chunk", kExportAgain);
  Container container;
  container.json.assign(reinterpret_cast<const char*>(json->bytes.data()), json->bytes.size());
  if (at < glb.size()) {
    auto binary = readChunk(glb, at, file);
    if (!binary) return failAgain(std::move(binary.error()));
    // Chunks of unknown type must be ignored; the binary chunk, if any, is the second.
    if (binary->type == bundle::kGlbBinChunk)
      container.binary.assign(binary->bytes.begin(), binary->bytes.end());
  }
  return container;
}

}  // namespace

Result<std::vector<std::byte>> readBytes(const std::filesystem::path& path, const std::string& subject) {
  if (auto checked = checkRegularFile(path, "a file"); !checked)
    return fail(subject, checked.error().problem, checked.error().hint);
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  std::ifstream in(path, std::ios::binary);
  if (error || !in) return fail(subject, "cannot be opened", "check its permissions");
  std::vector<std::byte> bytes(size);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (static_cast<std::uintmax_t>(in.gcount()) != size)
    return fail(subject, "cannot be read to its end", "try again");
  return bytes;
}

Result<Container> openContainer(const std::filesystem::path& path) {
  const std::string file = path.string();
  auto bytes = readBytes(path, file);
  if (!bytes) return failAgain(std::move(bytes.error()));
  if (bytes->size() >= 4 && readU32(*bytes, 0) == kGlbMagic) return takeApart(*bytes, file);
  if (bytes->empty()) return fail(file, "is empty", kExportAgain);
  Container container;
  container.json.assign(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  return container;
}

}  // namespace lambent::baker
