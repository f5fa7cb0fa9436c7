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
#include "baker/sweep/programs.hpp"
#include "baker/sweep/rows.hpp"
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

  // Two pictures with independent noise, and their mean.
  struct Reference {
    ReferenceRow row;  // of both together
    spec::RgbaImage a, b, mean;
  };
  // Takes the bands as `lambent reference` does; empty: light as it is. The result lives as long as this.
  Result<const Reference*> reference(const std::string& bands);
  // Returns what `bands` means for a setting.
  std::string bandsOf(const Setting& setting) const;

  Result<BakeRow> bake(const Setting& setting);
  Result<PictureRow> picture(const Setting& setting);
  // Returns the share of the pixels of its picture that an eye sees as different (perceptual.hpp). The
  // picture is there once picture() was called.
  Result<double> visible(const Setting& setting);

  // Returns where the linear picture of a setting lies.
  std::filesystem::path pictureFile(const Setting& setting) const;
  // Two settings with the same keys have the same rows.
  std::string keyOf(const Setting& setting) const;
  float exposure() const { return exposure_; }

 private:
  struct Drawn {
    Ran ran;
    spec::RgbaImage picture;
  };
  using Words = std::map<std::string, std::string>;

  std::string key(const std::string& kind, const std::string& text) const;
  std::string bakeKey(const Setting& setting) const;
  std::filesystem::path bundleOf(const Setting& setting) const;
  std::vector<std::string> viewWords() const;
  // Returns what the bundle of a setting takes on the GPU without planes, and whole.
  Result<MemoryRow> memory(const Setting& setting);
  Result<BakeRow> runBake(const Setting& setting);
  Result<Drawn> draw(const Setting& setting, const Words& words, const std::filesystem::path& file,
                     int frames);
  Result<Figures> compare(const spec::RgbaImage& picture, const Reference& reference,
                          const std::string& subject) const;

  Job job_;
  Store& store_;
  std::stop_token stop_;
  std::string bakes_, common_;                   // what keys of bakes depend on, and all other keys
  std::map<std::string, Reference> references_;  // by bands
  float exposure_ = 1.0f;
};

}  // namespace lambent::baker
