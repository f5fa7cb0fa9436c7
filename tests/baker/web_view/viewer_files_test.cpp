// Tests what `lambent view` serves of the viewer.
#include "baker/web_view/viewer_files.hpp"

#include <fstream>

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"

namespace lambent::baker {
namespace {

namespace fs = std::filesystem;

class ViewerFiles : public ::testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) const {
    fs::create_directories((web_ / name).parent_path());
    std::ofstream(web_ / name) << text;
  }

  testing::TemporaryFolder folder_;
  fs::path web_ = folder_.path() / "web";
};

TEST_F(ViewerFiles, AreWhatTheListNamesAndNoMore) {
  write("viewer/files.txt", "# A list.\nviewer/*.js\n\nsrc/a.js\n");
  for (const char* name :
       {"viewer/a.js", "viewer/b.js", "viewer/deep/c.js", "viewer/d.html", "src/a.js", "src/b.js"})
    write(name, "");
  const auto files = viewerFiles(web_);
  ASSERT_TRUE(files) << files.error().line();
  EXPECT_EQ(*files, (ServedFiles{{"/viewer/a.js", web_ / "viewer/a.js"},
                                 {"/viewer/b.js", web_ / "viewer/b.js"},
                                 {"/src/a.js", web_ / "src/a.js"}}));
}

TEST_F(ViewerFiles, AreNamedWhereTheyAreMissingWithWhatToDo) {
  for (const char* list : {"", "node_modules/three/build/three.module.js\n"}) {
    if (*list) write("viewer/files.txt", list);
    const auto files = viewerFiles(web_);
    ASSERT_FALSE(files);
    EXPECT_NE(files.error().line().find(*list ? "three.module.js" : "files.txt"), std::string::npos)
        << files.error().line();
    EXPECT_NE(files.error().hint.find("npm ci"), std::string::npos) << files.error().line();
  }
}

}  // namespace
}  // namespace lambent::baker
