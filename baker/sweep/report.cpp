#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "baker/import/openimageio/module.hpp"
#include "baker/plan/counted.hpp"
#include "baker/sweep/sweep.hpp"
#include "lambent_sweep_embedded.hpp"
#include "runtime/base/atomic_file.hpp"

namespace lambent::baker {

namespace {

using nlohmann::json;

// A step along the front pays while each doubling of the cost takes at least this share of the error away.
constexpr double kLeastGain = 0.1;

// Returns the time that the frame costs: of the processor if it draws, where other work disturbs the clock.
double frameSeconds(const Measured& m) {
  const auto renderer = m.picture.at("renderer").get<std::string>();
  const bool on_processor =
      renderer.find("llvmpipe") != std::string::npos || renderer.find("softpipe") != std::string::npos;
  return 0.001 * m.picture.at(on_processor ? "processorMs" : "frameMs").get<double>();
}

struct Cost {
  const char* id;
  const char* title;  // of an axis
  const char* words;  // within a sentence
  const char* verb;   // how its setting is used
  const char* unit;   // s or B
  Knob::Side side;    // only knobs of this side change it
  double (*of)(const Measured&);
};

constexpr std::array kCosts = {
    Cost{"bake-time", "processor time of a bake, all threads together", "time of a bake", "Bake with", "s",
         Knob::Side::Bake, [](const Measured& m) { return m.bake.at("processorSeconds").get<double>(); }},
    Cost{"frame-time", "time of a frame under turning light", "time of a frame", "Draw with", "s",
         Knob::Side::Frame, frameSeconds},
    Cost{"bundle-bytes", "bytes of the bundle", "bytes of the bundle", "Bake with", "B", Knob::Side::Bake,
         [](const Measured& m) { return m.bake.at("bytes").get<double>(); }},
    Cost{"gpu-bytes", "bytes on the GPU", "bytes on the GPU", "Draw with", "B", Knob::Side::Frame,
         [](const Measured& m) { return m.picture.at("gpuBytes").get<double>(); }}};

// Returns the quantity with three figures: "41 s", "312 kB".
std::string quantityText(double value, const Cost& cost) {
  struct Unit {
    double below, size;
    const char* name;
  };
  constexpr double kNoLimit = std::numeric_limits<double>::infinity();
  static constexpr std::array kTimes = {Unit{1.0, 1e-3, "ms"}, Unit{120.0, 1.0, "s"},
                                        Unit{7200.0, 60.0, "min"}, Unit{kNoLimit, 3600.0, "h"}};
  static constexpr std::array kBytes = {Unit{1e3, 1.0, "B"}, Unit{1e6, 1e3, "kB"}, Unit{1e9, 1e6, "MB"},
                                        Unit{kNoLimit, 1e9, "GB"}};
  const auto& units = *cost.unit == 's' ? kTimes : kBytes;
  const Unit& unit = *std::ranges::find_if(units, [&](const Unit& u) { return value < u.below; });
  const double size = value / unit.size;
  return size >= 100.0 ? fmt::format("{:.0f} {}", size, unit.name)
                       : fmt::format("{:.3g} {}", size, unit.name);
}

std::string errorText(double share) {
  constexpr double kOnePercent = 0.00995;
  return percentText(share, share < kOnePercent ? 2 : 1);
}

// Returns the settings that compete: those whose knob can change the cost, equal ones once. Of these, a
// preset has the better name.
std::vector<std::size_t> competing(const Cost& cost, std::span<const Measured> settings) {
  std::vector<std::size_t> list;
  std::set<std::string> seen;
  for (const bool presets : {true, false})
    for (std::size_t i = 0; i < settings.size(); ++i) {
      const Measured& m = settings[i];
      const bool changes = m.setting.knob->side == cost.side || m.key == settings.front().key;
      if (changes && m.setting.isPreset() == presets && seen.insert(m.key).second) list.push_back(i);
    }
  return list;
}

json costJson(const Cost& cost, std::span<const Measured> settings) {
  const std::vector<std::size_t> list = competing(cost, settings);
  std::vector<CostAndError> points;
  for (const std::size_t i : list) {
    const json& figures = settings[i].picture.at("asLightIs");
    points.push_back(
        {cost.of(settings[i]), figures.at("rms").get<double>(), figures.at("rmsSpread").get<double>()});
  }
  json out = {{"id", cost.id},          {"title", cost.title}, {"words", cost.words},
              {"unit", cost.unit},      {"competing", list},   {"values", json::array()},
              {"front", json::array()}, {"take", nullptr},     {"say", ""}};
  for (const Measured& m : settings) out["values"].push_back(cost.of(m));
  const std::vector<std::size_t> front = paretoFront(points);
  for (const std::size_t i : front) out["front"].push_back(list[i]);
  const std::optional<std::size_t> knee = kneeOf(points, front);
  if (!knee) return out;

  const auto named = [&](std::size_t i) { return settings[list[i]].setting.name(); };
  const auto errs = [&](std::size_t i) {
    return fmt::format("errs by {} for {}", errorText(points[i].error), quantityText(points[i].cost, cost));
  };
  std::string say = fmt::format("{} {}. It {}.", cost.verb, named(*knee), errs(*knee));
  const auto place = std::ranges::find(front, *knee);
  if (place != front.begin())
    say +=
        fmt::format(" The next cheaper one on the front, {}, {}.", named(*(place - 1)), errs(*(place - 1)));
  else if (front.size() > 1)
    say += " It is the cheapest.";
  if (place + 1 == front.end())
    say += " Nothing that was measured errs less.";
  else
    say += fmt::format(
        " Beyond it, no setting takes a tenth of the error away for each doubling of the {}: the most exact "
        "one, {}, {}.",
        cost.words, named(front.back()), errs(front.back()));
  out["take"] = list[*knee];
  out["say"] = say;
  return out;
}

std::string base64(std::span<const std::uint8_t> bytes) {
  static constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) word = word << 8 | (i + k < bytes.size() ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      out += i + k <= bytes.size() ? kDigits[word >> (18 - 6 * k) & 63u] : '=';
  }
  return out;
}

// Returns a data URI of the picture as JPEG, since twenty lossless ones would be too many bytes for a page.
Result<std::string> jpegUri(const spec::Rgba8Image& picture) {
  constexpr int kQuality = 88;
  const auto writer = openImageIo();
  if (!writer) return failAgain(writer.error());
  Pixels rgb{.width = picture.width, .height = picture.height, .channels = 3, .values = {}};
  for (std::size_t i = 0; i < picture.texels.size(); ++i)
    if (i % 4 != 3) rgb.values.push_back(picture.texels[i]);
  const auto bytes = (*writer)->encodeJpeg(rgb, kQuality, "a picture");
  if (!bytes) return failAgain(bytes.error());
  return "data:image/jpeg;base64," + base64(*bytes);
}

// Returns the pictures by the keys of their settings.
Result<json> picturesOf(const SweepResults& results) {
  json pictures = json::object();
  const auto add = [&](const std::string& key, const spec::Rgba8Image& shown) -> Result<void> {
    if (pictures.contains(key) || shown.texels.empty()) return {};
    auto uri = jpegUri(shown);
    if (!uri) return failAgain(std::move(uri.error()));
    pictures[key] = std::move(*uri);
    return {};
  };
  if (auto added = add("reference", results.reference_shown); !added) return failAgain(added.error());
  for (const Measured& m : results.settings)
    if (auto added = add(m.key, m.shown); !added) return failAgain(added.error());
  return pictures;
}

Result<void> writeText(const std::filesystem::path& path, const std::string& text) {
  auto file = AtomicFile::open(path);
  if (!file) return failAgain(std::move(file.error()));
  if (auto done = file->write(text); !done) return done;
  return file->commit();
}

}  // namespace

