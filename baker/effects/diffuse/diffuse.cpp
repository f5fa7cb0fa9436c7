#include "baker/effects/diffuse/diffuse.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "baker/plan/counted.hpp"
#include "baker/plan/group_lights.hpp"
#include "runtime/sh/basis.hpp"

namespace lambent::baker {

EffectChoice chooseDiffuse(const Scene& scene, const std::vector<RigidGroup>& groups) {
  std::size_t draws = 0, mapped = 0, lights = 0;
  for (const RigidGroup& group : groups) {
    draws += group.draws.size();
    lights += findGroupLights(scene, group).size();
    for (const PlannedDraw& draw : group.draws) {
      const std::int32_t material = scene.meshes[draw.mesh].primitives[draw.primitive].material;
      mapped +=
          material >= 0 && scene.materials[static_cast<std::size_t>(material)].normal_texture.texture >= 0;
    }
  }
  if (draws == 0) return {"diffuse", false, "there are no surfaces"};
  std::string reason =
      fmt::format("{} of surfaces in {}", counted(draws, "draw"), counted(groups.size(), "rigid group"));
  if (lights > 0) reason += fmt::format("; {} of their own", counted(lights, "light"));
  if (mapped > 0) reason += fmt::format("; {} with a normal map", counted(mapped, "draw"));
  return {"diffuse", true, reason};
}

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

}  // namespace

std::vector<CellVectors> cellVectors(const SampleCell& cell, const SampleSet& samples,
                                     const DirectResult& direct, const BounceResult* bounced,
                                     GreyColumns grey) {
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
