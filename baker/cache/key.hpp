// A Key names a result in the cache: it is a digest of everything that the result depends on. Whoever keeps a
// result adds all of its inputs, and nothing else, to a KeyMaker; equal keys then mean equal results, to the
// byte. Keys of stages begin with a digest of the program itself, so that other code, another compiler or
// other flags never find earlier entries. The 128 bits of XXH3 guard against accidents, not against forgery.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
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

}  // namespace lambent::baker
