#include "baker/trace/hits.hpp"

#include "runtime/base/payload_bytes.hpp"

namespace lambent::baker {

namespace {

// What panes pass of the light where there are none.
constexpr std::uint16_t kAllPassed = 0xffff;

// Writes seven bits to a byte, the lowest first.
void put(std::uint32_t value, std::vector<std::uint8_t>& out) {
  for (; value >= 0x80; value >>= 7) out.push_back(static_cast<std::uint8_t>(value | 0x80));
  out.push_back(static_cast<std::uint8_t>(value));
}
bool take(std::span<const std::uint8_t>& in, std::uint32_t& value) {
  value = 0;
  for (int shift = 0; shift < 35 && !in.empty(); shift += 7) {
    const std::uint8_t byte = in.front();
    in = in.subspan(1);
    value |= std::uint32_t{byte & 0x7fu} << shift;
    if (byte < 0x80) return true;
  }
  return false;
}

}  // namespace

void writeHits(const RangeHits& hits, ByteWriter& out) {
  std::vector<std::uint8_t> numbers;
  std::vector<std::uint16_t> places, passed;
  numbers.reserve(3 * hits.hits.size());
  places.reserve(2 * hits.hits.size());
  GatherHit last;
  for (const GatherHit& hit : hits.hits) {
    put(zigzag(static_cast<std::int32_t>(hit.ray - last.ray)), numbers);
    put(zigzag(static_cast<std::int32_t>(hit.triangle - last.triangle)), numbers);
    places.push_back(hit.u);
    places.push_back(hit.v);
    passed.insert(passed.end(), hit.albedo, hit.albedo + 3);
    last = hit;
  }
  if (std::ranges::all_of(passed, [](std::uint16_t share) { return share == kAllPassed; })) passed.clear();
  out.addList(hits.offsets);
  out.addList(hits.scales);
  out.addList(numbers);
  out.addList(places);
  out.addList(passed);
}

bool readHits(ByteReader& in, std::size_t samples, std::size_t triangle_count, RangeHits& hits) {
  hits.hits.clear();
  std::vector<std::uint8_t> numbers;
  std::vector<std::uint16_t> places, passed;
  if (!in.readList(hits.offsets) || hits.offsets.size() != samples + 1 || hits.offsets.front() != 0 ||
      !std::is_sorted(hits.offsets.begin(), hits.offsets.end()))
    return false;
  if (!in.readList(hits.scales) || (!hits.scales.empty() && hits.scales.size() != samples)) return false;
  if (!in.readList(numbers) || !in.readList(places) || places.size() != 2 * std::size_t{hits.offsets.back()})
    return false;
  if (!in.readList(passed) || (!passed.empty() && passed.size() != 3 * std::size_t{hits.offsets.back()}))
    return false;
  hits.hits.reserve(hits.offsets.back());
  std::span<const std::uint8_t> left = numbers;
  GatherHit last;
  for (std::size_t i = 0; i < places.size(); i += 2) {
    std::uint32_t ray = 0, triangle = 0;
    if (!take(left, ray) || !take(left, triangle)) return false;
    last = {.triangle = last.triangle + static_cast<std::uint32_t>(unzigzag(triangle)),
            .ray = last.ray + static_cast<std::uint32_t>(unzigzag(ray)),
            .u = places[i],
            .v = places[i + 1],
            .albedo = {kAllPassed, kAllPassed, kAllPassed}};
    if (!passed.empty()) std::copy_n(&passed[3 * (i / 2)], 3, last.albedo);
    if (last.triangle >= triangle_count) return false;
    hits.hits.push_back(last);
  }
  return left.empty();
}

}  // namespace lambent::baker
