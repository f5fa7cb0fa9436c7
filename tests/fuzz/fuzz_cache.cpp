// Reads cache entries and what is stored in them.
#include "baker/cache/cache.hpp"
#include "baker/trace/hits.hpp"
#include "baker/transport/geometry_key.hpp"
#include "tests/fuzz/input_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lambent;
  const std::span<const std::byte> bytes = std::as_bytes(std::span(data, size));
  static_cast<void>(baker::unpackEntry(baker::Key{}, bytes));
  baker::ByteReader meshes(bytes), hits(bytes);
  bundle::MeshData mesh;
  static_cast<void>(baker::read(meshes, mesh));
  baker::RangeHits range;
  if (baker::readHits(hits, 2, 100, range))
    for (const baker::GatherHit& hit : range.hits)
      fuzz::require(hit.triangle < 100, "a hit lies on a triangle that is there");
  return 0;
}
