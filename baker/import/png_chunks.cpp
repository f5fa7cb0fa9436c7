#include "baker/import/png_chunks.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

namespace lambent::baker {

namespace {

constexpr std::size_t kSignature = 8, kHead = 8, kChecksum = 4;  // bytes; the head is length and type
constexpr std::array<std::string_view, 5> kNeeded = {"IHDR", "PLTE", "tRNS", "IDAT", "IEND"};

constexpr std::array<std::uint32_t, 256> crcTable() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < table.size(); ++i) {
    table[i] = i;
    for (int bit = 0; bit < 8; ++bit) table[i] = (table[i] >> 1) ^ ((table[i] & 1u) ? 0xedb88320u : 0u);
  }
  return table;
}

// Source: PNG specification, annex D.
std::uint32_t crc(std::span<const std::byte> bytes) {
  static constexpr auto kTable = crcTable();
  std::uint32_t value = ~0u;
  for (const std::byte b : bytes)
    value = kTable[(value ^ std::to_integer<std::uint32_t>(b)) & 255u] ^ (value >> 8);
  return ~value;
}

std::uint32_t u32(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = (value << 8) | std::to_integer<std::uint32_t>(bytes[at + i]);
  return value;
}

}  // namespace

Result<std::vector<std::byte>> essentialPng(std::span<const std::byte> png, const std::string& subject) {
  const auto truncated = [&] { return fail(subject, "is truncated", "save it again"); };
  if (png.size() < kSignature) return truncated();
  std::vector<std::byte> out(png.begin(), png.begin() + kSignature);
  for (std::size_t at = kSignature; at + kHead + kChecksum <= png.size();) {
    const std::size_t length = u32(png, at);
    if (length > png.size() - at - kHead - kChecksum) return truncated();
    const auto chunk = png.subspan(at, kHead + length + kChecksum);
    const std::string_view type(reinterpret_cast<const char*>(&chunk[4]), 4);
    if (std::ranges::find(kNeeded, type) != kNeeded.end()) {
      if (crc(chunk.subspan(4, 4 + length)) != u32(chunk, kHead + length))
        return fail(subject, "is damaged: its " + std::string(type) + " chunk has a wrong checksum",
                    "save it again");
      out.insert(out.end(), chunk.begin(), chunk.end());
    }
    if (type == "IEND") return out;
    at += chunk.size();
  }
  return truncated();
}

}  // namespace lambent::baker
