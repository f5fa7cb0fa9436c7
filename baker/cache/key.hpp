// A Key names a result in the cache: it is a digest of everything that the result depends on. Whoever keeps a
// result adds all of its inputs, and nothing else, to a KeyMaker; equal keys then mean equal results, to the
// byte. Keys of stages begin with a digest of the program itself, so that other code, another compiler or
// other flags never find earlier entries. The 128 bits of XXH3 guard against accidents, not against forgery.
#pragma once

#include <algorithm>
#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include <glm/fwd.hpp>

struct XXH3_state_s;  // of xxhash.h

namespace lambent::baker {

struct Key {
  std::uint64_t high = 0, low = 0;

  std::string hex() const;  // 32 digits
  friend auto operator<=>(const Key&, const Key&) = default;
};

// True for types whose bytes are their value, without padding or pointers. Structs of floats are added to it
// where they are kept.
template <typename T>
inline constexpr bool kPlainBytes =
    std::has_unique_object_representations_v<T> || std::is_floating_point_v<T>;
template <glm::length_t L, typename T, glm::qualifier Q>
inline constexpr bool kPlainBytes<glm::vec<L, T, Q>> = kPlainBytes<T>;
template <glm::length_t C, glm::length_t R, typename T, glm::qualifier Q>
inline constexpr bool kPlainBytes<glm::mat<C, R, T, Q>> = kPlainBytes<T>;
template <typename T, std::size_t N>
inline constexpr bool kPlainBytes<std::array<T, N>> = kPlainBytes<T>;

template <typename T>
concept PlainBytes = std::is_trivially_copyable_v<T> && !std::is_pointer_v<T> && kPlainBytes<T>;

class KeyMaker {
 public:
  KeyMaker();  // begins with nothing
  // Begins the key of a stage's result with the program's digest and the stage's name.
  static KeyMaker ofStage(std::string_view stage);

  template <PlainBytes... T>
  KeyMaker& add(const T&... values) {
    (addBytes(std::as_bytes(std::span(&values, 1))), ...);
    return *this;
  }
  // Lists and texts are preceded by their length, so that no two sequences of values have the same bytes.
  template <PlainBytes T>
  KeyMaker& addList(std::span<const T> list) {
    return add(std::uint64_t{list.size()}).addBytes(std::as_bytes(list));
  }
  template <PlainBytes T>
  KeyMaker& addList(const std::vector<T>& list) {
    return addList(std::span<const T>(list));
  }
  KeyMaker& addText(std::string_view text) { return addList(std::span<const char>(text)); }

  // Returns the key of everything added so far.
  Key key() const;

 private:
  KeyMaker& addBytes(std::span<const std::byte> bytes);

  struct Free {
    void operator()(XXH3_state_s* hash) const;
  };
  std::unique_ptr<XXH3_state_s, Free> hash_;
};

// Returns a digest of the sources of the baker and of what it uses, the compiler and its flags.
std::string_view programDigest();

// Packs values into bytes and back for the cache: values are copied as they lie in memory, and lists begin
// with their length. This is no file format, since entries are only read by the very program that wrote them
// (key.hpp). Reading checks every length; after the first mismatch all reads fail, so that it is enough to
// look at ok() once.

class ByteWriter {
 public:
  template <PlainBytes T>
  void add(const T& value) {
    append(std::as_bytes(std::span(&value, 1)));
  }
  template <PlainBytes T>
  void addList(std::span<const T> list) {
    add(std::uint64_t{list.size()});
    append(std::as_bytes(list));
  }
  template <PlainBytes T>
  void addList(const std::vector<T>& list) {
    addList(std::span<const T>(list));
  }
  // Appends what another writer wrote.
  void addBytes(std::span<const std::byte> bytes) { append(bytes); }

  std::size_t size() const { return bytes_.size(); }
  std::span<const std::byte> bytes() const { return bytes_; }
  std::vector<std::byte> take() { return std::exchange(bytes_, {}); }

