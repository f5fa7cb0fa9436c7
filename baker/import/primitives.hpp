// One primitive of a checked document as triangles: plain or Draco, lists, strips or fans, posed.
#pragma once

#include <string>
#include <vector>

#include "baker/import/document.hpp"
#include "baker/import/pose.hpp"
#include "runtime/base/result.hpp"
#include "runtime/bundle/mesh.hpp"

namespace lambent::baker {

// Empty, with a warning, where there are no triangles in it. Not cleaned yet.
Result<bundle::MeshData> readPrimitive(const Document& document, const lambent_tinygltf::Primitive& primitive,
                                       const MeshPose& pose, bool tangents, const std::string& name,
                                       std::vector<std::string>& warnings);

}  // namespace lambent::baker
