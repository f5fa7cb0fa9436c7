// Packs the results of stages into bytes for the cache, and reads them back. read() returns false if the
// bytes are not such a result; the value may then have changed in part.
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
