#include <filesystem>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "baker/sweep/escape.hpp"
#include "baker/sweep/page_parts.hpp"
#include "baker/sweep/units.hpp"

namespace lambent::baker {

namespace {

std::string lightsText(const SweepView& view) {
  if (view.lights.empty()) return "the programs' default lights";
  std::vector<std::string> names;
  for (const std::string& light : view.lights)
    names.push_back(std::filesystem::path(light).filename().string());
  return fmt::format("{}", fmt::join(names, " + "));
}

}  // namespace

std::string methodPart(const SweepResults& results) {
  const PictureRow& base = results.settings.front().picture;
  std::string out =
      fmt::format(R"(<p>Pictures of {} under {} are compared with two path-traced references of {} samples
a pixel each, whose noise cancels. <b>Light as it is</b>: without a band limit, against the picture that a user sees.
<b>As the bands can show</b>: light cut to as many bands as the bake has, against the picture without key lights. The
error is relative RMS of linear radiance over the pixels that the scene covers, with its standard error. <b>Visible</b>
is the share of pixels that Yee’s model of the eye tells from the reference on a screen of 100 cd/m²; the noise of the
reference counts there and in the 99th percentile. One knob is turned at a time from {} quality, so good combinations
are not among the points.</p>
<p>The time of a bake is processor time of all threads together, which other work on the machine disturbs little; so is
that of a frame where a processor draws it. The table has times by the clock, too. A bake is repeated up to three times
while it has taken less than ten seconds, and its median counts. A frame is the median of {} under turning
light.</p>
<p>Measured with lambent {} on {}; frames by {}. Times of other machines differ, their ratios less.</p>
)",
                  htmlText(results.view.size), htmlText(lightsText(results.view)), results.view.spp,
                  qualityName(results.quality), base.frames, LAMBENT_VERSION, htmlText(results.machine),
                  htmlText(base.renderer));
  for (const std::string& failure : results.failures)
    out += fmt::format("<p><b>Not measured</b>: {}</p>\n", htmlText(failure));
  out += "<details><summary>All figures</summary><div class=\"scroll\"><table><tr>";
  for (const char* head :
       {"setting", "error", "±", "99th percentile", "visible", "bias", "bands’ error", "bake, processor",
        "clock", "spread", "frame, processor", "clock", "slowest", "bundle", "GPU", "vertices"})
    out += fmt::format("<th>{}</th>", head);
  out += "</tr>\n";
  for (const Measured& m : results.settings) {
    const Figures& f = m.picture.as_light_is;
    const std::string spread =
        m.bake.runs > 1 ? fmt::format("{} to {}", seconds(m.bake.least_seconds), seconds(m.bake.most_seconds))
                        : "once";
    out += m.key == results.settings.front().key ? "<tr class=\"base\">" : "<tr>";
    for (const std::string& field :
         {htmlText(titleOf(m)), percent(f.rms), percent(f.rms_spread), percent(f.percentile_99),
          percent(m.visible), fmt::format("{:+.1f} %", 100.0 * f.bias), percent(m.picture.as_bands_can.rms),
          seconds(m.bake.processor_seconds), seconds(m.bake.seconds), spread,
          milliseconds(m.picture.processor_ms), milliseconds(m.picture.frame_ms),
          milliseconds(m.picture.slowest_ms), bytes(static_cast<double>(m.bake.bytes)),
          bytes(static_cast<double>(m.picture.gpu_bytes)), std::to_string(m.bake.vertices)})
      out += fmt::format("<td>{}</td>", field);
    out += "</tr>\n";
  }
  return out + "</table></div></details>\n";
}

}  // namespace lambent::baker