 private:
  void append(std::span<const std::byte> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }

  std::vector<std::byte> bytes_;
};

class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : left_(bytes) {}

  template <PlainBytes T>
  bool read(T& value) {
    return copy(std::as_writable_bytes(std::span(&value, 1)));
  }
  // Reads a vector or a text.
  template <typename List>
  bool readList(List& list) {
    std::uint64_t count = 0;
    if (!read(count) || count > left_.size() / sizeof(list[0])) return failed();
    list.resize(static_cast<std::size_t>(count));
    return copy(std::as_writable_bytes(std::span(list)));
  }
  // Reads a list that must have exactly the length of `list`.
  template <PlainBytes T>
  bool readInto(std::span<T> list) {
    std::uint64_t count = 0;
    if (!read(count) || count != list.size()) return failed();
    return copy(std::as_writable_bytes(list));
  }
  // Returns a reader for the next `count` bytes, and moves past them.
  ByteReader part(std::uint64_t count) {
    if (count > left_.size()) {
      failed();
      return ByteReader({});
    }
    const auto bytes = left_.first(static_cast<std::size_t>(count));
    left_ = left_.subspan(bytes.size());
    return ByteReader(bytes);
  }

  bool ok() const { return ok_; }
  bool atEnd() const { return ok_ && left_.empty(); }

 private:
  bool failed() {
    ok_ = false;
    left_ = {};
    return false;
  }
  bool copy(std::span<std::byte> to) {
    if (!ok_ || to.size() > left_.size()) return failed();
    std::ranges::copy(left_.first(to.size()), to.begin());
    left_ = left_.subspan(to.size());
    return true;
  }

  std::span<const std::byte> left_;
  bool ok_ = true;
};

// The members of a struct that are kept, as a tuple of pointers in the order of their bytes. write() and
// read() take these structs, plain bytes, and texts, lists and optionals of what they take. read() returns
// false if the bytes are no such value, and may have changed a part of it by then.
template <typename T>
inline constexpr auto kKeptMembers = std::tuple();
template <typename T>
concept HasKeptMembers = std::tuple_size_v<std::remove_const_t<decltype(kKeptMembers<T>)>> >
0;

template <PlainBytes T>
void write(const T& value, ByteWriter& out) {
  out.add(value);
}
template <PlainBytes T>
bool read(ByteReader& in, T& value) {
  return in.read(value);
}

inline void write(const std::string& text, ByteWriter& out) {
  out.addList(std::span<const char>(text));
}
inline bool read(ByteReader& in, std::string& text) {
  return in.readList(text);
}

template <typename T>
void write(const std::vector<T>& list, ByteWriter& out) {
  if constexpr (PlainBytes<T>) {
    out.addList(list);
  } else {
    out.add(std::uint64_t{list.size()});
    for (const T& value : list) write(value, out);
  }
}
template <typename T>
bool read(ByteReader& in, std::vector<T>& list) {
  if constexpr (PlainBytes<T>) return in.readList(list);
  std::uint64_t count = 0;
  if (!in.read(count)) return false;
  list.clear();
  for (std::uint64_t i = 0; i < count; ++i)
    if (!read(in, list.emplace_back())) return false;
  return true;
}

template <typename T>
void write(const std::optional<T>& value, ByteWriter& out) {
  out.add(value.has_value());
  if (value) write(*value, out);
}
template <typename T>
bool read(ByteReader& in, std::optional<T>& value) {
  bool any = false;
  if (!in.read(any)) return false;
  value.reset();
  return !any || read(in, value.emplace());
}

template <HasKeptMembers T>
void write(const T& value, ByteWriter& out) {
  std::apply([&](auto... member) { (write(value.*member, out), ...); }, kKeptMembers<T>);
}
template <HasKeptMembers T>
bool read(ByteReader& in, T& value) {
  return std::apply([&](auto... member) { return (read(in, value.*member) && ...); }, kKeptMembers<T>);
}

}  // namespace lambent::baker
