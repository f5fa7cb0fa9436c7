#include "baker/effects/glossy/payloads.hpp"

#include <algorithm>
#include <span>

namespace lambent::baker {

namespace {

// Returns the cell's part of a list with `size` values for each sample.
std::span<const float> partOf(const std::vector<float>& values, std::size_t size, std::size_t first,
                              std::size_t count) {
  return std::span(values).subspan(first * size, count * size);
}

bool anyIn(std::span<const float> values) {
  return std::any_of(values.begin(), values.end(), [](float value) { return value != 0.0f; });
}

}  // namespace

std::vector<CellVectors> glossyCellVectors(const SampleCell& cell, const GlossyField& field,
                                           bool grey_emission) {
  const auto order = static_cast<std::uint32_t>(field.order_in),
             outputs = static_cast<std::uint32_t>(field.order_out * field.order_out);
  const std::size_t first = cell.first - field.first_sample, count = cell.count;
  const auto copied = [](std::span<const float> part) {
    return std::vector<float>(part.begin(), part.end());
  };

  std::vector<CellVectors> out;
  const transfer::TransferShape visibility{
      .order = order,
      .outputs = outputs,
      .visibility_bands = static_cast<std::uint32_t>(field.visibilityBands())};
  out.push_back({visibility, copied(partOf(field.visibility, field.visibilitySize(), first, count))});

  const transfer::TransferShape bounced{
      .order = order, .shadowed_channels = 0, .full_channels = field.channels, .outputs = outputs};
  if (!field.bounced.empty())
    if (const auto part = partOf(field.bounced, bounced.size(), first, count); anyIn(part))
      out.push_back({bounced, copied(part)});

  if (field.light_columns == 0) return out;
  transfer::TransferShape lights{.order = 0,
                                 .light_columns = field.light_columns,
                                 .shadowed_channels = grey_emission ? 1 : field.channels,
                                 .full_channels = 0,
                                 .outputs = outputs};
  const std::size_t channel = std::size_t{outputs} * field.light_columns, size = field.channels * channel;
  const auto shadowed = partOf(field.lights_shadowed, size, first, count);
  std::span<const float> full;
  if (!field.lights_full.empty()) full = partOf(field.lights_full, size, first, count);
  if (!std::equal(full.begin(), full.end(), shadowed.begin())) lights.full_channels = field.channels;
  CellVectors vectors{lights, {}};
  vectors.vectors.reserve(count * lights.size());
  const auto append = [&](std::span<const float> from, std::size_t sample, std::uint32_t channels) {
    const auto own = from.subspan(sample * size, channels * channel);
    vectors.vectors.insert(vectors.vectors.end(), own.begin(), own.end());
  };
  for (std::size_t s = 0; s < count; ++s) {
    append(shadowed, s, lights.shadowed_channels);
    if (lights.full_channels > 0) append(full, s, lights.full_channels);
  }
  out.push_back(std::move(vectors));
  return out;
}

}  // namespace lambent::baker
