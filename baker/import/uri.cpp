#include "baker/import/uri.hpp"

#include <charconv>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "baker/import/container.hpp"
#include "baker/import/hints.hpp"

namespace lambent::baker {
namespace {

// Decodes base64 (RFC 4648). Padding may be missing; any other wrong character gives nothing.
std::optional<std::vector<std::byte>> decodeBase64(std::string_view text) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  std::vector<std::byte> bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const std::size_t digit = kDigits.find(c);
    if (digit == std::string_view::npos) return std::nullopt;
    bits = (bits << 6) | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<std::byte>((bits >> count) & 0xffu));
  }
  return bytes;
}

// Decodes a data: URI (RFC 2397).
std::optional<std::vector<std::byte>> decodeData(const std::string& uri) {
  constexpr std::string_view kBase64 = ";base64";
  const std::size_t comma = uri.find(',');
  if (comma == std::string::npos) return std::nullopt;
  if (std::string_view(uri).substr(0, comma).ends_with(kBase64))
    return decodeBase64(std::string_view(uri).substr(comma + 1));
  const std::string text = decodePercent(uri.substr(comma + 1));
  const auto bytes = std::as_bytes(std::span(text));
  return std::vector<std::byte>(bytes.begin(), bytes.end());
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

Result<std::filesystem::path> resolveUri(const std::filesystem::path& folder, const std::string& uri,
                                         const ImportOptions& options, const std::string& subject,
                                         const std::string& object) {
  const std::string shown = uri.substr(0, 80);
  const std::size_t colon = uri.find(':');
  if (colon != std::string::npos && uri.find_first_of("/?#") > colon)
    return fail(subject,
                fmt::format("{} has the URI \"{}\", which is not a file beside the scene", object, shown),
                "save the data into the scene's folder");
  const std::string name = decodePercent(uri);
  if (name.empty() || name.find('\0') != std::string::npos)
    return fail(subject, fmt::format("{} has an empty or broken URI", object), kExportAgain);

  std::error_code error;
  // A scene named without a folder lies in the current one; an empty path has no canonical form.
  const auto home =
      std::filesystem::weakly_canonical(folder.empty() ? std::filesystem::path(".") : folder, error);
  const auto file = error ? home : std::filesystem::weakly_canonical(home / name, error);
  if (!error && options.allow_outside) return file;
  const auto relative = error ? std::filesystem::path("..") : file.lexically_relative(home);
  if (relative.empty() || *relative.begin() == ".." || relative == ".")
    return fail(subject, fmt::format("{} (\"{}\") lies outside the scene's folder", object, shown),
                "move it beside the scene, or pass --allow-outside");
  return file;
}

Result<std::vector<std::byte>> readUri(const std::filesystem::path& file, const std::string& uri,
                                       const ImportOptions& options, const std::string& object) {
  if (uri.starts_with("data:")) {
    auto bytes = decodeData(uri);
    if (!bytes)
      return fail(file.string(), fmt::format("{} has a data URI that is not base64", object), kExportAgain);
    return std::move(*bytes);
  }
  const auto found = resolveUri(file.parent_path(), uri, options, file.string(), object);
  if (!found) return failAgain(found.error());
  return readBytes(*found, fmt::format("{}: {} ({})", file.string(), object, found->filename().string()));
}

}  // namespace lambent::baker
