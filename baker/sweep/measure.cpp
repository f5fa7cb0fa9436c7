#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "baker/accuracy/compare.hpp"
#include "baker/cache/key.hpp"
#include "baker/sweep/sweep.hpp"
#include "runtime/base/atomic_file.hpp"
#include "runtime/spec/image.hpp"
#include "runtime/spec/rec709.hpp"

namespace lambent::baker {

namespace {

using nlohmann::json;

// A short bake is repeated, since its time is less certain.
constexpr int kMostRuns = 3;
constexpr double kRepeatWithinSeconds = 10.0;

// Calls `read`, which takes values out of the JSON that a program printed.
template <typename Read>
Result<void> readReport(const Result<Ran>& ran, const char* program, Read&& read) {
  if (!ran) return failAgain(ran.error());
  try {
    read(json::parse(ran->out));
  } catch (const json::exception& wrong) {
    return fail(program, fmt::format("printed JSON of another form ({})", wrong.what()),
                "see that both programs are of one version");
  }
  return {};
}

using NamedTimes = std::vector<std::pair<std::string, double>>;  // in the order in which they came

NamedTimes stagesOf(const json& report) {
  NamedTimes times;
  for (const json& stage : report.at("stages")) {
    const auto name = stage.at("stage").get<std::string>();
    const auto found = std::ranges::find(times, name, [](const auto& time) { return time.first; });
    if (found == times.end())
      times.emplace_back(name, stage.at("seconds").get<double>());
    else
      found->second += stage.at("seconds").get<double>();
  }
  return times;
}

// Returns what the bake says of its own error (picture_error.hpp): the RMS over groups by their points. All
// are 0 if there are no diffuse surfaces.
json errorPartsOf(const json& report) {
  double noise = 0.0, codes = 0.0, interpolation = 0.0, points = 0.0;
  for (const json& group : report.at("groups")) {
    const json& error = group.at("pictureError");
    if (error.is_null()) continue;
    const double count = error.at("points").get<double>();
    const auto add = [&](double& part, const char* name) {
      const double value = error.at(name).get<double>();
      part += count * value * value;
    };
    add(noise, "samples");
    add(codes, "codes");
    add(interpolation, "interpolation");
    points += count;
  }
  for (double* part : {&noise, &codes, &interpolation})
    *part = points > 0.0 ? std::sqrt(*part / points) : 0.0;
  return {{"noise", noise}, {"codes", codes}, {"interpolation", interpolation}};
}

// Returns the factor that brings the mean luminance of what the picture covers to a third of white. With one
// exposure for all pictures, neither an eye nor the perceptual metric sees another brightness as an error, or
// misses one.
float exposureOf(const spec::RgbaImage& reference) {
  constexpr double kMiddle = 1.0 / 3.0;
  double sum = 0.0, covered = 0.0;
  for (const glm::vec4& texel : reference.texels) {
    if (!(texel.w >= spec::kLeastCoverage)) continue;
    // Highlights are clipped on a screen and should not darken all else.
    sum += std::min(10.0, static_cast<double>(std::max(0.0f, spec::luminanceOf(texel))));
    covered += 1.0;
  }
  return sum > 0.0 ? static_cast<float>(kMiddle * covered / sum) : 1.0f;
}

spec::Rgba8Image shownWith(spec::RgbaImage picture, float exposure) {
  for (glm::vec4& texel : picture.texels) texel = glm::vec4(glm::vec3(texel) * exposure, texel.w);
  return spec::displayed(picture);
}

std::string shortened(const std::string& key) {
  return key.substr(0, 12);
}

void append(std::vector<std::string>& words, const std::map<std::string, std::string>& options) {
  for (const auto& [name, value] : options) {
    words.push_back("--" + name);
    words.push_back(value);
  }
}

// Returns how far a picture is from the reference.
Result<json> figuresOf(const std::filesystem::path& file, const Measurer::Reference& reference,
                       const std::string& subject) {
  const auto picture = spec::readExr(file);
  if (!picture) return failAgain(picture.error());
  const auto error = comparePictures(*picture, reference.a, &reference.b, subject);
  if (!error) return failAgain(error.error());
  // d(e) = d(e²) / 2e, but never more than what all of e² drowning in noise would mean.
  const double of_square = error->relative_square_error;
  const double spread =
      std::min(std::sqrt(of_square), of_square / (2.0 * std::max(error->relative_rms, 1e-9)));
  return json{{"rms", error->relative_rms},
              {"rmsSpread", spread},  // the standard error of rms, by the noise of the references
              {"percentile99", error->percentile_99},
              {"bias", *std::ranges::max_element(error->bias, {}, [](double b) { return std::abs(b); })}};
}

}  // namespace

Result<Store> Store::open(const std::filesystem::path& file) {
  Store store(file);
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return store;
  const Result<std::string> text = readTextFile(file);
  if (!text) return failAgain(text.error());
  store.cut_short_ = !text->empty() && text->back() != '\n';
  std::istringstream lines(*text);
  for (std::string words; std::getline(lines, words);) {
    json line = json::parse(words, nullptr, /*exceptions=*/false);
    if (line.is_object() && line.contains("key") && line["key"].is_string() && line.contains("row"))
      store.rows_.insert_or_assign(line["key"].get<std::string>(), std::move(line["row"]));
  }
  return store;
}

const json* Store::find(const std::string& key) const {
  const auto found = rows_.find(key);
  return found == rows_.end() ? nullptr : &found->second;
}

Result<void> Store::add(const std::string& key, const std::string& what, json row) {
  const json line = {{"key", key}, {"what", what}, {"row", row}};
  std::ofstream out(file_, std::ios::app);
  if (cut_short_) out << '\n';
  out << line.dump(-1, ' ', false, json::error_handler_t::replace) << '\n';
  out.close();
  if (!out) return fail(file_.string(), "cannot be written", "see that its folder is there and not full");
  cut_short_ = false;
  rows_.insert_or_assign(key, std::move(row));
  ++added_;
  return {};
}

Measurer::Measurer(Job job, Store& store, std::stop_token stop)
    : job_(std::move(job)), store_(store), stop_(std::move(stop)) {
  KeyMaker maker;
  maker.addText(LAMBENT_VERSION).addText(programDigest()).add(job_.scene_digest);
  bakes_ = maker.key().hex();
  // An environment map counts by what is in it, wherever it lies.
  for (const std::string& light : job_.view.lights) {
    const Result<std::string> file = readTextFile(light);
    maker.addText(file ? *file : light);
  }
  maker.addText(job_.view.camera).addText(job_.view.size).add(job_.view.spp);
  common_ = maker.key().hex();
}

std::string Measurer::key(const std::string& kind, const std::string& text) const {
  return KeyMaker().addText(kind).addText(common_).addText(text).key().hex();
}

std::string Measurer::bakeKey(const Setting& setting) const {
  return KeyMaker().addText("bake").addText(bakes_).addText(json(setting.bake.settings()).dump()).key().hex();
}

std::string Measurer::pictureKey(const Setting& setting) const {
  const std::string memory =
      setting.memory_share < 1.0 ? fmt::format("{} of the planes", setting.memory_share) : "0";
  return key("picture", fmt::format("{} {} {} {}", bakeKey(setting), json(setting.frame_words).dump(), memory,
                                    job_.view.frames));
}

std::filesystem::path Measurer::bundleOf(const Setting& setting) const {
  return job_.work / fmt::format("bake-{}.lmb.glb", shortened(bakeKey(setting)));
}

std::vector<std::string> Measurer::viewWords() const {
  std::vector<std::string> words = {"--size", job_.view.size};
  if (!job_.view.camera.empty()) words.insert(words.end(), {"--camera", job_.view.camera});
  for (const std::string& light : job_.view.lights) words.insert(words.end(), {"--light", light});
  return words;
}

Result<json> Measurer::known(const std::string& key, const std::string& what,
                             const std::filesystem::path& file, const std::function<Result<json>()>& make) {
  if (const json* row = store_.find(key); row && (file.empty() || std::filesystem::exists(file))) return *row;
  job_.begin(what);
  Result<json> row = make();
  if (!row) return row;
  if (auto added = store_.add(key, what, *row); !added) return failAgain(added.error());
  return row;
}

Result<json> Measurer::runReference(const std::string& bands, int seed, const std::filesystem::path& file) {
  std::vector<std::string> words = viewWords();
  words.insert(words.begin(), {"reference", job_.scene.string(), "-o", file.string(), "--json", "--spp",
                               std::to_string(job_.view.spp), "--seed", std::to_string(seed)});
  if (!bands.empty()) words.insert(words.end(), {"--band-limit", bands});
  if (job_.allow_outside) words.push_back("--allow-outside");
  json row;
  const auto read = readReport(runProgram(job_.programs.lambent, words, stop_), "lambent reference",
                               [&](const json& report) { row["seconds"] = report.at("seconds"); });
  if (!read) return failAgain(read.error());
  return row;
}

Result<const Measurer::Reference*> Measurer::reference(const std::string& bands) {
  if (const auto found = references_.find(bands); found != references_.end()) return &found->second;
  Reference reference;
  for (const int seed : {1, 2}) {
    const std::string row_key = key("reference", fmt::format("{} {}", bands, seed));
    const std::filesystem::path file = job_.work / fmt::format("reference-{}.exr", shortened(row_key));
    const std::string what = fmt::format(
        "reference {}, seed {}", bands.empty() ? "of light as it is" : "of " + bands + " bands", seed);
    const auto row = known(row_key, what, file, [&] { return runReference(bands, seed, file); });
    if (!row) return failAgain(row.error());
    auto picture = spec::readExr(file);
    if (!picture) return failAgain(picture.error());
    (seed == 1 ? reference.a : reference.b) = std::move(*picture);
    reference.seconds += row->at("seconds").get<double>();
  }
  spec::RgbaImage mean = reference.a;
  for (std::size_t i = 0; i < mean.texels.size(); ++i)
    mean.texels[i] = 0.5f * (reference.a.texels[i] + reference.b.texels[i]);
  if (bands.empty()) exposure_ = exposureOf(mean);
  reference.shown = shownWith(std::move(mean), exposure_);
  return &references_.emplace(bands, std::move(reference)).first->second;
}

Result<json> Measurer::runBake(const Setting& setting) {
  std::vector<std::string> words = {"bake",      job_.scene.string(),
                                    "-o",        bundleOf(setting).string(),
                                    "--json",    "--force",
                                    "--cache",   "off",
                                    "--quality", qualityName(setting.bake.quality)};
  append(words, setting.bake_words);
  if (job_.allow_outside) words.push_back("--allow-outside");
  std::vector<json> runs;
  for (double spent = 0.0; runs.size() < kMostRuns && (runs.empty() || spent < kRepeatWithinSeconds);) {
    const auto ran = runProgram(job_.programs.lambent, words, stop_);
    json run;
    const auto read = readReport(ran, "lambent bake", [&](const json& report) {
      const NamedTimes stages = stagesOf(report);
      double seconds = 0.0;
      for (const auto& [stage, taken] : stages) seconds += taken;
      spent += seconds;
      run = {{"seconds", seconds},
             {"processorSeconds", ran->processor_seconds},
             {"stages", stages},
             {"bytes", report.at("fileBytes")},
             {"transferBytes", report.at("transferBytes")},
             {"vertices", report.at("vertices")},
             {"parts", errorPartsOf(report)}};
    });
    if (!read) return failAgain(read.error());
    runs.push_back(std::move(run));
  }
  const auto sortBy = [&](const char* name) {
    std::ranges::sort(runs, {}, [name](const json& run) { return run.at(name).get<double>(); });
  };
  sortBy("processorSeconds");
  const json processor_seconds = runs[runs.size() / 2].at("processorSeconds");
  sortBy("seconds");
  json row = runs[runs.size() / 2];
  row["processorSeconds"] = processor_seconds;
  row["runs"] = runs.size();
  row["leastSeconds"] = runs.front().at("seconds");
  row["mostSeconds"] = runs.back().at("seconds");
  return row;
}

Result<Ran> Measurer::draw(const Setting& setting, const Words& words, const std::filesystem::path& file,
                           int frames) {
  // The bundle may have been removed since it was baked.
  if (!std::filesystem::exists(bundleOf(setting)))
    if (auto baked = runBake(setting); !baked) return failAgain(baked.error());
  // A whole turn of the light ends where the reference has it, and every frame has a new light.
  std::vector<std::string> all = {
      bundleOf(setting).string(), "--headless", file.string(), "--json",
      "--rotate-light",           "360",        "--frames",    std::to_string(frames)};
  const auto view = viewWords();
  all.insert(all.end(), view.begin(), view.end());
  append(all, words);
  return runProgram(job_.programs.demo, all, stop_);
}

Result<std::string> Measurer::memoryLimit(const Setting& setting, const std::filesystem::path& file) {
  std::uint64_t least = 0, most = 0;
  const auto read =
      readReport(draw(setting, {{"max-memory", "1"}}, file, 1), "lambent-demo", [&](const json& report) {
        for (const json& bundle : report.at("streaming").at("bundles")) {
          least += bundle.at("bytes_resident").get<std::uint64_t>();
          most += bundle.at("bytes_whole").get<std::uint64_t>();
        }
      });
  if (!read) return failAgain(read.error());
  const double planes = static_cast<double>(std::max(least, most) - least);
  return std::to_string(least + static_cast<std::uint64_t>(setting.memory_share * planes));
}

Result<json> Measurer::drawPictures(const Setting& setting, const std::filesystem::path& file) {
  const auto as_light_is = reference("");
  if (!as_light_is) return failAgain(as_light_is.error());
  const auto of_bands =
      reference(job_.glossy ? fmt::format("{},{}", setting.bake.order, setting.bake.glossy_order)
                            : std::to_string(setting.bake.order));
  if (!of_bands) return failAgain(of_bands.error());
  const std::filesystem::path other_file = job_.work / "other.exr";
  Words words = setting.frame_words;
  if (setting.memory_share < 1.0) {
    auto limit = memoryLimit(setting, other_file);
    if (!limit) return failAgain(limit.error());
    words["max-memory"] = std::move(*limit);
  }
  json row;
  const auto read =
      readReport(draw(setting, words, file, job_.view.frames), "lambent-demo", [&](const json& report) {
        NamedTimes passes;
        for (const json& pass : report.at("last_frame").at("passes")) {
          const json& gpu = pass.at("gpu_ms");
          passes.emplace_back(pass.at("name").get<std::string>(),
                              gpu.is_null() ? pass.at("cpu_ms").get<double>() : gpu.get<double>());
        }
        row = {
            {"frameMs", report.at("frame_ms").at("median")},
            {"slowestMs", report.at("frame_ms").at("max")},
            {"processorMs", report.at("frame_processor_ms")},
            {"frames", std::max(1, job_.view.frames - 1)},  // the first one also waits for what is made once
            {"passes", passes},
            {"gpuBytes", report.at("bytes_resident").get<std::uint64_t>() +
                             report.at("key_shadow_bytes").get<std::uint64_t>()},
            {"keyLights", report.at("key_lights").size()},
            {"renderer", report.at("renderer")}};
      });
  if (!read) return failAgain(read.error());
  const auto lit = figuresOf(file, **as_light_is, setting.name());
  if (!lit) return failAgain(lit.error());
  row["asLightIs"] = *lit;

  // Only what bands carry: neither key lights nor mirrors of what the bands leave out.
  words.erase("quality");
  for (const char* option : {"keys", "window", "specular-environment", "reflection-probes"})
    words[option] = "off";
  if (auto banded = draw(setting, words, other_file, 1); !banded) return failAgain(banded.error());
  const auto limited = figuresOf(other_file, **of_bands, setting.name());
  if (!limited) return failAgain(limited.error());
  row["asBandsCan"] = *limited;
  return row;
}

Result<Measured> Measurer::measure(const Setting& setting) {
  auto bake = known(bakeKey(setting), "bake " + setting.name(), {}, [&] { return runBake(setting); });
  if (!bake) return failAgain(bake.error());
  const auto as_light_is = reference("");
  if (!as_light_is) return failAgain(as_light_is.error());
  Measured measured{.setting = setting, .key = pictureKey(setting), .bake = std::move(*bake), .picture = {}};
  const std::filesystem::path file = job_.work / fmt::format("picture-{}.exr", shortened(measured.key));
  auto row =
      known(measured.key, "pictures of " + setting.name(), file, [&] { return drawPictures(setting, file); });
  if (!row) return failAgain(row.error());
  measured.picture = std::move(*row);
  auto picture = spec::readExr(file);
  if (!picture) return failAgain(picture.error());
  measured.shown = shownWith(std::move(*picture), exposure_);
  const auto visible = visibleShare(measured.shown, (*as_light_is)->shown, setting.name());
  if (!visible) return failAgain(visible.error());
  measured.visible = *visible;
  return measured;
}

}  // namespace lambent::baker
