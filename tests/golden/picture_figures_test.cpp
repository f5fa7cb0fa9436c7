// Holds what bakes say of their pictures against pictures: scenes that others made, the default light and
// draft quality, from the file's own camera, against the path tracer. Sharp mirror images are no part of the
// figure.
#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/support/program.hpp"
#include "tests/support/require.hpp"
#include "tests/support/shared_data.hpp"

namespace lambent {
namespace {

class PictureFigures : public testing::ProgramTest, public ::testing::WithParamInterface<const char*> {
 protected:
  // Returns the figures that a command prints.
  nlohmann::json figures(const std::vector<std::string>& words) const {
    const auto outcome = run(LAMBENT_PROGRAM, words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out, nullptr, /*allow_exceptions=*/false);
  }
};

}  // namespace

TEST_P(PictureFigures, AreAtLeastTwoThirdsOfWhatCompareFinds) {
  const std::filesystem::path scene = testing::sharedFile(GetParam());
  LAMBENT_NEEDS_SHARED(scene);
  const std::string bundle = (folder / "scene.lmb.glb").string(), picture = (folder / "picture.exr").string();
  const std::array<std::string, 2> references = {(folder / "1.exr").string(), (folder / "2.exr").string()};
  const nlohmann::json baked =
      figures({"bake", scene.string(), "-o", bundle, "--quality", "draft", "--cache", "off", "--json"});
  const auto shown = run(LAMBENT_DEMO, {bundle, "--size", "100x75", "--headless", picture});
  if (testing::lacksDevice(shown)) LAMBENT_LACKS("gl", shown.err);
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  for (std::size_t i = 0; i < 2; ++i)
    figures({"reference", scene.string(), "-o", references[i], "--size", "100x75", "--spp", "64", "--seed",
             std::to_string(i + 1), "--json"});
  const nlohmann::json compared =
      figures({"compare", picture, references[0], "--reference2", references[1], "--json"});
  double said = 0.0;
  for (const nlohmann::json& group : baked.at("groups"))
    if (const auto error = group.find("pictureError"); error != group.end() && error->is_object())
      said = std::max(said, error->at("all").get<double>());
  const double is = compared.at("relativeRms");
  EXPECT_GT(said, 0.0);
  EXPECT_LT(is, 1.5 * said);
  // Key lights are shaded per pixel, so a bake, which counts all of the sky as bands, may say too much.
  RecordProperty("said", std::to_string(said));
  RecordProperty("is", std::to_string(is));
}

INSTANTIATE_TEST_SUITE_P(OfOthersScenes, PictureFigures,
                         ::testing::Values("found/bounces-stop-after-one/house_open_window.glb",
                                           "found/small-object-on-large-ground/ground_200m.glb",
                                           "found/lamps-only-room-not-refined/panel.glb",
                                           "found/gltf-sun-shadow/room_sun.glb",
                                           "found/window-of-transmission/room.glb",
                                           "models/cornell_box_24.glb", "models/max_planck.glb",
                                           "models/rocker_arm.glb", "models/spot.glb",
                                           "models/stanford_bunny.glb"),
                         [](const auto& one) {
                           std::string name = std::filesystem::path(one.param).stem().string();
                           for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '0';
                           return name;
                         });

}  // namespace lambent
