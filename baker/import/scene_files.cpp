#include "baker/import/scene_files.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <optional>
#include <span>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "runtime/base/atomic_file.hpp"
#include "runtime/bundle/container.hpp"

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
  auto text = readChunk(glb, at, file);
  if (!text) return failAgain(std::move(text.error()));
  if (text->type != bundle::kGlbJsonChunk)
    return fail(file, "GLB does not start with a JSON chunk", kExportAgain);
  Container container;
  container.json.assign(reinterpret_cast<const char*>(text->bytes.data()), text->bytes.size());
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

namespace {

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

bool sameLetters(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, [](char x, char y) { return lower(x) == lower(y); });
}

// Decodes base64 (RFC 4648), also in the alphabet for URLs. Padding may be missing and lines may be broken;
// any other wrong character gives nothing.
std::optional<std::vector<std::byte>> decodeBase64(std::string_view text) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::byte> bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=' || c == '\n' || c == '\r' || c == ' ') continue;
    const std::size_t digit = kDigits.find(c == '-' ? '+' : c == '_' ? '/' : c);
    if (digit == std::string_view::npos) return std::nullopt;
    bits = (bits << 6) | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<std::byte>((bits >> count) & 0xffu));
  }
  return bytes;
}

// Decodes a data: URI (RFC 2397), whose words may be in letters of any case.
std::optional<std::vector<std::byte>> decodeData(const std::string& uri) {
  constexpr std::string_view kBase64 = ";base64";
  const std::size_t comma = uri.find(',');
  if (comma == std::string::npos) return std::nullopt;
  const std::string_view head = std::string_view(uri).substr(0, comma),
                         data = std::string_view(uri).substr(comma + 1);
  const bool base64 =
      head.size() >= kBase64.size() && sameLetters(head.substr(head.size() - kBase64.size()), kBase64);
  if (base64 && data.find('%') == std::string_view::npos) return decodeBase64(data);
  const std::string text = decodePercent(std::string(data));
  if (base64) return decodeBase64(text);
  const auto bytes = std::as_bytes(std::span(text));
  return std::vector<std::byte>(bytes.begin(), bytes.end());
}

// Returns the entry of a folder with this name, or else the first one whose name differs only in the case of
// letters, as folders of other systems do not mind it.
std::filesystem::path entryOf(const std::filesystem::path& folder, const std::filesystem::path& name) {
  std::error_code error;
  std::filesystem::path found = folder / name;
  if (std::filesystem::exists(found, error)) return found;
  std::filesystem::path other;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (sameLetters(entry.path().filename().string(), name.string()) &&
        (other.empty() || entry.path() < other))
      other = entry.path();
  return other.empty() ? found : other;
}

// Returns the file that a name in the folder `home` means. Exporters also write backslashes, letters of
// another case, names that are percent-encoded twice, and names with a percent sign that is not encoded.
std::filesystem::path meantBy(const std::filesystem::path& home, const std::string& uri) {
  const std::filesystem::path plain = home / decodePercent(uri);
  std::error_code error;
  if (std::filesystem::exists(plain, error)) return plain;
  for (std::string name : {decodePercent(uri), uri, decodePercent(decodePercent(uri))}) {
    std::ranges::replace(name, '\\', '/');
    std::filesystem::path place = home;
    for (const std::filesystem::path& part : std::filesystem::path(name)) place = entryOf(place, part);
    if (std::filesystem::exists(place, error)) return place;
  }
  return plain;
}

}  // namespace

std::string decodePercent(const std::string& uri) {
  std::string decoded;
  decoded.reserve(uri.size());
  for (std::size_t i = 0; i < uri.size(); ++i) {
    unsigned char value = 0;
    const char* digits = uri.data() + i + 1;
    if (uri[i] == '%' && i + 2 < uri.size() &&
        std::from_chars(digits, digits + 2, value, 16).ptr == digits + 2) {
      decoded.push_back(static_cast<char>(value));
      i += 2;
    } else {
      decoded.push_back(uri[i]);
    }
  }
  return decoded;
}

Result<std::filesystem::path> resolveUri(const std::filesystem::path& scene, const std::string& uri,
                                         const ImportOptions& options, const std::string& object,
                                         std::vector<std::string>& warnings) {
  const std::string shown = uri.substr(0, 80), subject = fmt::format("{}: {}", scene.string(), object);
  const std::size_t colon = uri.find(':');
  if (colon != std::string::npos && uri.find_first_of("/?#") > colon)
    return fail(subject, fmt::format("has the URI \"{}\", which is not a file beside the scene", shown),
                "save the data into the scene's folder");
  const std::string name = decodePercent(uri);
  if (name.empty() || name.find('\0') != std::string::npos)
    return fail(subject, "has an empty or broken URI", kExportAgain);

  std::error_code error;
  // A scene named without a folder lies in the current one; an empty path has no canonical form.
  const std::filesystem::path folder = scene.parent_path();
  const auto home =
      std::filesystem::weakly_canonical(folder.empty() ? std::filesystem::path(".") : folder, error);
  const std::filesystem::path meant = error ? home : meantBy(home, uri);
  const auto file = error ? home : std::filesystem::weakly_canonical(meant, error);
  const auto relative = error ? std::filesystem::path("..") : file.lexically_relative(home);
  const bool outside = relative.empty() || *relative.begin() == ".." || relative == ".";
  if (outside && (error || !options.allow_outside))
    return fail(subject, fmt::format("\"{}\" lies outside the scene's folder", shown),
                "move it beside the scene, or pass --allow-outside");
  if (meant != home / name)
    warnings.push_back(fmt::format("{}: \"{}\" is read from \"{}\"", object, shown,
                                   meant.lexically_relative(home).string()));
  return file;
}

Result<std::vector<std::byte>> readUri(const std::filesystem::path& scene, const std::string& uri,
                                       const ImportOptions& options, const std::string& object,
                                       std::vector<std::string>& warnings) {
  if (sameLetters(std::string_view(uri).substr(0, 5), "data:")) {
    auto bytes = decodeData(uri);
    if (!bytes)
      return fail(fmt::format("{}: {}", scene.string(), object), "has a data URI that is not base64",
                  kExportAgain);
    return std::move(*bytes);
  }
  const auto found = resolveUri(scene, uri, options, object, warnings);
  if (!found) return failAgain(found.error());
  return readBytes(*found, fmt::format("{}: {} ({})", scene.string(), object, found->filename().string()));
}

}  // namespace lambent::baker
