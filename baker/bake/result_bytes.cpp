#include "baker/bake/result_bytes.hpp"

#include "baker/transport/geometry_key.hpp"

namespace lambent::baker {

void write(const LightProbes& lights, ByteWriter& out) {
  out.addList(lights.points);
  out.add(std::uint64_t{lights.cells.size()});
  for (const LightProbes::Cell& cell : lights.cells) {
    out.addList(cell.points);
    out.addList(cell.weights);
  }
}

bool read(ByteReader& in, LightProbes& lights) {
  std::uint64_t cells = 0;
  if (!in.readList(lights.points) || !in.read(cells)) return false;
  for (std::uint64_t c = 0; c < cells; ++c) {
    LightProbes::Cell& cell = lights.cells.emplace_back();
    if (!in.readList(cell.points) || !in.readList(cell.weights)) return false;
  }
  return true;
}

void write(const bundle::CaptureProxy& proxy, ByteWriter& out) {
  out.addList(proxy.positions);
  out.add(std::uint64_t{proxy.triangles.size()});
  for (const bundle::ProxyTriangle& t : proxy.triangles) {
    out.add(t.vertices), out.add(t.front_only), out.add(t.emission), out.add(t.light);
    out.add(t.first_entry), out.add(t.entry_count);
  }
  out.add(std::uint64_t{proxy.entries.size()});
  for (const bundle::ProxyEntry& entry : proxy.entries) out.add(entry.sample), out.add(entry.reflectance);
  out.add(std::uint64_t{proxy.levels.size()});
  for (const bundle::ProxyLevel& level : proxy.levels)
    out.add(level.first_triangle), out.add(level.triangle_count), out.add(level.error_m);
  out.addList(proxy.patches.positions), out.add(proxy.patches.error_m);
  out.add(std::uint64_t{proxy.patches.triangles.size()});
  for (const bundle::PatchTriangle& t : proxy.patches.triangles)
    out.add(t.vertices), out.add(t.front_only), out.add(t.albedo), out.add(t.detail);
}

bool read(ByteReader& in, bundle::CaptureProxy& proxy) {
  std::uint64_t count = 0;
  if (!in.readList(proxy.positions) || !in.read(count)) return false;
  for (std::uint64_t i = 0; i < count && in.ok(); ++i) {
    bundle::ProxyTriangle& t = proxy.triangles.emplace_back();
    in.read(t.vertices), in.read(t.front_only), in.read(t.emission), in.read(t.light);
    in.read(t.first_entry), in.read(t.entry_count);
  }
  in.read(count);
  for (std::uint64_t i = 0; i < count && in.ok(); ++i) {
    bundle::ProxyEntry& entry = proxy.entries.emplace_back();
    in.read(entry.sample), in.read(entry.reflectance);
  }
  in.read(count);
  for (std::uint64_t i = 0; i < count && in.ok(); ++i) {
    bundle::ProxyLevel& level = proxy.levels.emplace_back();
    in.read(level.first_triangle), in.read(level.triangle_count), in.read(level.error_m);
  }
  in.readList(proxy.patches.positions), in.read(proxy.patches.error_m), in.read(count);
  for (std::uint64_t i = 0; i < count && in.ok(); ++i) {
    bundle::PatchTriangle& t = proxy.patches.triangles.emplace_back();
    in.read(t.vertices), in.read(t.front_only), in.read(t.albedo), in.read(t.detail);
  }
  return in.ok();
}

void write(const BrdfTables& tables, ByteWriter& out) {
  out.addList(tables.of_material);
  out.add(std::uint64_t{tables.entries.size()});
  for (const BrdfTables::Entry& entry : tables.entries) {
    const bundle::BrdfTable& t = entry.table;
    out.add(entry.family), out.addText(entry.name);
    out.add(std::array{t.order, t.lobes, t.angles, t.azimuths, t.roughnesses, t.strengths});
    out.addList(t.values);
  }
}

bool read(ByteReader& in, BrdfTables& tables) {
  std::uint64_t count = 0;
  if (!in.readList(tables.of_material) || !in.read(count)) return false;
  for (std::uint64_t i = 0; i < count && in.ok(); ++i) {
    BrdfTables::Entry& entry = tables.entries.emplace_back();
    std::array<std::uint32_t, 6> axes{};
    in.read(entry.family), in.readText(entry.name), in.read(axes), in.readList(entry.table.values);
    entry.table.order = axes[0], entry.table.lobes = axes[1], entry.table.angles = axes[2];
    entry.table.azimuths = axes[3], entry.table.roughnesses = axes[4], entry.table.strengths = axes[5];
  }
  return in.ok();
}

void write(const EncodedMesh& mesh, ByteWriter& out) {
  out.addList(mesh.bytes), out.add(mesh.attributes);
  writeMesh(mesh.decoded, out);
}

bool read(ByteReader& in, EncodedMesh& mesh) {
  return in.readList(mesh.bytes) && in.read(mesh.attributes) && readMesh(in, mesh.decoded);
}

}  // namespace lambent::baker
