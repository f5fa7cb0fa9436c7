// Tests which file beside a scene a URI names.
#include <gtest/gtest.h>

#include "baker/import/scene_files.hpp"
#include "tests/baker/import/gltf_writer.hpp"

namespace lambent::baker {
namespace {

using testing::TemporaryFolder;

TEST(Uri, NamesTheFileThatOtherSystemsFind) {
  TemporaryFolder folder;
  const auto scene = folder.write("scene.gltf", "{}");
  folder.write("Textures/Old Wood.PNG", "wood");
  folder.write("100%.png", "percent");
  folder.write("a%20b.png", "raw");
  const auto read = [&](const char* uri, std::size_t warnings_expected) {
    std::vector<std::string> warnings;
    const auto bytes = readUri(scene, uri, {}, "image 0", warnings);
    EXPECT_EQ(warnings.size(), warnings_expected) << uri;
    return bytes ? std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size())
                 : bytes.error().line();
  };
  EXPECT_EQ(read("Textures/Old%20Wood.PNG", 0), "wood");
  EXPECT_EQ(read("./Textures/Old Wood.PNG", 0), "wood");
  EXPECT_EQ(read("Textures\\Old Wood.PNG", 1), "wood");
  EXPECT_EQ(read("Textures%5COld%20Wood.PNG", 1), "wood");
  EXPECT_EQ(read("textures/old%20wood.png", 1), "wood");
  EXPECT_EQ(read("Textures/Old%2520Wood.PNG", 1), "wood");
  EXPECT_EQ(read("100%.png", 0), "percent");
  EXPECT_EQ(read("a%20b.png", 1), "raw");
  EXPECT_NE(read("Textures/none.png", 0).find("no such file"), std::string::npos);
  EXPECT_NE(read("..\\outside.png", 0).find("image 0"), std::string::npos);
}

TEST(Uri, OfDataIsReadInLettersOfAnyCaseAndBothAlphabets) {
  std::vector<std::string> warnings;
  for (const char* uri :
       {"data:;base64,+/8A", "DATA:image/png;BASE64,+/8A", "data:;charset=utf-8;Base64,-_8A",
        "data:;base64,%2B%2F8A", "data:;base64,+/\n8A"}) {
    const auto bytes = readUri("scene.gltf", uri, {}, "buffer 0", warnings);
    ASSERT_TRUE(bytes) << uri;
    EXPECT_EQ(*bytes, (std::vector<std::byte>{std::byte{0xfb}, std::byte{0xff}, std::byte{0}})) << uri;
  }
  EXPECT_FALSE(readUri("scene.gltf", "data:;base64,*", {}, "buffer 0", warnings));
}

}  // namespace
}  // namespace lambent::baker
