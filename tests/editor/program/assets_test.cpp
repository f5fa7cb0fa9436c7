#include "editor/session/assets.hpp"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <string>
#include <utility>

#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "runtime/spec/image.hpp"
#include "tests/support/eventually.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lambent::editor {
namespace {

// Tests what the Assets panel lists, and the pictures that it shows.

namespace fs = std::filesystem;

class Assets : public ::testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& text = "x") const {
    std::ofstream(folder.path() / name) << text;
    return folder.path() / name;
  }
  fs::path writeMap(const std::string& name) const {
    const fs::path file = folder.path() / name;
    EXPECT_TRUE(spec::writeHdr(file, {8, 4, std::vector<glm::vec3>(32, glm::vec3(2.0f, 1.0f, 0.5f))}));
    return file;
  }
  static spec::Rgba8Image plain(std::uint8_t value) {
    return {192, 108, std::vector<std::uint8_t>(std::size_t{4} * 192 * 108, value)};
  }

  lambent::testing::TemporaryFolder folder;
};

TEST_F(Assets, OfAFolderAreListedByNameWithTheirKinds) {
  for (const char* name : {"b.glb", "a.gltf", "b.lmb.glb", "sky.hdr", "lamp.exr", "notes.txt", "photo.png"})
    write(name);
  write("hall.json", R"({"lambent_world": 1, "bundles": []})");
  write("other.json", R"({"name": "no world"})");
  fs::create_directory(folder.path() / "deeper.glb");
  std::vector<std::pair<std::string, AssetKind>> found;
  for (const Asset& asset : listAssets(folder.path())) {
    found.emplace_back(asset.file.filename().string(), asset.kind);
    EXPECT_EQ(asset.bytes, fs::file_size(asset.file));
  }
  const std::vector<std::pair<std::string, AssetKind>> expected = {{"a.gltf", AssetKind::Scene},
                                                                   {"b.glb", AssetKind::Scene},
                                                                   {"b.lmb.glb", AssetKind::Bundle},
                                                                   {"hall.json", AssetKind::World},
                                                                   {"lamp.exr", AssetKind::EnvironmentMap},
                                                                   {"sky.hdr", AssetKind::EnvironmentMap}};
  EXPECT_EQ(found, expected);
  EXPECT_EQ(listAssets(folder.path(), AssetKind::EnvironmentMap).size(), 2u);
  EXPECT_TRUE(listAssets(folder.path() / "missing").empty());
}

TEST_F(Assets, AreFoundByPartsOfTheirNameAndKind) {
  const Asset sky{.file = "/maps/Evening_Sky.hdr", .kind = AssetKind::EnvironmentMap};
  for (const char* search : {"", "sky", "evening map", "SKY hdr"})
    EXPECT_TRUE(matches(sky, search)) << search;
  for (const char* search : {"morning", "sky scene", "maps/"}) EXPECT_FALSE(matches(sky, search)) << search;
}

TEST_F(Assets, AreNamedWithoutWhatTellsTheirKind) {
  for (const char* name : {"hall.world.json", "hall.json", "hall.lmb.glb", "hall.glb", "hall.hdr"})
    EXPECT_EQ(nameOf(*assetAt(write(name))), "hall") << name;
  EXPECT_EQ(nameOf(*assetAt(write("hall.lmb.hdr"))), "hall.lmb");
}

TEST_F(Assets, PicturesOfAFileThatChangedAreForgotten) {
  PictureCache cache(folder.path() / "pictures");
  const fs::path file = write("a.glb");
  const Asset before = *assetAt(file);
  cache.put(before, plain(7));
  ASSERT_TRUE(cache.find(before));
  EXPECT_EQ(cache.find(before)->texels, plain(7).texels);
  write("a.glb", "longer");
  EXPECT_FALSE(cache.find(*assetAt(file))) << "another size";
  Asset later = before;
  later.written += std::chrono::seconds(1);
  EXPECT_FALSE(cache.find(later)) << "another time";
}

