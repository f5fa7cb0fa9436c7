#include "runtime/scene/stable_id.hpp"

#include <cstddef>
#include <vector>

#include "runtime/bundle/container.hpp"

namespace lambent::scene {
namespace {

// Appends a value in little-endian order on every machine. Values of fixed size come first and text last, so
// no two inputs give the same bytes.
template <class T>
void append(std::vector<std::byte>& bytes, T value) {
  for (std::size_t i = 0; i < sizeof(T); ++i)
    bytes.push_back(static_cast<std::byte>(value >> (8 * i) & 0xff));
}

StableId hash(std::uint64_t parent, std::uint8_t kind, std::uint32_t ordinal, std::string_view name) {
  std::vector<std::byte> bytes;
  append(bytes, parent);
  append(bytes, ordinal);
  bytes.push_back(static_cast<std::byte>(kind));
  for (const char c : name) bytes.push_back(static_cast<std::byte>(c));
  return {bundle::checksum(bytes)};
}

}  // namespace

StableId instanceId(std::string_view bundle_id, std::uint32_t instance) {
  return hash(0, 0, instance, bundle_id);
}

StableId childId(StableId parent, StableKind kind, std::string_view name, std::uint32_t ordinal) {
  return hash(parent.value, static_cast<std::uint8_t>(kind), ordinal, name);
}

}  // namespace lambent::scene
