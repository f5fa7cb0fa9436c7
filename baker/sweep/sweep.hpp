// Runs a whole sweep: every setting in turn, what is known already from an earlier run. A request comes in;
// what was measured goes out, also if the sweep was stopped or a setting failed. The folder `output` holds
// results.jsonl (store.hpp) and the folder `work`. Runs on the calling thread.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "baker/sweep/knobs.hpp"
#include "baker/sweep/measure.hpp"
#include "baker/sweep/rows.hpp"

namespace lambent::baker {

struct SweepRequest {
  std::filesystem::path scene, output;
  Quality quality = Quality::Draft;
  std::vector<std::string> lights;  // empty: the programs' default lights
  std::string camera, size;         // empty: by the scene, by the quality
  std::uint32_t spp = 0;            // 0: by the quality
  std::vector<std::string> knobs;   // as settingsOf() takes them
  bool force = false, allow_outside = false;
  Programs programs;
};

// A Measured is one setting with all that is known of it.
struct Measured {
  Setting setting;
  std::string key;  // equal for settings that come to the same
  BakeRow bake;
  PictureRow picture;
  double visible = 0.0;  // share of the pixels that an eye sees as different from the reference
  std::filesystem::path picture_file;
};

// The parts of an error as light is, as far as they are known. Their squares add up to its square.
struct ErrorParts {
  std::optional<double> noise = {}, codes = {},
                        interpolation = {};  // the bake's own figures, scaled to this picture
  double within_bands = 0.0;                 // these three, or what stands for them together
  double beyond_bands = 0.0;                 // truncation, and what key lights add or miss
};
ErrorParts partsOf(const Measured& measured);

struct SweepResults {
  std::string scene;  // its name
  Quality quality = Quality::Draft;
  SweepView view;
  std::string machine;
  std::vector<Measured> settings = {};  // the base first
  spec::RgbaImage reference = {};       // of light as it is
  float exposure = 1.0f;
  ReferenceRow reference_row = {};
  std::vector<std::string> failures = {};  // one sentence each
  std::size_t asked = 0;                   // settings, of which some may not be measured yet
  std::size_t rows_measured = 0;           // in this run
  bool stopped = false;
};

// Hears how far the sweep is.
struct SweepListener {
  std::function<void(std::size_t done, std::size_t all, const std::string& what)> begin;
  std::function<void(std::size_t done, std::size_t all, const Measured& measured)> measured;
};

// Fails if the scene cannot be read, an option is wrong, or the base cannot be measured.
Result<SweepResults> runSweep(const SweepRequest& request, const SweepListener& listener,
                              const std::stop_token& stop);

}  // namespace lambent::baker
