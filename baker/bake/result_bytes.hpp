// What stages of a bake hand on, as bytes to keep in a cache and back. Reading is false, and leaves any part
// changed, where the bytes are not such a result.
#pragma once

#include "baker/brdf/surface_brdfs.hpp"
#include "baker/cache/bytes.hpp"
#include "baker/compress/draco_encode.hpp"
#include "baker/light_probes/light_probes.hpp"
#include "runtime/bundle/capture_proxy.hpp"

namespace lambent::baker {

void write(const LightProbes& lights, ByteWriter& out);
bool read(ByteReader& in, LightProbes& lights);

void write(const bundle::CaptureProxy& proxy, ByteWriter& out);
bool read(ByteReader& in, bundle::CaptureProxy& proxy);

void write(const BrdfTables& tables, ByteWriter& out);
bool read(ByteReader& in, BrdfTables& tables);

void write(const EncodedMesh& mesh, ByteWriter& out);
bool read(ByteReader& in, EncodedMesh& mesh);

}  // namespace lambent::baker
