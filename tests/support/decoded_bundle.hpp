// A bundle read back from its file as the runtime reads it, decoded on the CPU: a mesh and a transfer vector
// per vertex for every draw.
#pragma once

#include <cmath>
#include <filesystem>
#include <numbers>
#include <span>
#include <vector>

#include "runtime/bundle/reader.hpp"
#include "runtime/bundle/transfer_codec.hpp"

namespace lambent::testing {

struct DecodedDraw {
  bundle::Draw draw;
  bundle::MeshData mesh;
  std::vector<float> transfer;  // [vertex * columns + column]
  std::size_t columns = 0;

  std::span<const float> at(std::size_t vertex) const {
    return std::span(transfer).subspan(vertex * columns, columns);
  }
  // E/pi under uniform light of radiance 1.
  float uniformRadiance(std::size_t vertex) const {
    return at(vertex)[0] * std::sqrt(4.0f * std::numbers::pi_v<float>);
  }
};

// Bundles of one transfer channel.
inline Result<std::vector<DecodedDraw>> decodeBundle(const std::filesystem::path& path) {
  const auto reader = bundle::Reader::open(path);
  if (!reader) return failAgain(reader.error());
  if (const auto checked = reader->checkAll(); !checked) return failAgain(checked.error());
  const bundle::Description& d = reader->description();

  std::vector<std::vector<float>> samples;  // per group: [sample * columns + column]
  for (const bundle::Group& group : d.groups) {
    samples.emplace_back();
    for (const bundle::Cell& cell : group.cells) {
      const bundle::DiffuseTransfer& transfer = cell.diffuse.at(0);
      const auto basis = reader->readPayload(transfer.basis).and_then([&](const auto& bytes) {
        return bundle::decodeBasis(bytes, (1 + transfer.planes.size()) * transfer.columns(), "basis");
      });
      if (!basis) return failAgain(basis.error());
      std::vector<std::vector<std::uint32_t>> codes;
      for (const bundle::WeightPlane& plane : transfer.planes) {
        auto decoded = reader->readPayload(plane.payload).and_then([&](const auto& bytes) {
          return bundle::decodePlane(bytes, plane.bits, cell.sample_count, "plane");
        });
        if (!decoded) return failAgain(decoded.error());
        codes.push_back(std::move(*decoded));
      }
      const auto vectors = bundle::decodeTransfer(transfer, cell.sample_count, *basis, codes);
      samples.back().insert(samples.back().end(), vectors.begin(), vectors.end());
    }
  }

  std::vector<DecodedDraw> draws;
  for (const bundle::Draw& draw : d.draws) {
    auto mesh = reader->readMesh(draw.mesh, draw.primitive);
    if (!mesh) return failAgain(mesh.error());
    const bundle::Group& group = d.groups[draw.group];
    const auto rows = reader->readPayload(draw.rows).and_then([&](const auto& bytes) {
      return bundle::decodeRows(bytes, static_cast<std::uint32_t>(mesh->positions.size()), group.sample_count,
                                "rows");
    });
    if (!rows) return failAgain(rows.error());
    DecodedDraw decoded{draw, std::move(*mesh), {}, group.cells.at(0).diffuse.at(0).columns()};
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
