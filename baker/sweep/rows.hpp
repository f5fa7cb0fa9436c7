// Rows are what a sweep measures, each written to the results file as soon as it is known. All errors are
// relative, times in the unit that the name says. A row turns to JSON and back; a row of another form is
// nothing, and is measured again.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace lambent::baker {

// Named times in the order in which they came.
using NamedTimes = std::vector<std::pair<std::string, double>>;

// These figures hold a picture against the reference.
struct Figures {
  double rms = 0.0;            // relative
  double rms_spread = 0.0;     // its standard error, by the noise of the references
  double percentile_99 = 0.0;  // of pixels
  double bias = 0.0;           // of the channel that is farthest off
};

struct ReferenceRow {
  double seconds = 0.0;
  double noise = 0.0;  // standard error of a pixel
};

struct BakeRow {
  double seconds = 0.0, least_seconds = 0.0, most_seconds = 0.0;  // the median and the spread of `runs`
  int runs = 0;
  double processor_seconds = 0.0;  // of all threads together, in the median run
  NamedTimes stages = {};          // in seconds, of the median run
  std::uint64_t bytes = 0, transfer_bytes = 0, vertices = 0, samples = 0;
  // The bake says this of its own error (picture_error.hpp); it is the RMS over groups by their points, and
  // nothing if there are no diffuse surfaces.
  struct Parts {
    double noise = 0.0, codes = 0.0, interpolation = 0.0;
  };
  std::optional<Parts> parts = {};
};

struct PictureRow {
  // The median and the slowest of `frames` under turning light, by the clock, and the median processor time.
  double frame_ms = 0.0, slowest_ms = 0.0, processor_ms = 0.0;
  int frames = 0;
  NamedTimes passes = {};  // of the last frame, in ms
  std::uint64_t gpu_bytes = 0;
  int key_lights = 0;
  std::string renderer = {};
  // Returns the time that the frame costs: of the processor if it draws, where other work disturbs the clock.
  double costMs() const;
  Figures as_light_is = {};   // default settings of the frame against light without a band limit
  Figures as_bands_can = {};  // without key lights against light of as many bands
};

// A bundle takes this on the GPU: `least` can never be left out, `most` is all of it.
struct MemoryRow {
  std::uint64_t least = 0, most = 0;
};

void to_json(nlohmann::json& json, const MemoryRow& row);
void from_json(const nlohmann::json& json, MemoryRow& row);
void to_json(nlohmann::json& json, const ReferenceRow& row);
void to_json(nlohmann::json& json, const BakeRow& row);
void to_json(nlohmann::json& json, const PictureRow& row);
void from_json(const nlohmann::json& json, ReferenceRow& row);
void from_json(const nlohmann::json& json, BakeRow& row);
void from_json(const nlohmann::json& json, PictureRow& row);

}  // namespace lambent::baker
