// Makes one measurement at a time: a reference, a bake or a picture. Each is looked up in the store first, so
// that what is known is not measured again; files that later measurements need lie in the folder `work`. All
// programs run one after the other, since times are measured. Errors name the program that failed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <stop_token>
#include <string>
#include <vector>

#include "baker/sweep/knobs.hpp"
#include "baker/sweep/store.hpp"
#include "runtime/base/process.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::baker {

// View is what all pictures of a sweep have in common.
struct SweepView {
  std::vector<std::string> lights = {};  // as on the command line
  std::string camera = {}, size = {};
  std::uint32_t spp = 64;  // of each of two references
  int frames = 5;          // over which frame times are taken
};

// The programs that a sweep runs. The baker cannot link the runtime's frame, so lambent-demo draws pictures.
struct Programs {
  std::filesystem::path lambent, demo;
};

// A Measured is one setting with all that is known of it.
struct Measured {
  Setting setting;
  std::string key;  // equal for settings that come to the same
  BakeRow bake;
  PictureRow picture;
  double visible = 0.0;         // share of the pixels that an eye sees as different from the reference
  spec::Rgba8Image shown = {};  // the picture as a screen shows it
};

class Measurer {
 public:
  struct Job {
    Programs programs;
    std::filesystem::path scene, work;
    std::uint64_t scene_digest = 0;
    bool glossy = false, allow_outside = false;
    SweepView view;
    // Is called before something is measured, which takes a while.
    std::function<void(const std::string& what)> begin;
  };

  Measurer(Job job, Store& store, std::stop_token stop);

  Result<Measured> measure(const Setting& setting);

  // Two pictures with independent noise.
  struct Reference {
    double seconds = 0.0;  // of both together
    spec::RgbaImage a, b;
    spec::Rgba8Image shown;  // their mean as a screen shows it
  };
  // Takes the bands as `lambent reference` does; empty: light as it is. The result lives as long as this.
  Result<const Reference*> reference(const std::string& bands);

 private:
  using Words = std::map<std::string, std::string>;

  // Returns the row of this key, which `make` measures if it is not known, or if its file is gone.
  template <Row R, typename Make>
  Result<R> known(const std::string& key, const std::string& what, const std::filesystem::path& file,
                  Make&& make);
  std::string key(const std::string& kind, const std::string& text) const;
  std::string bakeKey(const Setting& setting) const;
  std::string pictureKey(const Setting& setting) const;
  std::filesystem::path bundleOf(const Setting& setting) const;
  std::vector<std::string> viewWords() const;
  Result<ReferenceRow> runReference(const std::string& bands, int seed, const std::filesystem::path& file);
  Result<BakeRow> runBake(const Setting& setting);
  // Returns the bytes on the GPU with the setting's share of the planes of transfer.
  Result<std::string> memoryLimit(const Setting& setting, const std::filesystem::path& file);
  Result<PictureRow> drawPictures(const Setting& setting, const std::filesystem::path& file);
  Result<Ran> draw(const Setting& setting, const Words& words, const std::filesystem::path& file, int frames);

  Job job_;
  Store& store_;
  std::stop_token stop_;
  std::string bakes_, common_;                   // what keys of bakes depend on, and all other keys
  std::map<std::string, Reference> references_;  // by bands
  float exposure_ = 1.0f;                        // of all pictures, by the reference of light as it is
};

}  // namespace lambent::baker
