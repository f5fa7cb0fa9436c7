#include "runtime/bundle/capture_proxy.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "runtime/base/payload_bytes.hpp"

namespace lambent::bundle {

namespace {

// Levels have at most three positions per triangle, so 16 bits hold every index.
constexpr std::uint32_t kMaxTrianglesOfLevels = kMaxProxyLevels * kMaxProxyTriangles;
constexpr std::uint32_t kMaxPositionsOfLevels = 3 * kMaxTrianglesOfLevels;
constexpr float kOne = 65535.0f, kByteOne = 255.0f;
constexpr std::uint32_t kFrontOnly = 0x80;

bool usable(float value) {
  return std::abs(value) <= 1e30f;  // NaN fails every comparison
}

std::uint16_t unorm16(float value) {
  return static_cast<std::uint16_t>(std::lround(std::clamp(value, 0.0f, 1.0f) * kOne));
}

// The patches' surface follows everything else, and is absent if it has no triangles.
void appendPatches(std::vector<std::byte>& out, const PatchSurface& patches) {
  if (patches.triangles.empty()) return;
  assert(patches.triangles.size() <= kMaxPatchTriangles);
  appendValues<std::uint32_t>(out, std::vector{static_cast<std::uint32_t>(patches.positions.size()),
                                               static_cast<std::uint32_t>(patches.triangles.size())});
  std::vector<float> numbers = {patches.error_m};
  for (int axis = 0; axis < 3; ++axis)
    for (const glm::vec3& position : patches.positions) numbers.push_back(position[axis]);
  appendValues<float>(out, numbers);
  std::vector<std::uint16_t> corners;
  for (std::size_t corner = 0; corner < 3; ++corner)
    for (const PatchTriangle& triangle : patches.triangles)
      corners.push_back(static_cast<std::uint16_t>(triangle.vertices[corner]));
  appendSplit(out, corners);
  for (int channel = 0; channel < 3; ++channel)
    for (const PatchTriangle& triangle : patches.triangles)
      out.push_back(
          static_cast<std::byte>(std::lround(std::clamp(triangle.albedo[channel], 0.0f, 1.0f) * kByteOne)));
  for (const PatchTriangle& triangle : patches.triangles)
    out.push_back(
        static_cast<std::byte>((triangle.detail & ~kFrontOnly) | (triangle.front_only ? kFrontOnly : 0)));
}

// Returns why the rest is no such surface; null if it is one.
const char* takePatches(Front& front, PatchSurface& patches) {
  const auto counts = front.values<std::uint32_t>(2);
  if (counts.size() != 2) return "its patches are too short";
  const std::uint32_t positions = counts[0], triangles = counts[1];
  if (triangles == 0 || triangles > kMaxPatchTriangles || positions > 3 * triangles)
    return "more or fewer patches than one may have";
  const auto error = front.values<float>(1);
  const auto places = front.values<float>(3 * std::uint64_t{positions});
  const auto corners = front.split(3 * std::uint64_t{triangles});
  const auto albedos = front.values<std::uint8_t>(3 * std::uint64_t{triangles});
  const auto flags = front.values<std::uint8_t>(triangles);
  if (!front.whole()) return "the sizes of its patches do not add up";
  if (!(error[0] >= 0.0f) || !usable(error[0]) || !std::ranges::all_of(places, usable))
    return "patches with values that are not finite";
  patches.error_m = error[0];
  for (std::size_t i = 0; i < positions; ++i)
    patches.positions.emplace_back(places[i], places[positions + i], places[2 * positions + i]);
  for (std::size_t i = 0; i < triangles; ++i) {
    PatchTriangle& triangle = patches.triangles.emplace_back();
    for (std::size_t corner = 0; corner < 3; ++corner) {
      triangle.vertices[corner] = corners[corner * triangles + i];
      if (triangle.vertices[corner] >= positions) return "a patch with a corner that it does not have";
    }
    triangle.front_only = (flags[i] & kFrontOnly) != 0;
    triangle.detail = static_cast<std::uint8_t>(flags[i] & ~kFrontOnly);
    for (std::size_t channel = 0; channel < 3; ++channel)
      triangle.albedo[static_cast<int>(channel)] =
          static_cast<float>(albedos[channel * triangles + i]) / kByteOne;
  }
  return nullptr;
}

}  // namespace

float patchDensity(std::uint8_t detail) {
  return std::exp2(static_cast<float>(detail) / 8.0f);
}

std::uint8_t detailOf(float density) {
  return static_cast<std::uint8_t>(
      std::clamp(std::lround(8.0f * std::log2(density / kLeastPatchDensity)), 0l, 127l));
}

PatchSurface patchSurfaceOf(const CaptureProxy& proxy) {
  if (!proxy.patches.triangles.empty() || proxy.levels.empty()) return proxy.patches;
  const ProxyLevel& level = proxy.levels.front();
  PatchSurface surface{.positions = proxy.positions, .triangles = {}, .error_m = level.error_m};
  for (std::uint32_t t = 0; t < level.triangle_count; ++t) {
    const ProxyTriangle& from = proxy.triangles[level.first_triangle + t];
    glm::vec3 albedo(0.0f);
    for (std::uint32_t e = 0; e < from.entry_count; ++e)
      albedo += proxy.entries[from.first_entry + e].reflectance;
    surface.triangles.push_back({.vertices = from.vertices,
                                 .front_only = from.front_only,
                                 .albedo = glm::min(albedo, glm::vec3(1.0f))});
  }
  return surface;
}

std::vector<std::byte> encodeCaptureProxy(const CaptureProxy& proxy) {
  assert(proxy.triangles.size() <= kMaxTrianglesOfLevels && proxy.positions.size() <= kMaxPositionsOfLevels);
  std::vector<std::uint32_t> head = {
      static_cast<std::uint32_t>(proxy.levels.size()), static_cast<std::uint32_t>(proxy.positions.size()),
      static_cast<std::uint32_t>(proxy.triangles.size()), static_cast<std::uint32_t>(proxy.entries.size())};
  std::vector<float> numbers;
  for (const ProxyLevel& level : proxy.levels) {
    head.push_back(level.triangle_count);
    numbers.push_back(level.error_m);
  }
  for (int axis = 0; axis < 3; ++axis)
    for (const glm::vec3& position : proxy.positions) numbers.push_back(position[axis]);
  for (int channel = 0; channel < 3; ++channel)
    for (const ProxyTriangle& triangle : proxy.triangles) numbers.push_back(triangle.emission[channel]);

  std::vector<std::uint16_t> corners, lights, reflectances;
  for (std::size_t corner = 0; corner < 3; ++corner)
    for (const ProxyTriangle& triangle : proxy.triangles)
      corners.push_back(static_cast<std::uint16_t>(triangle.vertices[corner]));
  for (const ProxyTriangle& triangle : proxy.triangles)
    lights.push_back(static_cast<std::uint16_t>(triangle.light + 1));
  for (int channel = 0; channel < 3; ++channel)
    for (const ProxyEntry& entry : proxy.entries) reflectances.push_back(unorm16(entry.reflectance[channel]));
  std::vector<std::int32_t> steps;
  for (std::uint32_t before = 0; const ProxyEntry& entry : proxy.entries) {
    steps.push_back(static_cast<std::int32_t>(entry.sample - before));
    before = entry.sample;
  }

  std::vector<std::byte> out;
  appendValues<std::uint32_t>(out, head);
  appendValues<float>(out, numbers);
  for (const auto* words : {&corners, &lights, &reflectances}) appendSplit(out, *words);
  for (const ProxyTriangle& triangle : proxy.triangles)
    out.push_back(static_cast<std::byte>(triangle.entry_count | (triangle.front_only ? kFrontOnly : 0)));
  appendIntegers(out, steps);
  appendPatches(out, proxy.patches);
  return out;
}

Result<CaptureProxy> decodeCaptureProxy(std::span<const std::byte> bytes, std::uint32_t sample_count,
                                        std::uint32_t light_count, const std::string& subject) {
  const auto damaged = [&](const char* why) {
    return fail(subject, std::string("has a damaged capture proxy: ") + why, kCopyAgain);
  };
  Front front(bytes);
  const auto head = front.values<std::uint32_t>(4);
  if (head.size() != 4) return damaged("too short");
  const std::uint32_t levels = head[0], positions = head[1], triangles = head[2], entries = head[3];
  if (levels == 0 || levels > kMaxProxyLevels || positions > kMaxPositionsOfLevels ||
      triangles > kMaxTrianglesOfLevels || entries > triangles * kMaxProxyEntries)
    return damaged("more or fewer parts than one may have");
  const auto counts = front.values<std::uint32_t>(levels);
  const auto errors = front.values<float>(levels);
  const auto places = front.values<float>(3 * std::uint64_t{positions});
  const auto emissions = front.values<float>(3 * std::uint64_t{triangles});
  const auto corners = front.split(3 * std::uint64_t{triangles});
  const auto lights = front.split(triangles);
  const auto reflectances = front.split(3 * std::uint64_t{entries});
  const auto flags = front.values<std::uint8_t>(triangles);
  const auto steps = front.integers(entries);
  CaptureProxy proxy;
  if (front.left() > 0) {
    if (const char* why = takePatches(front, proxy.patches)) return damaged(why);
  }
  if (!front.whole()) return damaged("sizes do not add up");
  for (const auto* numbers : {&errors, &places, &emissions})
    if (!std::all_of(numbers->begin(), numbers->end(), usable)) return damaged("values that are not finite");

  std::uint32_t next_triangle = 0;
  for (std::size_t i = 0; i < levels; ++i) {
    if (counts[i] == 0 || counts[i] > kMaxProxyTriangles || errors[i] < 0.0f)
      return damaged("a level of no or too many triangles");
    proxy.levels.push_back({next_triangle, counts[i], errors[i]});
    next_triangle += counts[i];
  }
  if (next_triangle != triangles) return damaged("levels do not hold all triangles");
  for (std::size_t i = 0; i < positions; ++i)
    proxy.positions.emplace_back(places[i], places[positions + i], places[2 * positions + i]);
  for (std::uint32_t sample = 0, i = 0; i < entries; ++i) {
    sample += static_cast<std::uint32_t>(steps[i]);
    if (sample >= sample_count) return damaged("a sample that the group does not have");
    ProxyEntry entry{sample, {}};
    for (std::uint32_t channel = 0; channel < 3; ++channel)
      entry.reflectance[static_cast<int>(channel)] =
          static_cast<float>(reflectances[channel * entries + i]) / kOne;
    proxy.entries.push_back(entry);
  }
  std::uint32_t next_entry = 0;
  for (std::size_t i = 0; i < triangles; ++i) {
    ProxyTriangle triangle;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      triangle.vertices[corner] = corners[corner * triangles + i];
      if (triangle.vertices[corner] >= positions) return damaged("a corner that it does not have");
    }
    triangle.front_only = (flags[i] & kFrontOnly) != 0;
    for (std::size_t channel = 0; channel < 3; ++channel)
      triangle.emission[static_cast<int>(channel)] = emissions[channel * triangles + i];
    if (glm::any(glm::lessThan(triangle.emission, glm::vec3(0.0f)))) return damaged("negative light");
    triangle.light = std::int32_t{lights[i]} - 1;
    if (lights[i] > light_count) return damaged("a light that the group does not have");
    triangle.first_entry = next_entry;
    triangle.entry_count = flags[i] & ~kFrontOnly;
    next_entry += triangle.entry_count;
    if (triangle.entry_count > kMaxProxyEntries || next_entry > entries)
      return damaged("a triangle of too many entries");
    // If a triangle reflected more than it receives, light between two groups would grow without limit.
    glm::vec3 sum(0.0f);
    for (std::uint32_t e = triangle.first_entry; e < next_entry; ++e) sum += proxy.entries[e].reflectance;
    if (glm::any(glm::greaterThan(sum, glm::vec3(1.0f + kMaxProxyEntries / kOne))))
      return damaged("a triangle that reflects more than it gets");
    proxy.triangles.push_back(triangle);
  }
  if (next_entry != entries) return damaged("triangles do not hold all entries");
  return proxy;
}

}  // namespace lambent::bundle
