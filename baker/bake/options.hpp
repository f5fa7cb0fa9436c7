// Holds what a bake can be asked for, and what each quality stands for. settings() is what the bundle
// records: everything that changes its bytes, and nothing else (neither the number of threads nor the
// memory).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::baker {

// Divides a bound on the error of pictures (BakeOptions::picture_bound) among its three causes: noise of
// rays, interpolation between vertices, and codes. Squares of the three add up. Rays and refinement come from
// the bound alone; codes come last and get what the others left. All functions are pure.

// Returns the rays of a sample, and the bound on refinement, with which most pictures meet theirs.
std::uint32_t raysFor(float picture_bound);
float refineBoundFor(float picture_bound);

// Returns the bound on codes with which pictures meet theirs, if codes err at eyes as they do everywhere.
float codesBound(const bundle::PictureError& without_codes, float picture_bound);
// Returns that on codes of glossy surfaces beside it: theirs are dearer for the same error.
float glossyCodesBound(float codes_bound);
// Returns a better one after codes with `bound` showed this, or nothing if they are as they should be.
std::optional<float> nextCodesBound(float bound, const bundle::PictureError& shown, float picture_bound);

enum class Quality : std::uint8_t { Draft, Standard, High };

struct BakeOptions {
  static constexpr int kMostBounces = 64;

  Quality quality = Quality::Standard;
  int order = 5;           // bands of incident light, 1..8, or 1..6 with glossy surfaces
  int glossy_order = 5;    // bands of the light that glossy surfaces reflect, 4..6
  std::uint32_t rays = 0;  // per sample over its hemisphere; 0: as the quality says
  // Bounces between surfaces. -1: as many as the error bound asks for. 0: direct light with shadows, and only
  // single scattering in volumes; any other value computes all scattering there.
  int bounces = -1;
  // Bounds the error of pictures, relative RMS, by rays, interpolation and codes together. The bake chooses
  // those of the three that are not given (raysFor(), codesBound()). 0: they are as the quality says.
  float picture_bound = 0.0f;
  float error_bound = 0.0f;  // of the coded transfer, relative RMS; 0: as picture_bound or the quality says
  float max_edge_m = 0.0f;   // edges longer than this are split; 0: no limit
  // Points of neighborhood grids along their longest, middle and shortest side, unless the scene asks for
  // others. 0: 64 x 64 x 8 for a slab, else 32 each, and a quarter as many for bodies that the scene does not
  // name.
  glm::uvec3 neighborhood_grid{0};
  // Where shadows change, edges are split until the interpolation error is less than this, relative RMS
  // against the light that arrives. 0: no edges are split; negative: as the quality says.
  float refine_bound = -1.0f;
  // True if values at vertices are those with which interpolation over the faces shows light best
  // (bake/surface_transport.cpp), and not what the vertices see. Unset: they are, except on glossy surfaces
  // of drafts.
  std::optional<bool> fit = {};
  int light_probes = 0;        // per cell, 1..32; 0: chosen by how near light comes (local_light.hpp)
  glm::uvec3 volume_grid{32};  // voxels of a volume's transfer, 1..256 along each axis
  // auto: what the scene calls for; all: also what the plan leaves out (effect_plan.hpp); or a list.
  std::string effects = "auto";
  unsigned threads = 0;            // 0: all
  std::uint64_t memory_bytes = 0;  // limit on what passes keep in memory; 0: half of the machine's

