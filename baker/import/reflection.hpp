// Converts what the surfaces of a material reflect besides their base colour: numbers and colours by the
// table of a material's fields, their textures, and measured BRDFs, which are read when the first material
// names them. Only this room includes this header.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>

#include "baker/import/material_textures.hpp"

namespace lambent::baker {

// Reads the measured BRDFs of a scene; materials that name one file share one entry of Scene::brdfs.
class MeasuredBrdfs {
 public:
  MeasuredBrdfs(const Document& document, Scene& scene) : document_(document), scene_(scene) {}

  // Sets Material::brdf if the material's `extras.lambent.brdf` names a file. Errors: those of resolveUri and
  // readMeasuredBrdf, with the material's number.
  Result<void> bind(const tinygltf::Material& source, std::size_t number, gltf::Material& material);

 private:
  const Document& document_;
  Scene& scene_;
  std::map<std::filesystem::path, std::int32_t> number_of_;
};

// Reads what material `number` of the file reflects. Unlit, base colour and brdf must be set before; textures
// that could change nothing are left out of the scene.
void convertReflection(const Document& document, std::size_t number, MaterialTextures& textures,
                       gltf::Material& material);

}  // namespace lambent::baker
