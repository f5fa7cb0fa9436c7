#include "baker/bake/options.hpp"

#include <cmath>
#include <map>
#include <set>

#include <gtest/gtest.h>

namespace lambent::baker {

namespace {

void expectBack(const BakeOptions& options, Quality quality) {
  const auto settings = options.settings();
  const auto back = BakeOptions::fromSettings(settings);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->settings(), settings);
  EXPECT_EQ(back->quality, quality);
}

TEST(BakeOptions, ComeBackFromTheSettingsThatABundleRecords) {
  for (const Quality quality : {Quality::Draft, Quality::Standard, Quality::High}) {
    BakeOptions options;
    options.quality = quality;
    expectBack(options, quality);
    const auto back = BakeOptions::fromSettings(options.settings());
    EXPECT_EQ(back->rays, 0u) << "the quality's own";
    EXPECT_EQ(back->error_bound, 0.0f);
    EXPECT_LT(back->refine_bound, 0.0f);
  }
  BakeOptions other;
  other.quality = Quality::High;
  other.order = 4, other.glossy_order = 6, other.bounces = 3, other.light_probes = 7, other.max_edge_m = 0.1f;
  other.neighborhood_grid = {64, 48, 8}, other.volume_grid = {16, 24, 32}, other.effects = "diffuse,glossy";
  expectBack(other, Quality::High);
  for (const bool fit : {false, true}) {
    other.fit = fit;
    expectBack(other, Quality::High);
  }
  other.fit = std::nullopt;
  other.rays = 777;
  expectBack(other, Quality::High);
  other.error_bound = 0.0123f, other.refine_bound = 0.0f;  // how far refinement may go still tells
  expectBack(other, Quality::High);
}

TEST(BakeOptions, DoNotComeFromSettingsThatAreNotAll) {
  const auto whole = BakeOptions().settings();
  for (const auto& [name, word] : whole) {
    auto settings = whole;
    settings.erase(name);
    EXPECT_FALSE(BakeOptions::fromSettings(settings)) << "without " << name;
    if (name == "effects") continue;  // any text, until it is asked for
    for (const std::string& wrong : {std::string("1e"), std::string()}) {
      settings[name] = wrong;
      EXPECT_FALSE(BakeOptions::fromSettings(settings)) << name << " " << wrong;
    }
  }
  auto more = whole;
  more.emplace("of another version", "5");
  EXPECT_TRUE(BakeOptions::fromSettings(more));
}

// Checks that every row of the table of options is read, written, validated and recorded.

// Returns another value for each option; a new row needs one here.
const std::map<std::string_view, std::string_view> kOthers = {{"quality", "high"},
                                                              {"order", "4"},
                                                              {"glossy-order", "6"},
                                                              {"rays", "777"},
                                                              {"bounces", "3"},
                                                              {"max-memory", "1048576"},
                                                              {"error", "0.0125"},
                                                              {"codes", "0.003"},
                                                              {"max-edge", "0.1"},
                                                              {"refine", "0.07"},
                                                              {"fit", "off"},
                                                              {"light-probes", "9"},
                                                              {"neighborhood-grid", "3x4x5"},
                                                              {"volume-grid", "6x7x8"},
                                                              {"effects", "diffuse"},
                                                              {"threads", "2"}};

TEST(OptionRows, HaveNamesOfTheirOwnAndSayWhatTheyDo) {
  std::set<std::string_view> names, settings;
  for (const OptionRow& row : optionRows()) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_TRUE(row.setting.empty() || settings.insert(row.setting).second) << row.setting;
    EXPECT_GT(row.help.size(), 20u) << row.name;
    EXPECT_FALSE(row.kind.empty()) << row.name;
  }
}

TEST(OptionRows, TakeEveryWordAndGiveItBack) {
  for (const OptionRow& row : optionRows()) {
    ASSERT_TRUE(kOthers.contains(row.name)) << row.name << " needs another value in this test";
    BakeOptions options;
    const auto before = options.settings();
    ASSERT_TRUE(row.put(options, kOthers.at(row.name))) << row.name;
    EXPECT_EQ(row.word(options), kOthers.at(row.name));
    EXPECT_TRUE(checkOptions(options)) << row.name;
    // Options that change the bytes of a bundle are among its settings; a quality is stored as the options
    // that it sets.
    const bool recorded = !row.setting.empty() || row.name == "quality";
    EXPECT_EQ(options.settings() != before, recorded) << row.name;
    if (recorded) {
      const auto back = BakeOptions::fromSettings(options.settings());
      ASSERT_TRUE(back) << row.name;
      EXPECT_EQ(row.word(*back), row.word(options)) << row.name;
    }
    BakeOptions usual;
    ASSERT_TRUE(row.read(options, row.word(usual))) << row.name << " by the word for its default";
    EXPECT_EQ(row.word(options), row.word(usual)) << row.name;
    for (const auto& [word, value] : row.words) {
      ASSERT_TRUE(row.put(options, word)) << row.name << " " << word;
      EXPECT_EQ(row.word(options), word) << row.name;
    }
  }
}

