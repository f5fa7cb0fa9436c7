#include "baker/sweep/measure.hpp"

#include <algorithm>
#include <cmath>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/accuracy/compare.hpp"
#include "baker/accuracy/perceptual.hpp"
#include "baker/cache/key.hpp"
#include "baker/sweep/exposure.hpp"
#include "runtime/base/atomic_file.hpp"

namespace lambent::baker {

namespace {

using nlohmann::json;

// A short bake is repeated, since its time is less certain.
constexpr int kMostRuns = 3;
constexpr double kRepeatWithinSeconds = 10.0;

Result<json> parsed(const Result<Ran>& ran, const char* program) {
  if (!ran) return failAgain(ran.error());
  json value = json::parse(ran->out, nullptr, /*exceptions=*/false);
  if (!value.is_object())
    return fail(program, "printed no JSON", "see that both programs are of one version");
  return value;
}

// Calls `read`, which takes values out of a program's JSON.
template <typename Read>
Result<void> reading(const char* program, Read&& read) {
  try {
    read();
  } catch (const json::exception& wrong) {
    return fail(program, fmt::format("printed JSON of another form ({})", wrong.what()),
                "see that both programs are of one version");
  }
  return {};
}

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

double secondsOf(const json& report) {
  double seconds = 0.0;
  for (const auto& [name, time] : stagesOf(report)) seconds += time;
  return seconds;
}

std::optional<BakeRow::Parts> bakePartsOf(const json& report) {
  BakeRow::Parts sum;
  double points = 0.0;
  for (const json& group : report.at("groups")) {
    const json& error = group.at("pictureError");
    if (error.is_null()) continue;
    const double count = error.at("points").get<double>();
    const auto add = [&](double& part, const char* name) {
      const double value = error.at(name).get<double>();
      part += count * value * value;
    };
    add(sum.noise, "samples");
    add(sum.codes, "codes");
    add(sum.interpolation, "interpolation");
    points += count;
  }
  if (!(points > 0.0)) return std::nullopt;
  return BakeRow::Parts{std::sqrt(sum.noise / points), std::sqrt(sum.codes / points),
                        std::sqrt(sum.interpolation / points)};
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

}  // namespace

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

std::string Measurer::keyOf(const Setting& setting) const {
  const std::string memory =
      setting.memory_share < 1.0 ? fmt::format("{} of the planes", setting.memory_share) : "0";
  return key("picture", fmt::format("{} {} {} {}", bakeKey(setting), json(setting.frame_words).dump(), memory,
                                    job_.view.frames));
}

std::filesystem::path Measurer::bundleOf(const Setting& setting) const {
  return job_.work / fmt::format("bake-{}.lmb.glb", shortened(bakeKey(setting)));
}

std::filesystem::path Measurer::pictureFile(const Setting& setting) const {
  return job_.work / fmt::format("picture-{}.exr", shortened(keyOf(setting)));
}

std::string Measurer::bandsOf(const Setting& setting) const {
  return job_.glossy ? fmt::format("{},{}", setting.bake.order, setting.bake.glossy_order)
                     : fmt::format("{}", setting.bake.order);
}

std::vector<std::string> Measurer::viewWords() const {
  std::vector<std::string> words = {"--size", job_.view.size};
  if (!job_.view.camera.empty()) words.insert(words.end(), {"--camera", job_.view.camera});
  for (const std::string& light : job_.view.lights) words.insert(words.end(), {"--light", light});
  return words;
}

Result<const Measurer::Reference*> Measurer::reference(const std::string& bands) {
  if (const auto found = references_.find(bands); found != references_.end()) return &found->second;
  Reference reference;
  for (const int seed : {1, 2}) {
    const std::string row_key = key("reference", fmt::format("{} {}", bands, seed));
    const std::filesystem::path file = job_.work / fmt::format("reference-{}.exr", shortened(row_key));
    std::optional<ReferenceRow> row = store_.find<ReferenceRow>(row_key);
    if (!row || !std::filesystem::exists(file)) {
      const std::string what = fmt::format(
          "reference {}, seed {}", bands.empty() ? "of light as it is" : "of " + bands + " bands", seed);
      job_.begin(what);
      std::vector<std::string> words = {
          "reference", job_.scene.string(),           "-o",     file.string(),       "--json",
          "--spp",     std::to_string(job_.view.spp), "--seed", std::to_string(seed)};
      if (!bands.empty()) words.insert(words.end(), {"--band-limit", bands});
      if (job_.allow_outside) words.push_back("--allow-outside");
      const auto view = viewWords();
      words.insert(words.end(), view.begin(), view.end());
      const auto report = parsed(runProgram(job_.programs.lambent, words, stop_), "lambent reference");
      if (!report) return failAgain(report.error());
      row.emplace();
      if (auto read = reading("lambent reference",
                              [&] {
                                row->seconds = report->at("seconds").get<double>();
                                const json& noise = report->at("standardError");
                                row->noise = noise.is_null() ? 0.0 : noise.get<double>();
                              });
          !read)
        return failAgain(read.error());
      if (auto added = store_.add(row_key, what, *row); !added) return failAgain(added.error());
    }
    auto picture = spec::readExr(file);
    if (!picture) return failAgain(picture.error());
    (seed == 1 ? reference.a : reference.b) = std::move(*picture);
    reference.row.seconds += row->seconds;
    reference.row.noise = row->noise;
  }
  reference.mean = meanOf(reference.a, reference.b);
  if (bands.empty()) exposure_ = exposureOf(reference.mean);
  return &references_.emplace(bands, std::move(reference)).first->second;
}

Result<BakeRow> Measurer::runBake(const Setting& setting) {
  std::vector<std::string> words = {"bake",      job_.scene.string(),
                                    "-o",        bundleOf(setting).string(),
                                    "--json",    "--force",
                                    "--cache",   "off",
                                    "--quality", qualityName(setting.bake.quality)};
  append(words, setting.bake_words);
  if (job_.allow_outside) words.push_back("--allow-outside");
  struct Run {
    json report;
    double seconds = 0.0, processor_seconds = 0.0;
  };
  std::vector<Run> runs;
  for (double spent = 0.0; runs.size() < kMostRuns && (runs.empty() || spent < kRepeatWithinSeconds);) {
    const auto ran = runProgram(job_.programs.lambent, words, stop_);
    auto report = parsed(ran, "lambent bake");
    if (!report) return failAgain(report.error());
    Run run{.report = std::move(*report), .processor_seconds = ran->processor_seconds};
    if (auto read = reading("lambent bake", [&] { run.seconds = secondsOf(run.report); }); !read)
      return failAgain(read.error());
    spent += run.seconds;
    runs.push_back(std::move(run));
  }
  std::ranges::sort(runs, {}, &Run::processor_seconds);
  const double processor_seconds = runs[runs.size() / 2].processor_seconds;
  std::ranges::sort(runs, {}, &Run::seconds);
  const Run& median = runs[runs.size() / 2];
  BakeRow row;
  const auto read = reading("lambent bake", [&] {
    row = {.seconds = median.seconds,
           .least_seconds = runs.front().seconds,
           .most_seconds = runs.back().seconds,
           .runs = static_cast<int>(runs.size()),
           .processor_seconds = processor_seconds,
           .stages = stagesOf(median.report),
           .bytes = median.report.at("fileBytes").get<std::uint64_t>(),
           .transfer_bytes = median.report.at("transferBytes").get<std::uint64_t>(),
           .vertices = median.report.at("vertices").get<std::uint64_t>(),
           .samples = median.report.at("samples").get<std::uint64_t>(),
           .parts = bakePartsOf(median.report)};
  });
  if (!read) return failAgain(read.error());
  return row;
}

Result<BakeRow> Measurer::bake(const Setting& setting) {
  const std::string row_key = bakeKey(setting);
  if (auto row = store_.find<BakeRow>(row_key)) return std::move(*row);
  const std::string what = "bake " + setting.name();
  job_.begin(what);
  auto row = runBake(setting);
  if (!row) return row;
  if (auto added = store_.add(row_key, what, *row); !added) return failAgain(added.error());
  return row;
}

Result<Measurer::Drawn> Measurer::draw(const Setting& setting, const Words& words,
                                       const std::filesystem::path& file, int frames) {
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
  auto ran = runProgram(job_.programs.demo, all, stop_);
  if (!ran) return failAgain(ran.error());
  auto picture = spec::readExr(file);
  if (!picture) return failAgain(picture.error());
  return Drawn{std::move(*ran), std::move(*picture)};
}

Result<MemoryRow> Measurer::memory(const Setting& setting) {
  const std::string row_key = key("memory", bakeKey(setting));
  if (auto row = store_.find<MemoryRow>(row_key)) return *row;
  const std::filesystem::path file = job_.work / "memory.exr";
  const auto drawn = draw(setting, {{"max-memory", "1"}}, file, 1);
  if (!drawn) return failAgain(drawn.error());
  std::error_code ignored;
  std::filesystem::remove(file, ignored);
  const auto report = parsed(drawn->ran, "lambent-demo");
  if (!report) return failAgain(report.error());
  MemoryRow row;
  const auto read = reading("lambent-demo", [&] {
    for (const json& bundle : report->at("streaming").at("bundles")) {
      row.least += bundle.at("bytes_resident").get<std::uint64_t>();
      row.most += bundle.at("bytes_whole").get<std::uint64_t>();
    }
  });
  if (!read) return failAgain(read.error());
  row.most = std::max(row.least, row.most);
  if (auto added = store_.add(row_key, "least memory", row); !added) return failAgain(added.error());
  return row;
}

Result<Figures> Measurer::compare(const spec::RgbaImage& picture, const Reference& reference,
                                  const std::string& subject) const {
  const auto error = comparePictures(picture, reference.a, &reference.b, subject);
  if (!error) return failAgain(error.error());
  Figures figures{.rms = error->relative_rms,
                  .percentile_99 = error->percentile_99,
                  .bias = *std::ranges::max_element(error->bias, {}, [](double b) { return std::abs(b); })};
  // d(e) = d(e²) / 2e, but never more than what all of e² drowning in noise would mean.
  const double of_square = error->relative_square_error;
  figures.rms_spread = std::min(std::sqrt(of_square), of_square / (2.0 * std::max(figures.rms, 1e-9)));
  return figures;
}

Result<PictureRow> Measurer::picture(const Setting& setting) {
  const auto as_it_is = reference("");
  if (!as_it_is) return failAgain(as_it_is.error());
  const std::string row_key = keyOf(setting);
  const std::filesystem::path file = pictureFile(setting);
  if (auto row = store_.find<PictureRow>(row_key); row && std::filesystem::exists(file))
    return std::move(*row);
  const auto of_bands = reference(bandsOf(setting));
  if (!of_bands) return failAgain(of_bands.error());

  const std::string what = "pictures of " + setting.name();
  job_.begin(what);
  Words words = setting.frame_words;
  if (setting.memory_share < 1.0) {
    const auto range = memory(setting);
    if (!range) return failAgain(range.error());
    words["max-memory"] = std::to_string(
        range->least +
        static_cast<std::uint64_t>(setting.memory_share * static_cast<double>(range->most - range->least)));
  }
  const auto shown = draw(setting, words, file, job_.view.frames);
  if (!shown) return failAgain(shown.error());
  // Only what bands carry: neither key lights nor mirrors of what the bands leave out.
  words.erase("quality");
  for (const char* option : {"keys", "window", "specular-environment", "reflection-probes"})
    words[option] = "off";
  const std::filesystem::path bands_file = job_.work / "bands.exr";
  const auto banded = draw(setting, words, bands_file, 1);
  if (!banded) return failAgain(banded.error());
  std::error_code ignored;
  std::filesystem::remove(bands_file, ignored);

  PictureRow row;
  const auto report = parsed(shown->ran, "lambent-demo");
  if (!report) return failAgain(report.error());
  const auto read = reading("lambent-demo", [&] {
    row.frame_ms = report->at("frame_ms").at("median").get<double>();
    row.slowest_ms = report->at("frame_ms").at("max").get<double>();
    row.processor_ms = report->at("frame_processor_ms").get<double>();
    row.frames = std::max(1, job_.view.frames - 1);  // the first one also waits for what is made once
    for (const json& pass : report->at("last_frame").at("passes")) {
      const json& gpu = pass.at("gpu_ms");
      row.passes.emplace_back(pass.at("name").get<std::string>(),
                              gpu.is_null() ? pass.at("cpu_ms").get<double>() : gpu.get<double>());
    }
    row.gpu_bytes = report->at("bytes_resident").get<std::uint64_t>() +
                    report->at("key_shadow_bytes").get<std::uint64_t>();
    row.key_lights = static_cast<int>(report->at("key_lights").size());
    row.renderer = report->at("renderer").get<std::string>();
  });
  if (!read) return failAgain(read.error());
  const auto lit = compare(shown->picture, **as_it_is, what);
  if (!lit) return failAgain(lit.error());
  const auto limited = compare(banded->picture, **of_bands, what);
  if (!limited) return failAgain(limited.error());
  row.as_light_is = *lit;
  row.as_bands_can = *limited;
  if (auto added = store_.add(row_key, what, row); !added) return failAgain(added.error());
  return row;
}

Result<double> Measurer::visible(const Setting& setting) {
  const auto as_it_is = reference("");
  if (!as_it_is) return failAgain(as_it_is.error());
  const auto picture = spec::readExr(pictureFile(setting));
  if (!picture) return failAgain(picture.error());
  return visibleShare(shownWith(*picture, exposure_), shownWith((*as_it_is)->mean, exposure_),
                      setting.name());
}

}  // namespace lambent::baker