TEST_F(Assets, PicturesKeepWithinTheirBytesAndTheLatestStay) {
  constexpr std::uint64_t kBytes = 1u << 20;  // about 12 of these pictures
  const fs::path pictures = folder.path() / "pictures";
  PictureCache cache(pictures, kBytes);
  const auto asset = [](int i) { return Asset{.file = "/scenes/" + std::to_string(i) + ".glb"}; };
  std::uint32_t number = 1;
  const auto unlike = [&] {  // a picture that does not compress
    spec::Rgba8Image picture = plain(0);
    for (std::uint8_t& texel : picture.texels)
      texel = static_cast<std::uint8_t>((number = number * 1664525u + 1013904223u) >> 24);
    return picture;
  };
  for (int i = 0; i < 40; ++i) cache.put(asset(i), unlike());
  std::uint64_t bytes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(pictures))
    if (entry.is_regular_file()) bytes += entry.file_size();
  EXPECT_LE(bytes, kBytes);
  EXPECT_GT(bytes, kBytes / 2);
  EXPECT_FALSE(cache.find(asset(0)));
  EXPECT_TRUE(cache.find(asset(39)));
}

// Waits until the pictures that were asked for have come.
void settle(AssetPictures& pictures) {
  ASSERT_TRUE(lambent::testing::eventually([&] {
    pictures.update();
    return !pictures.busy();
  }));
}

TEST_F(Assets, PicturesOfMapsAreMadeAndThoseOfScenesAreTheViews) {
  const Asset map = *assetAt(writeMap("sky.hdr")), broken = *assetAt(write("broken.hdr")),
              scene = *assetAt(write("a.glb"));
  {
    AssetPictures pictures(folder.path() / "pictures");
    for (const Asset& asset : {map, broken, scene}) pictures.of(asset);
    settle(pictures);
    EXPECT_FALSE(pictures.of(map).image.texels.empty());
    EXPECT_NE(pictures.of(broken).error, "");
    EXPECT_TRUE(pictures.of(scene).image.texels.empty()) << "it was never shown";
    pictures.keep(scene, plain(9));
    EXPECT_EQ(pictures.of(scene).image.texels, plain(9).texels);
  }
  AssetPictures again(folder.path() / "pictures");
  again.of(scene);
  settle(again);
  EXPECT_EQ(again.of(scene).image.texels, plain(9).texels) << "it is kept between starts";
  write("a.glb", "another scene");
  again.of(*assetAt(scene.file));
  settle(again);
  EXPECT_TRUE(again.of(*assetAt(scene.file)).image.texels.empty()) << "the file has changed";
}

TEST_F(Assets, SceneThatWasNeverShownHasThePictureOfItsNameBesideIt) {
  const auto blue = [](std::uint32_t width, std::uint32_t height) {
    spec::Rgba8Image image{width, height, {}};
    for (std::uint32_t i = 0; i < width * height; ++i)
      image.texels.insert(image.texels.end(), {10, 20, 200, 255});
    return image;
  };
  const Asset shown = *assetAt(write("shown.glb")), textured = *assetAt(write("textured.glb"));
  ASSERT_TRUE(spec::writePng(folder.path() / "shown.png", blue(32, 18)));
  ASSERT_TRUE(spec::writePng(folder.path() / "textured.png", blue(32, 32)));
  AssetPictures pictures({});
  for (const Asset& asset : {shown, textured}) pictures.of(asset);
  settle(pictures);
  const std::vector<std::uint8_t>& texels = pictures.of(shown).image.texels;
  ASSERT_FALSE(texels.empty());
  EXPECT_EQ(std::vector(texels.begin(), texels.begin() + 4), (std::vector<std::uint8_t>{10, 20, 200, 255}));
  EXPECT_TRUE(pictures.of(textured).image.texels.empty()) << "a texture of that name";
}

TEST_F(Assets, PicturesInMemoryAreLimitedAndComeAgain) {
  AssetPictures pictures({});
  const Asset map = *assetAt(writeMap("sky.hdr"));
  pictures.of(map);
  settle(pictures);
  for (int i = 0; i < 600; ++i)
    pictures.of({.file = "/scenes/" + std::to_string(i) + ".glb", .kind = AssetKind::Scene});
  settle(pictures);
  EXPECT_LE(pictures.pictures().size(), 512u);
  pictures.of(map);
  settle(pictures);
  EXPECT_FALSE(pictures.of(map).image.texels.empty());
}

