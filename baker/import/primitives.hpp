// Reads one primitive of a checked document as posed triangles, from plain or Draco data, and lists, strips
// or fans.
#pragma once

#include <string>
#include <vector>

#include "baker/import/document.hpp"
#include "baker/import/pose.hpp"
#include "runtime/base/result.hpp"
#include "runtime/bundle/mesh.hpp"

namespace lambent::baker {

// Returns an empty mesh, and adds a warning, if it has no triangles. The mesh is not cleaned yet.
Result<bundle::MeshData> readPrimitive(const Document& document, const lambent_tinygltf::Primitive& primitive,
                                       const MeshPose& pose, bool tangents, const std::string& name,
                                       std::vector<std::string>& warnings);

}  // namespace lambent::baker
