// What stages of a bake hand on, as bytes to keep in a cache and back. Reading is false, and leaves any part
// changed, where the bytes are not such a result.
#pragma once

#include <vector>

#include "baker/bake/bake.hpp"
#include "baker/bake/ship_meshes.hpp"
#include "baker/brdf/surface_brdfs.hpp"
#include "baker/cache/bytes.hpp"
#include "baker/compress/baked_grids.hpp"
#include "baker/compress/kept_transfer.hpp"
#include "baker/light_probes/light_probes.hpp"
#include "runtime/bundle/capture_proxy.hpp"

namespace lambent::baker {

void write(const CodedCell& cell, ByteWriter& out);
bool read(ByteReader& in, CodedCell& cell);

void write(const LightProbes& lights, ByteWriter& out);
bool read(ByteReader& in, LightProbes& lights);

void write(const bundle::CaptureProxy& proxy, ByteWriter& out);
bool read(ByteReader& in, bundle::CaptureProxy& proxy);

void write(const BrdfTables& tables, ByteWriter& out);
bool read(ByteReader& in, BrdfTables& tables);

void write(const GroupFigures& figures, ByteWriter& out);
bool read(ByteReader& in, GroupFigures& figures);

// Lists of any of these.
template <typename T>
void write(const std::vector<T>& list, ByteWriter& out) {
  out.add(std::uint64_t{list.size()});
  for (const T& value : list) write(value, out);
}
template <typename T>
bool read(ByteReader& in, std::vector<T>& list) {
  std::uint64_t count = 0;
  if (!in.read(count)) return false;
  list.clear();
  for (std::uint64_t i = 0; i < count; ++i)
    if (!read(in, list.emplace_back())) return false;
  return true;
}

}  // namespace lambent::baker
