#include "runtime/transfer/light_weights.hpp"

#include <numeric>

#include "runtime/base/payload_bytes.hpp"

namespace lambent::transfer {

std::vector<std::byte> encodeLightWeights(std::span<const LightWeights> samples) {
  std::vector<std::byte> out;
  out.reserve(samples.size() * 2 * kLightsPerSample);
  for (std::size_t k = 0; k < kLightsPerSample; ++k)
    for (const LightWeights& sample : samples) out.push_back(static_cast<std::byte>(sample.light[k]));
  for (std::size_t k = 0; k < kLightsPerSample; ++k)
    for (const LightWeights& sample : samples) out.push_back(static_cast<std::byte>(sample.weight[k]));
  return out;
}

Result<std::vector<LightWeights>> decodeLightWeights(std::span<const std::byte> bytes,
                                                     std::size_t sample_count, std::size_t light_count,
                                                     const std::string& subject) {
  const auto damaged = [&](const char* why) {
    return fail(subject, std::string("has damaged light weights: ") + why, kCopyAgain);
  };
  if (bytes.size() / (2 * kLightsPerSample) != sample_count || bytes.size() % (2 * kLightsPerSample) != 0)
    return damaged("of another number of samples");
  std::vector<LightWeights> samples(sample_count);
  for (std::size_t i = 0; i < sample_count; ++i) {
    LightWeights& sample = samples[i];
    for (std::size_t k = 0; k < kLightsPerSample; ++k) {
      sample.light[k] = std::to_integer<std::uint8_t>(bytes[k * sample_count + i]);
      sample.weight[k] = std::to_integer<std::uint8_t>(bytes[(kLightsPerSample + k) * sample_count + i]);
      if (sample.light[k] >= light_count) return damaged("a light probe that the cell does not have");
    }
    if (std::accumulate(sample.weight.begin(), sample.weight.end(), 0u) != 255)
      return damaged("the weights of a sample do not sum to 255");
  }
  return samples;
}

}  // namespace lambent::transfer
