// Writes the bytes of payloads one value after the other, and reads them back with every length checked. The
// codecs of this room use it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace lambent {

// The hint of errors about damaged bytes of a bundle.
inline constexpr const char* kCopyAgain = "copy it again or bake it again";

// Appends 16-bit words as a run of low bytes and a run of high bytes. The entropy coder works on bytes, and
// the two kinds have different statistics.
inline void appendSplit(std::vector<std::byte>& out, std::span<const std::uint16_t> words) {
  for (const std::uint16_t word : words) out.push_back(static_cast<std::byte>(word & 0xff));
  for (const std::uint16_t word : words) out.push_back(static_cast<std::byte>(word >> 8));
}

inline std::uint16_t splitWord(std::span<const std::byte> bytes, std::size_t count, std::size_t i) {
  return static_cast<std::uint16_t>(std::to_integer<unsigned>(bytes[i]) |
                                    std::to_integer<unsigned>(bytes[count + i]) << 8);
}

// Maps 0, -1, 1, -2, ... to 0, 1, 2, 3, ..., so that integers near zero have few bits set.
inline std::uint32_t zigzag(std::int32_t value) {
  return static_cast<std::uint32_t>(value) << 1 ^ static_cast<std::uint32_t>(value >> 31);
}

inline std::int32_t unzigzag(std::uint32_t word) {
  return static_cast<std::int32_t>(word >> 1 ^ (~(word & 1) + 1));
}

// Appends integers near zero as 32-bit words in four runs of bytes, the lowest bytes first.
inline void appendIntegers(std::vector<std::byte>& out, std::span<const std::int32_t> values) {
  for (int shift = 0; shift < 32; shift += 8)
    for (const std::int32_t value : values) {
      out.push_back(static_cast<std::byte>(zigzag(value) >> shift & 0xff));
    }
}

template <typename T>
void appendValues(std::vector<std::byte>& out, std::span<const T> values) {
  const auto bytes = std::as_bytes(values);
  out.insert(out.end(), bytes.begin(), bytes.end());
}

// Takes values off the front of a payload. Once bytes are missing, every later call returns nothing and
// allocates nothing.
class Front {
 public:
  explicit Front(std::span<const std::byte> bytes) : rest_(bytes) {}

  bool whole() const { return whole_ && rest_.empty(); }
  std::size_t left() const { return rest_.size(); }

  template <typename T>
  std::vector<T> values(std::uint64_t count) {
    const auto bytes = take(count, sizeof(T));
    std::vector<T> out(bytes.size() / sizeof(T));
    if (!out.empty()) std::memcpy(out.data(), bytes.data(), bytes.size());
    return out;
  }

  std::vector<std::uint16_t> split(std::uint64_t count) {
    const auto bytes = take(count, 2);
    std::vector<std::uint16_t> out(bytes.size() / 2);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = splitWord(bytes, out.size(), i);
    return out;
  }

  std::vector<std::int32_t> integers(std::uint64_t count) {
    const auto bytes = take(count, 4);
    std::vector<std::int32_t> out(bytes.size() / 4);
    for (std::size_t i = 0; i < out.size(); ++i) {
      std::uint32_t word = 0;
      for (std::size_t run = 0; run < 4; ++run)
        word |= std::to_integer<std::uint32_t>(bytes[run * out.size() + i]) << 8 * run;
      out[i] = unzigzag(word);
    }
    return out;
  }

 private:
  std::span<const std::byte> take(std::uint64_t count, std::size_t width) {
    if (!whole_ || rest_.size() / width < count) {
      whole_ = false;
      return {};
    }
    const auto bytes = rest_.first(static_cast<std::size_t>(count) * width);
    rest_ = rest_.subspan(bytes.size());
    return bytes;
  }

  std::span<const std::byte> rest_;
  bool whole_ = true;
};

}  // namespace lambent
