// Keeps what a sweep measures in a file, one row a line, each appended as soon as it is measured. A sweep
// that was cut short finds them there and measures only what is missing. A row is found by a key of
// everything that it depends on, so those of another scene, program or option may lie in the same file. A
// last line that was cut short, and lines of another form, are left out. All errors are relative, times in
// the unit that the name says.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "runtime/base/result.hpp"

namespace lambent::baker {

// Named times in the order in which they came.
using NamedTimes = std::vector<std::pair<std::string, double>>;

// Each kind of row lists its fields once, as JSON names them, for writing and for reading.

// These figures hold a picture against the reference.
struct Figures {
  double rms = 0.0;            // relative
  double rms_spread = 0.0;     // its standard error, by the noise of the references
  double percentile_99 = 0.0;  // of pixels
  double bias = 0.0;           // of the channel that is farthest off

  static void fields(auto& row, auto&& visit) {
    visit("rms", row.rms), visit("rmsSpread", row.rms_spread);
    visit("percentile99", row.percentile_99), visit("bias", row.bias);
  }
};

struct ReferenceRow {
  double seconds = 0.0;

  static void fields(auto& row, auto&& visit) { visit("seconds", row.seconds); }
};

// The bake says this of its own error (picture_error.cpp): the RMS over groups by their points. All are 0 if
// there are no diffuse surfaces.
struct ErrorParts {
  double noise = 0.0, codes = 0.0, interpolation = 0.0;

  static void fields(auto& row, auto&& visit) {
    visit("noise", row.noise), visit("codes", row.codes), visit("interpolation", row.interpolation);
  }
};

struct BakeRow {
  double seconds = 0.0, least_seconds = 0.0, most_seconds = 0.0;  // the median and the spread of `runs`
  int runs = 0;
  double processor_seconds = 0.0;  // of all threads together, in the median run
  NamedTimes stages = {};          // in seconds, of the median run
  std::uint64_t bytes = 0, transfer_bytes = 0, vertices = 0;
  ErrorParts parts = {};

  static void fields(auto& row, auto&& visit) {
    visit("seconds", row.seconds), visit("leastSeconds", row.least_seconds);
    visit("mostSeconds", row.most_seconds), visit("runs", row.runs);
    visit("processorSeconds", row.processor_seconds), visit("stages", row.stages);
    visit("bytes", row.bytes), visit("transferBytes", row.transfer_bytes);
    visit("vertices", row.vertices), visit("parts", row.parts);
  }
};

struct PictureRow {
  // The median and the slowest of `frames` under turning light, by the clock, and the median processor time.
  double frame_ms = 0.0, slowest_ms = 0.0, processor_ms = 0.0;
  int frames = 0;
  NamedTimes passes = {};  // of the last frame, in ms
  std::uint64_t gpu_bytes = 0;
  int key_lights = 0;
  std::string renderer = {};
  Figures as_light_is = {};   // default settings of the frame against light without a band limit
  Figures as_bands_can = {};  // without key lights against light of as many bands

  static void fields(auto& row, auto&& visit) {
    visit("frameMs", row.frame_ms), visit("slowestMs", row.slowest_ms);
    visit("processorMs", row.processor_ms), visit("frames", row.frames), visit("passes", row.passes);
    visit("gpuBytes", row.gpu_bytes), visit("keyLights", row.key_lights), visit("renderer", row.renderer);
    visit("asLightIs", row.as_light_is), visit("asBandsCan", row.as_bands_can);
  }
};

template <typename R>
concept Row = requires(R& row) {
  R::fields(row, [](const char*, const auto&) {});
};

template <Row R>
void to_json(nlohmann::json& out, const R& row) {
  R::fields(row, [&](const char* name, const auto& field) { out[name] = field; });
}
template <Row R>
void from_json(const nlohmann::json& in, R& row) {
  R::fields(row, [&](const char* name, auto& field) { in.at(name).get_to(field); });
}

class Store {
 public:
  // Reads the file, if it is there.
  static Result<Store> open(const std::filesystem::path& file);

  // Returns nothing if there is no such row, or it has another form.
  template <Row R>
  std::optional<R> find(const std::string& key) const {
    const auto found = rows_.find(key);
    if (found == rows_.end()) return std::nullopt;
    try {
      return found->second.get<R>();
    } catch (const nlohmann::json::exception&) {
      return std::nullopt;
    }
  }
  // Adds a row, in place of an earlier one of that key. `what` says in words what it measures, for readers.
  Result<void> add(const std::string& key, const std::string& what, nlohmann::json row);
  std::size_t added() const { return added_; }

 private:
  explicit Store(std::filesystem::path file) : file_(std::move(file)) {}

  std::filesystem::path file_;
  std::map<std::string, nlohmann::json> rows_;
  std::size_t added_ = 0;
  bool cut_short_ = false;  // the file's last line has no end
};

}  // namespace lambent::baker
