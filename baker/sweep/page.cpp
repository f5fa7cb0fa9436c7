#include "baker/sweep/page.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/sweep/escape.hpp"
#include "baker/sweep/exposure.hpp"
#include "baker/sweep/jpeg.hpp"
#include "baker/sweep/page_parts.hpp"
#include "baker/sweep/units.hpp"
#include "lambent_sweep_embedded.hpp"

namespace lambent::baker {

namespace {

using nlohmann::json;

constexpr const char* kReference = "reference";

// Pictures by their ids, in the order of lists.
struct Pictures {
  json by_id = json::object();
  std::vector<std::pair<std::string, std::string>> names;  // id and title
};

Result<void> add(Pictures& pictures, const std::string& id, const std::string& title,
                 const std::string& about, const spec::Rgba8Image& shown) {
  auto uri = jpegUri(shown);
  if (!uri) return failAgain(std::move(uri.error()));
  pictures.by_id[id] = {{"uri", std::move(*uri)}, {"about", about}};
  pictures.names.emplace_back(id, title);
  return {};
}

Result<Pictures> picturesOf(const SweepResults& results) {
  Pictures pictures;
  if (auto added = add(pictures, kReference, "path-traced reference",
                       fmt::format("path-traced in {}", seconds(results.reference_row.seconds)),
                       shownWith(results.reference, results.exposure));
      !added)
    return failAgain(added.error());
  for (const Measured& m : results.settings) {
    if (pictures.by_id.contains(m.key)) continue;
    const auto picture = spec::readExr(m.picture_file);
    if (!picture) continue;
    const Figures& f = m.picture.as_light_is;
    const std::string about =
        fmt::format("error {}, {} of the pixels visibly different; bake {}, frame {}, bundle {}",
                    percent(f.rms), percent(m.visible), seconds(m.bake.processor_seconds),
                    milliseconds(m.picture.costMs()), bytes(static_cast<double>(m.bake.bytes)));
    if (auto added = add(pictures, m.key, titleOf(m), about, shownWith(*picture, results.exposure)); !added)
      return failAgain(added.error());
  }
  return pictures;
}

std::string options(const Pictures& pictures, const std::string& chosen) {
  std::string out;
  for (const auto& [id, title] : pictures.names)
    out += fmt::format("<option value=\"{}\"{}>{}</option>", htmlText(id), id == chosen ? " selected" : "",
                       htmlText(title));
  return out;
}

// Compares the base, which is what a user has, with the reference.
std::string lookPart(const SweepResults& results, const Pictures& pictures) {
  const std::string& base = results.settings.front().key;
  if (!pictures.by_id.contains(base)) return {};
  const auto text = [&](const std::string& id, const char* field) {
    return htmlText(pictures.by_id[id][field].get<std::string>());
  };
  return fmt::format(
      "<div class=\"card\" id=\"look\">\n<div class=\"pick\"><select id=\"left\" aria-label=\"left "
      "picture\">{}</select>"
      "<label><input type=\"checkbox\" id=\"difference\"> difference, five times as bright</label>"
      "<select id=\"right\" aria-label=\"right picture\">{}</select></div>\n"
      "<div class=\"compare\"><img class=\"right\" alt=\"right picture\" src=\"{}\"><img class=\"left\" "
      "alt=\"left picture\" "
      "src=\"{}\"><span class=\"grip\">↔</span><input type=\"range\" min=\"0\" max=\"100\" value=\"50\" "
      "step=\"0.1\" "
      "aria-label=\"how much of the left picture shows\"></div>\n"
      "<div class=\"pick faint\"><span id=\"about-left\">{}</span><span "
      "id=\"about-right\">{}</span></div>\n</div>\n",
      options(pictures, base), options(pictures, kReference), text(kReference, "uri"), text(base, "uri"),
      text(base, "about"), text(kReference, "about"));
}

// JSON that cannot end the element it stands in.
std::string scriptSafe(const json& value) {
  std::string out;
  for (const char c : value.dump(-1, ' ', false, json::error_handler_t::replace)) {
    if (c == '<')
      out += "\\u003c";
    else
      out += c;
  }
  return out;
}

}  // namespace

Result<std::string> pageOf(const SweepResults& results) {
  const auto pictures = picturesOf(results);
  if (!pictures) return failAgain(pictures.error());
  const std::string scene = htmlText(results.scene);
  std::string page = fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>What accuracy costs: "
      "{}</title>\n"
      "<style>\n{}{}</style>\n</head>\n<body>\n<main>\n<h1>What accuracy costs: {}</h1>\n",
      scene, embedded::lambent_sweep::find("page.css"), embedded::lambent_sweep::find("plot.css"), scene);
  page +=
      "<p>Every knob that trades accuracy for time or bytes was turned, one at a time, and each picture "
      "compared with a "
      "path-traced one. Left and low is good.</p>\n";
  page += answersPart(results);
  page +=
      "<h2>Error against cost</h2>\n<p>Each point is a setting. The line is the Pareto front: nothing that "
      "was measured is "
      "both cheaper and more exact. The ring is the setting to take, where more cost begins to pay little. "
      "Click a point to "
      "see its picture.</p>\n";
  page += plotsPart(results);
  page += "<h2>See for yourself</h2>\n<p>Drag across the picture.</p>\n" + lookPart(results, *pictures);
  page += fmt::format(
      "<h2>Knob by knob</h2>\n<p>All others stay as they are at {} quality, whose value is bold. Below each "
      "value stand time "
      "and bytes.</p>\n",
      qualityName(results.quality));
  page += knobsPart(results);
  page += "<h2>Where it comes from</h2>\n" + causesPart(results);
  page += "<h2>How it was measured</h2>\n" + methodPart(results);
  page += fmt::format(
      "</main>\n<script type=\"application/json\" "
      "id=\"pictures\">{}</script>\n<script>\n{}</script>\n</body>\n</html>\n",
      scriptSafe(pictures->by_id), embedded::lambent_sweep::find("page.js"));
  return page;
}

}  // namespace lambent::baker