std::vector<std::size_t> paretoFront(std::span<const CostAndError> points) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (std::isfinite(points[i].cost) && std::isfinite(points[i].error)) order.push_back(i);
  std::ranges::stable_sort(order, {},
                           [&](std::size_t i) { return std::pair(points[i].cost, points[i].error); });
  std::vector<std::size_t> front;
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t i : order) {
    if (!(points[i].error < least)) continue;
    least = points[i].error;
    front.push_back(i);
  }
  return front;
}

std::optional<std::size_t> kneeOf(std::span<const CostAndError> points, std::span<const std::size_t> front) {
  const auto pays = [&](const CostAndError& from, const CostAndError& to) {
    if (!(from.error - to.error > std::max(from.spread, to.spread)) || !(from.cost > 0.0)) return false;
    return std::pow(to.error / from.error, 1.0 / std::log2(to.cost / from.cost)) <= 1.0 - kLeastGain;
  };
  for (std::size_t i = 0; i < front.size(); ++i)
    if (std::ranges::none_of(front.subspan(i + 1),
                             [&](std::size_t later) { return pays(points[front[i]], points[later]); }))
      return front[i];
  return std::nullopt;
}

json sweepJson(const SweepResults& results) {
  json rows = json::array(), turned = json::array(), costs = json::array(), lights = json::array();
  for (const Knob& knob : knobs())
    if (std::ranges::any_of(results.settings, [&](const Measured& m) { return m.setting.knob == &knob; }))
      turned.push_back({{"name", knob.name},
                        {"title", knob.title},
                        {"about", knob.about},
                        {"of", knob.side == Knob::Side::Bake ? "bake" : "frame"}});
  for (const Measured& m : results.settings)
    rows.push_back({{"name", m.setting.name()},
                    {"knob", m.setting.knob->name},
                    {"value", m.setting.value},
                    {"command", m.setting.command()},
                    {"key", m.key},
                    {"bake", m.bake},
                    {"picture", m.picture},
                    {"visible", m.visible}});
  for (const Cost& cost : kCosts) costs.push_back(costJson(cost, results.settings));
  for (const std::string& light : results.view.lights)  // a page may be shown to others, paths are private
    lights.push_back(std::filesystem::path(light).filename().string());
  return {{"lambent", LAMBENT_VERSION},
          {"scene", results.scene},
          {"quality", qualityName(results.quality)},
          {"machine", results.machine},
          {"view",
           {{"lights", lights},
            {"camera", results.view.camera},
            {"size", results.view.size},
            {"spp", results.view.spp},
            {"frames", results.view.frames}}},
          {"referenceSeconds", results.reference_seconds},
          {"knobs", turned},
          {"rows", rows},
          {"costs", costs},
          {"failures", results.failures},
          {"asked", results.asked},
          {"rowsMeasured", results.rows_measured},
          {"stopped", results.stopped}};
}

Result<std::filesystem::path> writeReport(const SweepResults& results, const std::filesystem::path& folder) {
  json sweep = sweepJson(results);
  constexpr auto kReplace = json::error_handler_t::replace;
  if (auto done = writeText(folder / "sweep.json", sweep.dump(2, ' ', false, kReplace) + "\n"); !done)
    return failAgain(std::move(done.error()));
  auto pictures = picturesOf(results);
  if (!pictures) return failAgain(std::move(pictures.error()));
  sweep["pictures"] = std::move(*pictures);
  // In a script, "<" could end the element.
  std::string data;
  for (const char c : sweep.dump(-1, ' ', false, kReplace)) data += c == '<' ? "\\u003c" : std::string(1, c);
  constexpr std::string_view kPlace = ">{{SWEEP}}<";
  std::string page(embedded::lambent_sweep::find("page.html"));
  page.replace(page.find(kPlace) + 1, kPlace.size() - 2, data);
  const std::filesystem::path index = folder / "index.html";
  if (auto done = writeText(index, page); !done) return failAgain(std::move(done.error()));
  return index;
}

}  // namespace lambent::baker
