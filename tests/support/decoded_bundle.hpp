// Reads a bundle from its file as the runtime does and decodes it on the CPU: for every draw a mesh and a
// transfer vector per vertex.
#pragma once

#include <cmath>
#include <filesystem>
#include <numbers>
#include <span>
#include <vector>

#include "runtime/bundle/container.hpp"

namespace lambent::testing {

struct DecodedDraw {
  bundle::Draw draw;
  bundle::MeshData mesh;
  std::vector<float> transfer;  // [vertex * columns + column]
  std::size_t columns = 0;

  std::span<const float> at(std::size_t vertex) const {
    return std::span(transfer).subspan(vertex * columns, columns);
  }
  // Returns E/pi under uniform light of radiance 1.
  float uniformRadiance(std::size_t vertex) const {
    return at(vertex)[0] * std::sqrt(4.0f * std::numbers::pi_v<float>);
  }
};

// Decodes the transfer of the environment: the full block if there is one, else the shadowed one, and
// `channel` of it if it has three. Bundles with normal maps are not supported.
inline Result<std::vector<DecodedDraw>> decodeBundle(const std::filesystem::path& path,
                                                     std::uint32_t channel = 0) {
  const auto reader = bundle::Reader::open(path);
  if (!reader) return failAgain(reader.error());
  if (const auto checked = reader->checkAll(); !checked) return failAgain(checked.error());
  const bundle::Description& d = reader->description();

  std::vector<std::vector<float>> samples;  // per group: [sample * columns + column]
  for (std::uint32_t g = 0; g < d.groups.size(); ++g) {
    samples.emplace_back();
    for (std::uint32_t c = 0; c < d.groups[g].cells.size(); ++c) {
      const bundle::CellTransfer& transfer = d.groups[g].cells[c].transfers.at(0);
      const transfer::TransferShape& shape = transfer.shape;
      const auto codes = reader->readCodebook(bundle::GroupIndex{g}, bundle::CellIndex{c}, {});
      if (!codes) return failAgain(codes.error());
      std::vector<std::vector<std::uint32_t>> planes;
      for (std::uint32_t j = 0; j < transfer.planes.size(); ++j) {
        auto plane =
            reader->readPlane(bundle::GroupIndex{g}, bundle::CellIndex{c}, {}, bundle::PlaneIndex{j});
        if (!plane) return failAgain(plane.error());
        planes.push_back(std::move(*plane));
      }
      const auto vectors = transfer::decodeTransfer(shape, codes->codebook, codes->cluster_of, planes);
      const std::uint32_t first = shape.full_channels > 0 ? shape.shadowed_channels : 0;
      const std::uint32_t channels = shape.full_channels > 0 ? shape.full_channels : shape.shadowed_channels;
      const std::size_t begin = std::size_t{first + (channels == 3 ? channel : 0)} * shape.columns();
      for (std::size_t s = 0; s < codes->cluster_of.size(); ++s)
        for (std::size_t i = 0; i < shape.columns(); ++i)
          samples.back().push_back(vectors[s * shape.size() + begin + i]);
    }
  }

  std::vector<DecodedDraw> draws;
  for (std::uint32_t number = 0; number < d.draws.size(); ++number) {
    const bundle::Draw& draw = d.draws[number];
    auto mesh = reader->readMesh(draw.mesh, draw.primitive);
    if (!mesh) return failAgain(mesh.error());
    const auto rows = reader->readRows(number);
    if (!rows) return failAgain(rows.error());
    DecodedDraw decoded{
        draw, std::move(*mesh), {}, d.groups[draw.group].cells.at(0).transfers.at(0).shape.columns()};
    decoded.transfer.assign(decoded.mesh.positions.size() * decoded.columns, 0.0f);
    for (std::size_t v = 0; v < decoded.mesh.positions.size(); ++v)
      for (std::uint32_t entry = rows->offsets[v]; entry < rows->offsets[v + 1]; ++entry)
        for (std::size_t i = 0; i < decoded.columns; ++i)
          decoded.transfer[v * decoded.columns + i] +=
              rows->weights[entry] * samples[draw.group][rows->samples[entry] * decoded.columns + i];
    draws.push_back(std::move(decoded));
  }
  return draws;
}

}  // namespace lambent::testing
