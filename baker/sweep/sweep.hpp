// The room baker/sweep owns `lambent accuracy`: it turns one knob at a time, bakes, draws, compares with the
// reference and says what each setting costs and how wrong it is. A request comes in; what was measured goes
// out, as sweep.json and a page, also if the sweep was stopped or a setting failed. Runs on the calling
// thread; errors name the knob or value that is not known, or the program that failed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "baker/bake/options.hpp"
#include "baker/plan/effect_plan.hpp"
#include "runtime/base/process.hpp"
#include "runtime/base/result.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::baker {

// The table of knobs has a row for each option of a bake or a frame that trades accuracy for time or bytes.
// Only knobs that the scene calls for are turned.

// SceneFacts is what the plan of a scene says about which knobs it has.
struct SceneFacts {
  bool surfaces = false, glossy = false, volumes = false, neighborhoods = false;
  bool many_bodies = false;  // bodies light and shadow each other through captures
  bool many_probes = false;  // light comes near, so it is sampled at several points
};
SceneFacts factsOf(const EffectPlan& plan);

struct Knob {
  enum class Side : std::uint8_t { Bake, Frame };

  std::string_view name;   // as in --knob; for most the option's own name
  std::string_view title;  // as a heading
  std::string_view about;  // what it trades, one sentence
  Side side = Side::Bake;
  bool SceneFacts::*called_for = nullptr;  // null: always
  std::string_view draft_values;           // coarse first, separated by commas
  std::string_view values{};               // for the other qualities; empty: the same
  std::string_view usual{};  // the value that stands for the default, for which no option is given
};

// Returns the knobs in the order of the page.
std::span<const Knob> knobs();

// A Setting is one value of one knob, all others at their base.
struct Setting {
  const Knob* knob = nullptr;
  std::string value;
  BakeOptions bake;
  std::map<std::string, std::string> bake_words;   // options of lambent bake that differ from the base
  std::map<std::string, std::string> frame_words;  // options of lambent-demo
  double memory_share = 1.0;                       // of the GPU memory that planes of transfer take

  std::string name() const;     // as a reader knows it: "draft quality", "rays 512"
  std::string command() const;  // a command line that gives this setting
  bool isPreset() const;        // a --quality of the bake
  bool isBaked() const { return knob->side == Knob::Side::Bake; }
  bool isOfKeyLights() const;  // comes to nothing where no key lights are found
};

// Returns the settings to measure at this quality, the base first. `asked` is a list of KNOB or KNOB=V1,V2;
// if it is empty, all knobs that the scene calls for are turned to their own values.
Result<std::vector<Setting>> settingsOf(const SceneFacts& facts, Quality quality,
                                        std::span<const std::string> asked);

// Keeps what a sweep measures in a file, one row a line, each appended as soon as it is measured. A sweep
// that was cut short finds them there and measures only what is missing. A row is found by a key of
// everything that it depends on, so those of another scene, program or option may lie in the same file. A
// last line that was cut short, and lines of another form, are left out.
class Store {
 public:
  // Reads the file, if it is there.
  static Result<Store> open(const std::filesystem::path& file);

  // Returns null if there is no such row.
  const nlohmann::json* find(const std::string& key) const;
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
  std::string key;               // equal for settings that come to the same
  nlohmann::json bake, picture;  // rows of the store, with the fields of sweep.json (docs/accuracy.md)
  double visible = 0.0;          // share of the pixels that an eye sees as different from the reference
  spec::Rgba8Image shown = {};   // the picture as a screen shows it
};

// Makes one measurement at a time: a reference, a bake or a picture. Each is looked up in the store first, so
// that what is known is not measured again.
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
  Result<nlohmann::json> known(const std::string& key, const std::string& what,
                               const std::filesystem::path& file,
                               const std::function<Result<nlohmann::json>()>& make);
  std::string key(const std::string& kind, const std::string& text) const;
  std::string bakeKey(const Setting& setting) const;
  std::string pictureKey(const Setting& setting) const;
  std::filesystem::path bundleOf(const Setting& setting) const;
  std::vector<std::string> viewWords() const;
  Result<nlohmann::json> runReference(const std::string& bands, int seed, const std::filesystem::path& file);
  Result<nlohmann::json> runBake(const Setting& setting);
  // Returns the bytes on the GPU with the setting's share of the planes of transfer.
  Result<std::string> memoryLimit(const Setting& setting, const std::filesystem::path& file);
  Result<nlohmann::json> drawPictures(const Setting& setting, const std::filesystem::path& file);
  Result<Ran> draw(const Setting& setting, const Words& words, const std::filesystem::path& file, int frames);

  Job job_;
  Store& store_;
  std::stop_token stop_;
  std::string bakes_, common_;                   // what keys of bakes depend on, and all other keys
  std::map<std::string, Reference> references_;  // by bands
  float exposure_ = 1.0f;                        // of all pictures, by the reference of light as it is
};

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

// Runs a whole sweep: every setting in turn, what is known already from an earlier run. The folder `output`
// holds results.jsonl (Store) and the folder `work`, for files that later measurements need. All programs run
// one after the other, since times are measured. Fails if a program or the scene is missing, an option is
// wrong, or the base cannot be measured.
Result<SweepResults> runSweep(SweepRequest request, const SweepListener& listener,
                              const std::stop_token& stop);

// Says what a sweep measured and which setting to take. Along each cost, settings lie on the Pareto front if
// no other one has at most its cost and at most its error; the one to take is the knee, where further cost
// stops to pay. All of it goes into sweep.json, and with the pictures into index.html, which draws it
// (page.html).

struct CostAndError {
  double cost = 0.0;    // in seconds or bytes; > 0
  double error = 0.0;   // relative; >= 0
  double spread = 0.0;  // how far the error may be off; a smaller difference is none
};

// Returns the indices of the front, in the order of cost. Of equal ones the first counts. Values that are not
// finite never lie on it.
std::vector<std::size_t> paretoFront(std::span<const CostAndError> points);

// Returns the cheapest point of the front from which no later one takes a tenth of the error away for each
// doubling of the cost. A later one whose error may be as large counts for nothing. Nothing for no front.
std::optional<std::size_t> kneeOf(std::span<const CostAndError> points, std::span<const std::size_t> front);

// Returns what sweep.json has (docs/accuracy.md). "costs" come in this order: time of a bake, time of a
// frame, bytes of the bundle, bytes on the GPU.
nlohmann::json sweepJson(const SweepResults& results);

// Writes both files, each whole or not at all, and returns where the page is.
Result<std::filesystem::path> writeReport(const SweepResults& results, const std::filesystem::path& folder);

}  // namespace lambent::baker
