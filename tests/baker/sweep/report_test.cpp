#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "baker/sweep/sweep.hpp"
#include "runtime/base/atomic_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lambent::baker {
namespace {

using nlohmann::json;
using Front = std::vector<std::size_t>;

TEST(Pareto, FrontHasWhatNothingBeatsInTheOrderOfCost) {
  //                                   beaten by 2     the cheapest   the most exact   beaten by 2
  const std::vector<CostAndError> points = {{4.0, 0.30}, {1.0, 0.50}, {3.0, 0.20}, {9.0, 0.10}, {9.5, 0.20}};
  EXPECT_EQ(paretoFront(points), (Front{1, 2, 3}));
}

TEST(Pareto, WhatIsNotFiniteNeverLiesOnTheFront) {
  const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
  const std::vector<CostAndError> points = {
      {nan, 0.1}, {1.0, nan}, {infinite, 0.0}, {2.0, 0.2}, {-infinite, 0.1}};
  EXPECT_EQ(paretoFront(points), (Front{3}));
}

std::optional<std::size_t> kneeAmong(const std::vector<CostAndError>& points) {
  return kneeOf(points, paretoFront(points));
}

TEST(Pareto, KneeIsWhereNoLaterPointTakesATenthAwayForEachDoubling) {
  // 1 -> 2 s halves the error, 2 -> 4 s takes 2 % of it away, and so does 4 -> 8 s.
  EXPECT_EQ(kneeAmong({{1.0, 0.4}, {2.0, 0.2}, {4.0, 0.196}, {8.0, 0.192}}), 1u);
  // Two doublings take 20 % away, which is just more than a tenth each, or 18 %, which is less.
  EXPECT_EQ(kneeAmong({{1.0, 0.4}, {4.0, 0.32}}), 1u);
  EXPECT_EQ(kneeAmong({{1.0, 0.4}, {4.0, 0.328}}), 0u);
  // A small step lies before a large one.
  EXPECT_EQ(kneeAmong({{1.0, 0.40}, {2.0, 0.39}, {4.0, 0.10}}), 2u);
  EXPECT_FALSE(kneeAmong({}));
}

TEST(Pareto, ADifferenceWithinTheSpreadIsNoGain) {
  EXPECT_EQ(kneeAmong({{1.0, 0.40, 0.06}, {2.0, 0.35, 0.06}}), 0u);
  EXPECT_EQ(kneeAmong({{1.0, 0.40, 0.01}, {2.0, 0.35, 0.01}}), 1u);
}

Measured measured(const std::string& knob, const std::string& value, double bake_s, double error) {
  const std::vector<std::string> asked = {knob + "=" + value};
  return {.setting = settingsOf({}, Quality::Draft, asked).value().back(),
          .key = knob + value,
          .bake = {{"processorSeconds", bake_s}, {"bytes", 1000}},
          .picture = {{"frameMs", 5.0},
                      {"renderer", "a renderer"},
                      {"gpuBytes", 0},
                      {"asLightIs", {{"rms", error}, {"rmsSpread", 0.001}}}}};
}

SweepResults someResults() {
  SweepResults results{.scene = "a </script> & \"more\"",
                       .view = {.lights = {"/home/me/sky.hdr", "sun:1,2"}},
                       .machine = "a machine"};
  results.settings = {measured("quality", "draft", 2.0, 0.10), measured("rays", "128", 1.0, 0.20),
                      measured("rays", "512", 4.0, 0.099), measured("keys", "off", 2.0, 0.3)};
  return results;
}

TEST(Report, SaysWhichSettingToTakeAndWhy) {
  const json sweep = sweepJson(someResults());
  const json& cost = sweep.at("costs").at(0);
  EXPECT_EQ(cost.at("competing"), json({0, 1, 2}));  // a frame does not change how long a bake takes
  EXPECT_EQ(cost.at("front"), json({1, 0, 2}));
  EXPECT_EQ(cost.at("take"), 0);
  EXPECT_EQ(cost.at("values"), json({2.0, 1.0, 4.0, 2.0}));
  EXPECT_EQ(
      cost.at("say"),
      "Bake with draft quality. It errs by 10 % for 2 s. The next cheaper one on the front, rays 128, errs "
      "by 20 % for 1 s. Beyond it, no setting takes a tenth of the error away for each doubling of the time "
      "of a bake: the most exact one, rays 512, errs by 9.9 % for 4 s.");
  EXPECT_EQ(sweep.at("costs").at(1).at("competing"), json({0, 3}));
}

TEST(Report, ThePageHasTheFiguresAndThePicturesAndLoadsNothing) {
  const testing::TemporaryFolder folder;
  SweepResults results = someResults();
  results.reference_shown = {.width = 4, .height = 4, .texels = std::vector<std::uint8_t>(64, 128)};
  const auto index = writeReport(results, folder.path());
  ASSERT_TRUE(index) << index.error().line();
  const std::string page = readTextFile(*index).value();
  const std::string opening = "<script type=\"application/json\" id=\"sweep\">";
  const std::size_t from = page.find(opening) + opening.size(), to = page.find("</script>", from);
  json in_page = json::parse(page.substr(from, to - from));
  EXPECT_TRUE(
      in_page.at("pictures").at("reference").get<std::string>().starts_with("data:image/jpeg;base64,/9j/"));
  in_page.erase("pictures");
  EXPECT_EQ(in_page, sweepJson(results));
  EXPECT_EQ(in_page, json::parse(readTextFile(folder.path() / "sweep.json").value()));
  for (const char* loads : {"src=\"http", "href=\"http", "@import", "url("})
    EXPECT_EQ(page.find(loads), std::string::npos) << loads;
}

}  // namespace
}  // namespace lambent::baker
