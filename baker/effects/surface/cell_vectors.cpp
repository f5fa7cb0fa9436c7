#include "baker/effects/surface/cell_vectors.hpp"

#include <algorithm>
#include <span>

#include "runtime/sh/basis.hpp"

namespace lambent::baker {

namespace {

// Collects columns [first, first + shape.columns()) of a cell's samples.
CellVectors stack(transfer::TransferShape shape, std::size_t first_column, std::size_t first_sample,
                  std::size_t count, const TransferField& direct, const TransferField* bounced) {
  CellVectors out{shape, {}};
  out.vectors.reserve(count * shape.size());
  for (std::size_t s = first_sample; s < first_sample + count; ++s) {
    const auto from = direct.at(s);
    const auto append = [&](std::uint32_t channels, const float* extra) {
      for (std::uint32_t c = 0; c < channels; ++c)
        for (std::uint32_t output = 0; output < shape.outputs; ++output) {
          const std::size_t at = (std::size_t{output} * direct.channels + c) * direct.columns + first_column;
          for (std::size_t i = 0; i < shape.columns(); ++i)
            out.vectors.push_back(from[at + i] + (extra ? extra[at + i] : 0.0f));
        }
    };
    append(shape.shadowed_channels, nullptr);
    if (shape.full_channels > 0) append(shape.full_channels, bounced->at(s).data());
  }
  return out;
}

// Returns whether any bounced light reaches these columns of the cell.
bool anyBounced(const TransferField* bounced, std::size_t first_column, std::size_t columns,
                std::size_t first_sample, std::size_t count) {
  if (!bounced) return false;
  for (std::size_t s = first_sample; s < first_sample + count; ++s) {
    const auto vector = bounced->at(s);
    for (std::size_t row = 0; row < vector.size(); row += bounced->columns)
      for (std::size_t i = first_column; i < first_column + columns; ++i)
        if (vector[row + i] != 0.0f) return true;
  }
  return false;
}

// Returns the cell's part of a list with `size` values for each sample.
std::span<const float> partOf(const std::vector<float>& values, std::size_t size, std::size_t first,
                              std::size_t count) {
  return std::span(values).subspan(first * size, count * size);
}

bool anyIn(std::span<const float> values) {
  return std::any_of(values.begin(), values.end(), [](float value) { return value != 0.0f; });
}

// Returns visibility first, then bounced light if some reaches the cell, then the lights.
std::vector<CellVectors> glossyVectors(const SampleCell& cell, const GlossyField& field, bool grey_emission) {
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

}  // namespace

std::vector<CellVectors> cellVectors(const SampleCell& cell, const SampleSet& samples,
                                     const DirectResult& direct, const BounceResult* bounced,
                                     GreyColumns grey) {
  if (cell.kind == SampleKind::Glossy) return glossyVectors(cell, direct.glossy, grey.lights);
  const bool mapped = cell.kind == SampleKind::NormalMapped;
  const TransferField& field = mapped ? direct.mapped : direct.field;
  const TransferField* extra = nullptr;
  if (bounced) extra = mapped ? &bounced->mapped : &bounced->field;
  const std::size_t first = cell.first - (mapped ? samples.normal_mapped.begin : 0);
  const auto bands = static_cast<std::uint32_t>(sh::coefficientCount(field.order));
  const std::uint32_t lights = field.columns - bands;
  const auto full = [&](std::size_t column, std::size_t columns) {
    return anyBounced(extra, column, columns, first, cell.count) ? field.channels : 0;
  };

  std::vector<CellVectors> out;
  out.push_back(stack({.order = static_cast<std::uint32_t>(field.order),
                       .light_columns = 0,
                       // Direct light of the environment has no colour, unless it passes coloured panes.
                       .shadowed_channels = grey.sky ? 1 : field.channels,
                       .full_channels = full(0, bands),
                       .outputs = field.outputs},
                      0, first, cell.count, field, extra));
  if (lights > 0)
    out.push_back(stack({.order = 0,
                         .light_columns = lights,
                         .shadowed_channels = grey.lights ? 1 : field.channels,
                         .full_channels = full(bands, lights),
                         .outputs = field.outputs},
                        bands, first, cell.count, field, extra));
  return out;
}

}  // namespace lambent::baker