TEST_F(Assets, PictureOfAViewIsItsMiddle) {
  // A view that is twice as wide as high: its left and right ends are cut.
  spec::Rgba8Image view{400, 200, {}};
  for (std::uint32_t y = 0; y < 200; ++y)
    for (std::uint32_t x = 0; x < 400; ++x) {
      const bool end = x < 20 || x >= 380;
      for (const int value : {end ? 255 : 40, y < 100 ? 200 : 0, 90, 0})
        view.texels.push_back(static_cast<std::uint8_t>(value));
    }
  const spec::Rgba8Image small = smallPictureOf(view);
  const auto texel = [&](std::uint32_t x, std::uint32_t y) {
    const auto at = small.texels.begin() + 4 * (std::ptrdiff_t{y} * small.width + x);
    return std::vector<int>(at, at + 4);
  };
  EXPECT_EQ(texel(0, 0), (std::vector{40, 200, 90, 255}));
  EXPECT_EQ(texel(small.width - 1, small.height - 1), (std::vector{40, 0, 90, 255}));
}

// Tests which part of the view becomes the small picture of a scene.

// A square view of 90 degrees from 10 m: a metre at the origin's depth has 40 of 800 pixels.
spec::View view() {
  return {.view_from_world = glm::lookAt(glm::vec3(0, 0, 10), glm::vec3(0), glm::vec3(0, 1, 0)),
          .clip_from_view = glm::perspective(glm::radians(90.0f), 1.0f, 0.1f, 100.0f),
          .eye_ws = {0, 0, 10}};
}
constexpr spec::Size kViewSize{800, 800};

scene::Box flatBox(glm::vec2 center, glm::vec2 half) {
  return {.min = glm::vec3(center - half, 0.0f), .max = glm::vec3(center + half, 0.0f)};
}

TEST(ScenePart, IsTheBoxWithAMarginInTheShapeOfSmallPictures) {
  // The box is 320 x 180 pixels large, about (480, 360).
  const auto part = partWithBox(view(), kViewSize, flatBox({2.0f, 1.0f}, {4.0f, 2.25f}));
  ASSERT_TRUE(part);
  EXPECT_NEAR(part->width, 1.2 * 320.0, 1.0);
  EXPECT_NEAR(part->height, 1.2 * 180.0, 1.0);
  EXPECT_NEAR(part->left + 0.5 * part->width, 480.0, 1.0);
  EXPECT_NEAR(part->top + 0.5 * part->height, 360.0, 1.0) << "rows count from the top";
  const auto tall = partWithBox(view(), kViewSize, flatBox({0.0f, 0.0f}, {1.0f, 4.0f}));
  ASSERT_TRUE(tall);
  EXPECT_NEAR(tall->height, 1.2 * 320.0, 1.0) << "nothing of it is cut";
  EXPECT_NEAR(tall->width, 16.0 / 9.0 * tall->height, 1.0);
}

TEST(ScenePart, StaysWithinThePicture) {
  const auto part = partWithBox(view(), kViewSize, flatBox({-9.0f, 9.0f}, {0.9f, 0.9f}));
  ASSERT_TRUE(part);
  EXPECT_EQ(part->left, 0u);
  EXPECT_EQ(part->top, 0u);
  EXPECT_FALSE(partWithBox(view(), kViewSize, flatBox({-9.5f, 0.0f}, {0.9f, 0.9f}))) << "cut by the picture";
  EXPECT_FALSE(partWithBox(view(), kViewSize, flatBox({0.0f, 0.0f}, {0.4f, 0.4f}))) << "32 pixels";
  EXPECT_FALSE(partWithBox(view(), kViewSize, {})) << "nothing";
  EXPECT_FALSE(partWithBox(view(), kViewSize, {.min = {-1, -1, 9}, .max = {1, 1, 12}})) << "behind the eye";
}

}  // namespace
}  // namespace lambent::editor
