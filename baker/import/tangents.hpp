// Makes the tangents of meshes whose files have none, by the rules of MikkTSpace (Mikkelsen 2008), which glTF
// 2.0 asks for and with which most programs bake normal maps.
#pragma once

#include "runtime/bundle/gltf_types.hpp"
#include "runtime/bundle/mesh.hpp"

namespace lambent::baker {

// `map` says which texture coordinates are used, and how they are transformed. A vertex around which the
// picture is mirrored becomes two. Does nothing without texture coordinates. The mesh has normals.
void makeTangents(bundle::MeshData& mesh, const gltf::TextureRef& map);

}  // namespace lambent::baker
