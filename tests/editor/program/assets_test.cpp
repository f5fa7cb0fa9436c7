#include "editor/session/assets.hpp"

#include <algorithm>
#include <fstream>
#include <string>
#include <utility>

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

// Waits until the pictures that were asked for have come.
void settle(AssetPictures& pictures) {
  ASSERT_TRUE(lambent::testing::eventually([&] {
    pictures.update();
    return !pictures.busy();
  }));
}

TEST_F(Assets, PicturesOfMapsAreMadeAndMadeAnewWhenTheirFilesChange) {
  const Asset map = *assetAt(writeMap("sky.hdr")), broken = *assetAt(write("broken.hdr"));
  AssetPictures pictures;
  for (const Asset& asset : {map, broken}) pictures.of(asset);
  settle(pictures);
  EXPECT_FALSE(pictures.of(map).image.texels.empty());
  EXPECT_NE(pictures.of(broken).error, "");
  write("sky.hdr", "no map any more");
  pictures.of(*assetAt(map.file));
  settle(pictures);
  EXPECT_NE(pictures.of(*assetAt(map.file)).error, "");
}

TEST_F(Assets, ScenesHaveThePicturesOfTheirNamesBesideThem) {
  const auto blue = [](std::uint32_t width, std::uint32_t height) {
    spec::Rgba8Image image{width, height, {}};
    for (std::uint32_t i = 0; i < width * height; ++i)
      image.texels.insert(image.texels.end(), {10, 20, 200, 255});
    return image;
  };
  const Asset shown = *assetAt(write("shown.glb")), textured = *assetAt(write("textured.glb"));
  ASSERT_TRUE(spec::writePng(folder.path() / "shown.png", blue(32, 18)));
  ASSERT_TRUE(spec::writePng(folder.path() / "textured.png", blue(32, 32)));
  AssetPictures pictures;
  for (const Asset& asset : {shown, textured}) pictures.of(asset);
  settle(pictures);
  const std::vector<std::uint8_t>& texels = pictures.of(shown).image.texels;
  ASSERT_FALSE(texels.empty());
  EXPECT_EQ(std::vector(texels.begin(), texels.begin() + 4), (std::vector<std::uint8_t>{10, 20, 200, 255}));
  EXPECT_TRUE(pictures.of(textured).image.texels.empty()) << "a texture of that name";
}

TEST_F(Assets, PicturesInMemoryAreLimitedAndComeAgain) {
  AssetPictures pictures;
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

}  // namespace
}  // namespace lambent::editor
