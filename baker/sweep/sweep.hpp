// Runs a whole sweep: every setting in turn, what is known already from an earlier run. A request comes in;
// what was measured goes out, also if the sweep was stopped or a setting failed. The folder `output` holds
// results.jsonl (store.hpp) and the folder `work`. Runs on the calling thread.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "baker/sweep/measure.hpp"

namespace lambent::baker {

struct SweepRequest {
  std::filesystem::path scene, output;  // no scene: a sample scene
  Quality quality = Quality::Draft;
  std::vector<std::string> lights;  // empty: the programs' default lights
  std::string camera, size;         // empty: by the scene, by the quality
  std::uint32_t spp = 0;            // 0: by the quality
  std::vector<std::string> knobs;   // as settingsOf() takes them
  bool force = false, allow_outside = false;
};

struct SweepResults {
  std::string scene;  // its name
  Quality quality = Quality::Draft;
  SweepView view;
  std::string machine;
  std::vector<Measured> settings = {};  // the base first
  double reference_seconds = 0.0;
  spec::Rgba8Image reference_shown = {};
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

// Fails if a program or the scene is missing, an option is wrong, or the base cannot be measured.
Result<SweepResults> runSweep(SweepRequest request, const SweepListener& listener,
                              const std::stop_token& stop);

}  // namespace lambent::baker
