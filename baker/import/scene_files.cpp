#include "baker/import/scene_files.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
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
Chunk readChunk(std::span<const std::byte> glb, std::size_t& at) {
  if (glb.size() - at < kGlbChunkHeaderBytes) refuse("GLB chunk at byte {} has no header", at);
  const std::uint32_t length = readU32(glb, at);
  const std::uint32_t type = readU32(glb, at + 4);
  at += kGlbChunkHeaderBytes;
  if (length > glb.size() - at)
    refuse("GLB chunk at byte {} claims {} bytes of {}", at, length, glb.size() - at);
  const Chunk chunk{type, glb.subspan(at, length)};
  at += length;
  return chunk;
}

Container takeApart(std::span<const std::byte> glb) {
  if (glb.size() < kGlbHeaderBytes) refuse("GLB is truncated");
  if (readU32(glb, 4) != 2)
    throw Error{
        {}, fmt::format("GLB has version {}, not 2", readU32(glb, 4)), "convert the scene to glTF 2.0"};
  const std::uint32_t length = readU32(glb, 8);
  if (length > glb.size() || length < kGlbHeaderBytes)
    refuse("GLB is truncated: {} bytes of {}", glb.size(), length);
  glb = glb.first(length);

  std::size_t at = kGlbHeaderBytes;
  const Chunk text = readChunk(glb, at);
  if (text.type != bundle::kGlbJsonChunk) refuse("GLB does not start with a JSON chunk");
  Container container{{reinterpret_cast<const char*>(text.bytes.data()), text.bytes.size()}, {}};
  if (at < glb.size()) {
    const Chunk binary = readChunk(glb, at);
    // Chunks of unknown type must be ignored; the binary chunk, if any, is the second.
    if (binary.type == bundle::kGlbBinChunk)
      container.binary.assign(binary.bytes.begin(), binary.bytes.end());
  }
  return container;
}

}  // namespace

std::vector<std::byte> readBytes(const std::filesystem::path& path, const std::string& subject) {
  const auto text = readTextFile(path);
  if (!text) throw Error{subject, text.error().problem, text.error().hint};
  const auto bytes = std::as_bytes(std::span(*text));
  return {bytes.begin(), bytes.end()};
}

Result<Container> openContainer(const std::filesystem::path& path) {
  return resultOf(path.string(), "read", kExportAgain, [&] {
    std::string text = orThrow(readTextFile(path));
    const auto bytes = std::as_bytes(std::span(text));
    if (bytes.size() >= 4 && readU32(bytes, 0) == kGlbMagic) return takeApart(bytes);
    if (text.empty()) refuse("is empty");
    return Container{std::move(text), {}};
  });
}

namespace {

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

bool sameLetters(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, [](char x, char y) { return lower(x) == lower(y); });
}

// Decodes base64 (RFC 4648), also in the alphabet for URLs. Padding may be missing and lines may be broken;
// any other wrong character is an error about `subject`.
std::vector<std::byte> decodeBase64(std::string_view text, const std::string& subject) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::byte> bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=' || c == '\n' || c == '\r' || c == ' ') continue;
    const std::size_t digit = kDigits.find(c == '-' ? '+' : c == '_' ? '/' : c);
    if (digit == std::string_view::npos)
      throw Error{subject, "has a data URI that is not base64", kExportAgain};
    bits = (bits << 6) | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<std::byte>((bits >> count) & 0xffu));
  }
  return bytes;
}

// Decodes a data: URI (RFC 2397), whose words may be in letters of any case.
std::vector<std::byte> decodeData(const std::string& uri, const std::string& subject) {
  constexpr std::string_view kBase64 = ";base64";
  const std::size_t comma = uri.find(',');
  if (comma == std::string::npos) throw Error{subject, "has a data URI that is not base64", kExportAgain};
  const std::string head = uri.substr(0, comma), data = uri.substr(comma + 1);
  const bool base64 =
      head.size() >= kBase64.size() && sameLetters(head.substr(head.size() - kBase64.size()), kBase64);
  const std::string text = decodePercent(data);
  if (base64) return decodeBase64(text, subject);
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
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

std::filesystem::path resolveUri(const std::filesystem::path& scene, const std::string& uri,
                                 const ImportOptions& options, const std::string& object,
                                 std::vector<std::string>& warnings) {
  const std::string shown = uri.substr(0, 80), subject = fmt::format("{}: {}", scene.string(), object);
  const std::size_t colon = uri.find(':');
  if (colon != std::string::npos && uri.find_first_of("/?#") > colon)
    throw Error{subject, fmt::format("has the URI \"{}\", which is not a file beside the scene", shown),
                "save the data into the scene's folder"};
  const std::string name = decodePercent(uri);
  if (name.empty() || name.find('\0') != std::string::npos)
    throw Error{subject, "has an empty or broken URI", kExportAgain};

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
    throw Error{subject, fmt::format("\"{}\" lies outside the scene's folder", shown),
                "move it beside the scene, or pass --allow-outside"};
  if (meant != home / name)
    warnings.push_back(fmt::format("{}: \"{}\" is read from \"{}\"", object, shown,
                                   meant.lexically_relative(home).string()));
  return file;
}

std::vector<std::byte> readUri(const std::filesystem::path& scene, const std::string& uri,
                               const ImportOptions& options, const std::string& object,
                               std::vector<std::string>& warnings) {
  const std::string subject = fmt::format("{}: {}", scene.string(), object);
  if (sameLetters(std::string_view(uri).substr(0, 5), "data:")) return decodeData(uri, subject);
  const auto found = resolveUri(scene, uri, options, object, warnings);
  return readBytes(found, fmt::format("{} ({})", subject, found.filename().string()));
}

}  // namespace lambent::baker
