// Says where each scene of a folder is baked to, for --watch and for bakes of folders: beside the scene, or
// under a folder for bundles that mirrors the scenes' own.
#pragma once

#include <filesystem>
#include <map>

#include "runtime/base/result.hpp"

namespace lambent::baker {

class FolderOutputs {
 public:
  // With an empty `output` bundles lie beside their scenes.
  FolderOutputs(std::filesystem::path folder, std::filesystem::path output)
      : folder_(std::move(folder)), output_(std::move(output)) {}

  // Returns the bundle, whose folder it makes. Fails if another scene, as a.gltf beside a.glb, has it.
  Result<std::filesystem::path> outputOf(const std::filesystem::path& scene);
  // Gives the bundle of a scene that is gone to others.
  void forget(const std::filesystem::path& scene);

 private:
  std::filesystem::path folder_, output_;
  std::map<std::filesystem::path, std::filesystem::path> scene_of_;  // by output
};

}  // namespace lambent::baker
