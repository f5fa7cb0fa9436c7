// Checks that every row of the table of options is read, written, validated and recorded.
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "baker/bake/options.hpp"

namespace lambent::baker {
namespace {

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

}  // namespace
}  // namespace lambent::baker