  std::size_t effectiveRays() const;
  float effectiveErrorBound() const;
  // Returns picture_bound, or what pictures of the quality are expected to stay within.
  float effectivePictureBound() const;
  // Returns the bound for glossy transfer, which takes more bytes: error_bound if it is set, else a share of
  // picture_bound, else the quality's.
  float effectiveGlossyErrorBound() const;
  // If few components of bounced light leave an error of more than this many times that bound, all components
  // are coded, to within that many times the bound. 0 switches this off: if error_bound was given, which is
  // kept at any price, and for drafts, since it may take as long as all else.
  float glossyLooseness() const;
  float effectiveRefineBound() const;
  // Returns the number of bands of the light at hits from which exit radiance is computed: 4..9, by quality,
  // or glossy_order without bounces. Except in drafts it is more than glossy_order, because exit kernels meet
  // shadow edges there that few bands cannot represent.
  int exitOrder() const;
  bool leavesNothingOut() const { return effects == "all"; }
  int zstdLevel() const;  // with which payloads are compressed
  bool fitsDiffuse() const;
  bool fitsGlossy() const;
  // Limits on refinement: the factor on the number of vertices, and the number of vertices added beyond that.
  // They are those of high quality if picture_bound is set.
  double refineGrowth() const;
  std::size_t refineAdded() const;
  // Whether edges of glossy surfaces are split. Those of drafts are not: it costs most there and shows least.
  bool refinesGlossy() const;
  std::uint64_t effectiveMemory() const;
  // Returns how many bytes of effectiveMemory() passes may keep, if so many are used and transfer of
  // so many diffuse and glossy samples is still to be computed.
  std::uint64_t memoryLeft(std::uint64_t used, std::size_t diffuse, std::size_t glossy) const;
  // Returns the bytes of a sample's transfer while it is baked: direct, bounced in three channels, and both
  // once more to be coded. Bounces of glossy samples are matrices, of more bands in two passes.
  double bytesOfTransfer(bool glossy) const;
  std::map<std::string, std::string> settings() const;
  // Returns options with those settings; names that settings() does not have are ignored. Returns nothing if
  // a setting is missing or not of its kind. `threads` and `memory_bytes` keep their defaults.
  static std::optional<BakeOptions> fromSettings(const std::map<std::string, std::string>& settings);
};

const char* qualityName(Quality quality);

// Reads the number of points or voxels along each axis, as "48" or "64x32x64". Returns nothing if the text is
// neither.
std::optional<glm::uvec3> gridSizeFrom(std::string_view text);

// The table of a bake's options: a row for each has its name, its help and the form of its words. The command
// line, the editor's panel and its command, the checks before a bake and the settings that a bundle records
// all walk this table. A new option is a member of BakeOptions and a row in
// option_rows.cpp. Errors name the option: a word is not of its kind, or a value lies outside its range.

struct OptionRow {
  std::string_view name;       // as in --name, in scripts
  std::string_view group;      // its heading in the help
  std::string_view setting{};  // in the settings that a bundle records; empty: it does not change the bytes
  std::string_view kind;       // what a word looks like, for help: "N|auto"
  std::variant<Quality BakeOptions::*, int BakeOptions::*, std::uint32_t BakeOptions::*,
               std::uint64_t BakeOptions::*, float BakeOptions::*, std::optional<bool> BakeOptions::*,
               glm::uvec3 BakeOptions::*, std::string BakeOptions::*>
      member;
  std::string help;
  struct Word {
    std::string_view word;
    double value;  // that it stands for; of a switch 1, 0 and -1 (unset)
  };
  std::vector<Word> words{};
  double least = 0.0, greatest = 0.0;  // limits of a number, or of a grid's points along each axis
  bool share = false;  // a number between 0 and 1, both excluded, that may be given in per cent too, as "2%"
  bool only_words = false;            // it takes no other words
  bool shows_default = false;         // the default is a value like others, not "auto" or "none"
  std::string_view limits{}, hint{};  // instead of "between", as "a length"; what to do
  std::string (*recorded)(const BakeOptions&) = nullptr;  // null: the word is recorded
  std::string_view former{};  // the name before 0.11, which is still understood but not shown; may be empty

  bool grid() const { return std::holds_alternative<glm::uvec3 BakeOptions::*>(member); }
  std::string word(const BakeOptions& options) const;
  // Returns what the bundle records, which most often is the word.
  std::string record(const BakeOptions& options) const;
  // Takes a word over, if it is of the option's kind and within its range.
  Result<void> put(BakeOptions& options, std::string_view word) const;
  // Takes over what word() or record() wrote. Returns false if it is not of the option's kind.
  bool read(BakeOptions& options, std::string_view word) const;
  // Checks the value itself, which may not come from a word.
  Result<void> check(const BakeOptions& options) const;
};

// Returns the rows in the order of the help.
std::span<const OptionRow> optionRows();
const OptionRow* findOption(std::string_view name);  // null if there is none

// Sets an option by its name and a word, as scripts do.
Result<void> putOption(BakeOptions& options, std::string_view name, std::string_view word);
// Checks that every option lies in its range.
Result<void> checkOptions(const BakeOptions& options);

}  // namespace lambent::baker
