// Brings the pictures of assets: those of environment maps are made of their files, those of scenes, bundles
// and worlds are what the view showed of them last, or else a PNG of their name that lies beside them. Panels
// ask for them; a thread finds them on disk or makes them, in the order in which they were asked for. The
// renderer turns them into textures (editor/render/thumbnails). Main thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "editor/session/assets.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::editor {

class AssetPictures {
 public:
  struct Picture {
    spec::Rgba8Image image{};   // empty: not there yet, or on the GPU
    std::string error{};        // why an environment map cannot be read
    std::uint32_t texture = 0;  // OpenGL name; 0: none yet
    float aspect = 1.0f;        // width / height of the texture
    bool coming = false;        // it is being looked for
  };

  // Pictures are kept in this folder between starts. Without it they are made anew.
  explicit AssetPictures(const std::filesystem::path& folder);
  ~AssetPictures();

  // Returns the picture as far as it is there. The first call for a file, or for a file that changed, asks
  // for it.
  const Picture& of(const Asset& asset);
  // Returns whether it is known that there is no picture of the asset. The first call asks for it, as of()
  // does.
  bool lacks(const Asset& asset);
  // Gives the asset another picture, and keeps it on disk.
  void keep(const Asset& asset, spec::Rgba8Image image);
  // Takes what has come. Call it once a frame.
  void update();
  // Returns whether pictures that were asked for are still to come.
  bool busy() const { return coming_ > 0; }

  std::map<std::filesystem::path, Picture>& pictures() { return pictures_; }

 private:
  struct Worker;

  std::map<std::filesystem::path, Picture> pictures_;
  std::map<std::filesystem::path, Asset> asked_;  // the files as they were when their pictures were asked for
  std::size_t coming_ = 0;
  std::unique_ptr<Worker> worker_;
};

}  // namespace lambent::editor