TEST(OptionRows, RefuseWordsThatAreNoneAndNameTheOption) {
  for (const OptionRow& row : optionRows()) {
    for (const std::string_view wrong : {"", "several", "1,5", "--"}) {
      BakeOptions options;
      const auto put = row.put(options, wrong);
      ASSERT_FALSE(put) << row.name << " " << wrong;
      EXPECT_EQ(put.error().subject, "--" + std::string(row.name));
      EXPECT_FALSE(put.error().hint.empty());
      EXPECT_EQ(row.word(options), row.word(BakeOptions())) << "a wrong word changes nothing";
    }
  }
  BakeOptions options;
  const auto unknown = putOption(options, "smell", "1");
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().hint.find("neighborhood-grid"), std::string::npos);
}

TEST(OptionRows, CheckRanges) {
  const std::vector<std::pair<std::string_view, std::string_view>> refused = {
      {"order", "0"},
      {"order", "9"},
      {"glossy-order", "3"},
      {"glossy-order", "7"},
      {"rays", "5"},
      {"rays", "1048577"},
      {"error", "1"},
      {"error", "nan"},
      {"error", "-0.1"},
      {"max-edge", "-1"},
      {"max-edge", "inf"},
      {"max-edge", "nan"},
      {"volume-grid", "0"},
      {"volume-grid", "8x257x8"},
      {"neighborhood-grid", "1"},
      {"neighborhood-grid", "64x64x257"},
      {"refine", "2"},
      {"refine", "0"},
      {"light-probes", "33"},
      {"light-probes", "0"},
      {"bounces", "65"},
      {"bounces", "-1"},
      // 0 stands for "auto" inside the program only.
      {"rays", "0"},
      {"error", "0"},
      {"codes", "0"},
      {"codes", "1"},
      {"threads", "0"},
      {"max-memory", "0"},
      {"max-memory", "1"},
      {"effects", "diffuse,smell"},
      {"effects", ""}};
  for (const auto& [name, word] : refused) {
    BakeOptions options;
    const auto put = putOption(options, name, word);
    ASSERT_FALSE(put) << name << " " << word;
    EXPECT_EQ(put.error().subject, "--" + std::string(name));
    EXPECT_FALSE(put.error().hint.empty()) << name << " " << word;
  }
}

TEST(OptionRows, CheckValuesThatCameFromNoWord) {
  for (const BakeOptions& wrong : {BakeOptions{.order = 9},
                                   {.rays = 5},
                                   {.error_bound = 1.0f},
                                   {.volume_grid = {8, 257, 8}},
                                   {.effects = "smell"}})
    EXPECT_FALSE(checkOptions(wrong));
  EXPECT_TRUE(checkOptions({}));
}

TEST(OptionRows, TakeSharesInPerCentToo) {
  for (const auto& [name, word, share] :
       {std::tuple{"error", "2%", 0.02f}, {"codes", "0.3%", 0.003f}, {"refine", "4%", 0.04f}}) {
    BakeOptions options, same;
    ASSERT_TRUE(putOption(options, name, word)) << name;
    ASSERT_TRUE(putOption(same, name, std::to_string(share))) << name;
    EXPECT_EQ(options.settings(), same.settings()) << "the same bytes";
  }
  BakeOptions options;
  const auto put = putOption(options, "error", "2");
  ASSERT_FALSE(put);
  EXPECT_EQ(put.error().problem, "2 is neither none nor a share between 0 and 1");
  EXPECT_EQ(put.error().hint, "write 2 % as 0.02 or 2%");
  EXPECT_FALSE(putOption(options, "error", "100%"));
  EXPECT_FALSE(putOption(options, "error", "%"));
  EXPECT_FALSE(putOption(options, "rays", "200%"));
}

TEST(OptionRows, CountMemoryInUnitsOf1024) {
  for (const auto& [word, bytes] : std::map<std::string_view, std::uint64_t>{
           {"4GB", 4ull << 30}, {"512 mib", 512ull << 20}, {"300k", 300 << 10}, {"70000", 70000}}) {
    BakeOptions options;
    ASSERT_TRUE(putOption(options, "max-memory", word)) << word;
    EXPECT_EQ(options.memory_bytes, bytes) << word;
  }
  BakeOptions options;
  for (const std::string_view wrong : {"4XB", "GB", "99999999999TB", "1.5GB"})
    EXPECT_FALSE(putOption(options, "max-memory", wrong)) << wrong;
}

// Tests how a bound on the error of pictures is divided among rays, refinement and codes.

TEST(PictureBudget, GivesCodesWhatRaysAndRefinementLeave) {
  for (const float bound : {0.01f, 0.005f}) {
    const bundle::PictureError half{.all = 0.5f * bound};
    EXPECT_NEAR(std::hypot(half.all, codesBound(half, bound)), bound, 0.06f * bound);
    EXPECT_LT(raysFor(2.0f * bound), raysFor(bound));
    EXPECT_GT(refineBoundFor(2.0f * bound), refineBoundFor(bound));
  }
}

TEST(PictureBudget, GivesCodesAnotherBoundWhereEyesSeeMoreOfThem) {
  const bundle::PictureError twice{.all = 0.0128f, .samples = 0.008f, .codes = 0.01f, .points = 1000};
  const auto less = nextCodesBound(0.005f, twice, 0.01f);
  ASSERT_TRUE(less);
  EXPECT_NEAR(*less, 0.0026f, 0.0002f);
  const bundle::PictureError fine{.all = 0.0094f, .samples = 0.008f, .codes = 0.005f, .points = 1000};
  EXPECT_FALSE(nextCodesBound(0.005f, fine, 0.01f));
}

}  // namespace

}  // namespace lambent::baker
