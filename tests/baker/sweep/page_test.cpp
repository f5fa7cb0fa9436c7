#include "baker/sweep/page.hpp"

#include <sstream>

#include <gtest/gtest.h>

#include "baker/sweep/advice.hpp"
#include "baker/sweep/csv.hpp"
#include "baker/sweep/page_parts.hpp"

namespace lambent::baker {
namespace {

Measured measured(const std::string& knob, const std::string& value, double bake_s, double error) {
  const std::vector<std::string> asked = {knob + "=" + value};
  Measured m{.setting = settingsOf({}, Quality::Draft, asked).value().back(),
             .key = knob + value,
             .bake = {.seconds = bake_s,
                      .least_seconds = bake_s,
                      .most_seconds = bake_s,
                      .runs = 1,
                      .processor_seconds = bake_s},
             .picture = {.frame_ms = 5.0, .slowest_ms = 6.0, .frames = 3, .renderer = "a renderer"},
             .picture_file = "/nowhere.exr"};
  m.bake.stages = {{"direct light", bake_s}};
  m.bake.bytes = 1000;
  m.bake.parts = BakeRow::Parts{0.03, 0.0, 0.04};
  m.picture.gpu_bytes = 2000;
  m.picture.as_light_is = {.rms = error, .rms_spread = 0.001, .percentile_99 = 0.2};
  m.picture.as_bands_can = {.rms = 0.5 * error, .percentile_99 = 0.1};
  return m;
}

SweepResults someResults() {
  SweepResults results{.scene = "a <scene> & \"more\"", .view = {.size = "4x4"}, .machine = "a, machine"};
  results.settings = {measured("quality", "draft", 2.0, 0.10), measured("rays", "128", 1.0, 0.20),
                      measured("rays", "512", 4.0, 0.099)};
  results.reference = {.width = 4, .height = 4, .texels = std::vector<glm::vec4>(16, glm::vec4(0.5f))};
  return results;
}

TEST(Advice, TakesTheKneeAndSaysWhy) {
  const SweepResults results = someResults();
  const Advice advice = adviceOn(costs().front(), results.settings);
  ASSERT_TRUE(advice.chosen);
  EXPECT_EQ(titleOf(results.settings[*advice.chosen]), "draft quality");
  EXPECT_EQ(advice.front, (std::vector<std::size_t>{1, 0, 2}));
  EXPECT_NE(advice.reason.find("rays 512"), std::string::npos) << advice.reason;
}

TEST(Advice, SettingsThatComeToTheSameCountOnceByTheNameOfThePreset) {
  SweepResults results = someResults();
  results.settings.insert(results.settings.begin(), measured("rays", "256", 2.0, 0.10));
  results.settings.front().key = results.settings[1].key;
  const Advice advice = adviceOn(costs().front(), results.settings);
  EXPECT_EQ(advice.competing.size(), 3u);
  EXPECT_EQ(titleOf(results.settings[*advice.chosen]), "draft quality");
}

TEST(Parts, SquaresAddUpToTheSquareOfTheError) {
  const Measured m = measured("rays", "128", 1.0, 0.2);
  const ErrorParts parts = partsOf(m);
  const double sum = *parts.noise * *parts.noise + *parts.codes * *parts.codes +
                     *parts.interpolation * *parts.interpolation + parts.beyond_bands * parts.beyond_bands;
  EXPECT_NEAR(sum, 0.2 * 0.2, 1e-12);
  EXPECT_NEAR(*parts.noise, 0.1 * 0.6, 1e-12);  // 3-4-5
}

TEST(Page, EscapesNamesAndLoadsNothing) {
  const auto page = pageOf(someResults());
  ASSERT_TRUE(page) << page.error().line();
  EXPECT_EQ(page->find("<scene>"), std::string::npos);
  EXPECT_NE(page->find("a &lt;scene&gt; &amp; &quot;more&quot;"), std::string::npos);
  for (const char* loads : {"src=\"http", "href=\"http", "@import", "url("})
    EXPECT_EQ(page->find(loads), std::string::npos) << loads;
}

TEST(Page, HasAChartForEachKnobThatWasTurned) {
  const std::string part = knobsPart(someResults());
  EXPECT_NE(part.find("<h3>Rays</h3>"), std::string::npos);
  EXPECT_EQ(part.find("<h3>Bounces</h3>"), std::string::npos);
}

TEST(Csv, EveryLineHasAsManyFieldsAsTheHead) {
  for (const std::string& table : {settingsCsv(someResults()), timesCsv(someResults())}) {
    std::istringstream lines(table);
    std::string line;
    std::getline(lines, line);
    const auto commas = [](const std::string& text) {
      std::size_t count = 0;
      bool quoted = false;
      for (const char c : text) {
        if (c == '"') quoted = !quoted;
        if (c == ',' && !quoted) ++count;
      }
      return count;
    };
    const std::size_t columns = commas(line);
    int rows = 0;
    for (; std::getline(lines, line); ++rows) EXPECT_EQ(commas(line), columns) << line;
    EXPECT_EQ(rows, 3);
  }
}

TEST(Plot, PointsThatCannotBeDrawnAreLeftOut) {
  SweepResults results = someResults();
  results.settings[1].picture.as_light_is.rms = 0.0;  // has no logarithm
  const Cost& cost = costs().front();
  const std::string svg = svgOf(plotOf(results, cost, adviceOn(cost, results.settings)), PlotPlace::Alone);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
}

}  // namespace
}  // namespace lambent::baker
