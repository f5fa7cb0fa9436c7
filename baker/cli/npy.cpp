#include "baker/cli/npy.hpp"

#include <bit>
#include <cassert>
#include <functional>
#include <numeric>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "runtime/base/atomic_file.hpp"

namespace lambent::baker {

namespace {

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie in memory");

Result<void> write(const std::filesystem::path& path, const ArrayShape& shape, std::string_view type,
                   std::span<const std::byte> values) {
  std::string sides;
  for (const std::size_t side : shape) sides += fmt::format("{}, ", side);
  std::string header = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}", type, sides);
  // The magic word, the version and the length of the header come before it; together they fill blocks of 64.
  constexpr std::size_t kBefore = 10, kBlock = 64;
  header.append((kBlock - (kBefore + header.size() + 1) % kBlock) % kBlock, ' ');
  header += '\n';
  std::string text = "\x93NUMPY";
  text += {'\1', '\0', static_cast<char>(header.size() & 0xff), static_cast<char>(header.size() >> 8)};
  text += header;
  Result<AtomicFile> file = AtomicFile::open(path);
  if (!file) return failAgain(file.error());
  if (Result<void> done = file->write(text); !done) return done;
  if (Result<void> done = file->write(values); !done) return done;
  return file->commit();
}

template <class Value>
Result<void> writeValues(const std::filesystem::path& path, const ArrayShape& shape, std::string_view type,
                         std::span<const Value> values) {
  assert(std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>()) == values.size());
  return write(path, shape, type, std::as_bytes(values));
}

}  // namespace

Result<void> writeNpy(const std::filesystem::path& path, const ArrayShape& shape,
                      std::span<const float> values) {
  return writeValues(path, shape, "<f4", values);
}

Result<void> writeNpy(const std::filesystem::path& path, const ArrayShape& shape,
                      std::span<const std::uint32_t> values) {
  return writeValues(path, shape, "<u4", values);
}

}  // namespace lambent::baker
