// Tests the libraries as strangers use them: installed, compiled against by the examples, and from Python.
#include <algorithm>
#include <cstdlib>
#include <memory>
#include <sstream>
#include <string>

#include <nlohmann/json.hpp>

#include "tests/support/program.hpp"
#include "tests/support/require.hpp"
#include "tests/support/x_server.hpp"

namespace lambent {
namespace {

namespace fs = std::filesystem;
using testing::bytesOf;
using testing::Outcome;

// Prefers a compiler that did not compile the library.
std::string otherCompiler() {
  for (const char* compiler : {"/usr/bin/clang++", "/usr/bin/clang++-16", "/usr/bin/clang++-14"})
    if (fs::exists(compiler)) return compiler;
  return "c++";
}

// Counts pixels of a picture in portable pixmap form for which `is` holds, by red, green and blue.
template <class Is>
int pixels(const std::string& ppm, const Is& is) {
  constexpr std::size_t kHeader = sizeof("P6 960 540 255\n") - 1;
  int count = 0;
  for (std::size_t i = kHeader; i + 2 < ppm.size(); i += 3)
    count += is(static_cast<unsigned char>(ppm[i]), static_cast<unsigned char>(ppm[i + 1]),
                static_cast<unsigned char>(ppm[i + 2]));
  return count;
}

class Library : public testing::ProgramTest {
 protected:
#ifdef LAMBENT_SANITIZED
  void SetUp() override {
    GTEST_SKIP() << "programs of others do not link libraries that have sanitizers";
  }
#endif
  // Runs words in a shell, whose $0 is the test's folder.
  Outcome shell(const std::string& words) const {
    return run("/bin/sh", {"-ec", words, folder.string()});
  }
  Outcome python(const std::string& script, const std::vector<std::string>& arguments) const {
    ::setenv("PYTHONPATH", LAMBENT_BINARY_DIR "/python", 1);
    std::vector<std::string> words = {script};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return run("/usr/bin/python3", words);
  }
};

TEST_F(Library, InstalledServesTheExamplesOfAnotherCompiler) {
  std::string why;
  const std::unique_ptr<testing::XServer> display = testing::XServer::start(why);
  if (!display) LAMBENT_LACKS("display", "there is no display: " << why);
  ::setenv("DISPLAY", display->display().c_str(), 1);
  const Outcome installed =
      shell("cmake --install '" LAMBENT_BINARY_DIR "' --component library --prefix \"$0/sdk\"");
  ASSERT_EQ(installed.exit_code, 0) << installed.out << installed.err;
  const Outcome built = shell("cmake -S '" LAMBENT_SOURCE_DIR
                              "/examples' -B \"$0/examples\" -G Ninja -DCMAKE_PREFIX_PATH=\"$0/sdk\" "
                              "-DCMAKE_CXX_FLAGS='-Wall -Wextra -Wpedantic -Werror' -DCMAKE_CXX_COMPILER=" +
                              otherCompiler() + "; cmake --build \"$0/examples\"");
  ASSERT_EQ(built.exit_code, 0) << built.out << built.err;

  const std::string bundle = (folder / "bowl.lmb.glb").string(), picture = (folder / "bowl.ppm").string();
  const Outcome baked = run(folder / "examples/bake", {bundle});
  ASSERT_EQ(baked.exit_code, 0) << baked.out << baked.err;
  EXPECT_NE(baked.out.find("direct light"), std::string::npos) << baked.out;
  EXPECT_EQ(run(LAMBENT_PROGRAM, {"info", bundle}).exit_code, 0);

  const Outcome shown =
      run(folder / "examples/show", {bundle, LAMBENT_BINARY_DIR "/assets/sky.hdr", picture});
  ASSERT_EQ(shown.exit_code, 0) << shown.out << shown.err;
  const std::string ppm = bytesOf(picture);
  ASSERT_EQ(ppm.size(), 960u * 540u * 3u + 15u);
  // The program's own cube is orange, and the library's bowl is red where light reaches it.
  EXPECT_GT(pixels(ppm, [](int r, int g, int b) { return r > 140 && g > r / 2 && b < r / 2; }), 5000);
  EXPECT_GT(pixels(ppm, [](int r, int g, int b) { return r > 170 && g < 9 * r / 10 && b > r / 2; }), 5000);

  const Outcome failed = run(folder / "examples/show", {(folder / "nothing.glb").string()});
  EXPECT_EQ(failed.exit_code, 1);
  EXPECT_NE(failed.err.find("nothing.glb: no such file"), std::string::npos) << failed.err;
}

TEST_F(Library, ForPkgConfigNamesWhatAProgramNeedsWhereverItIsMoved) {
  const Outcome installed = shell("cmake --install '" LAMBENT_BINARY_DIR
                                  "' --component library --prefix \"$0/sdk\" > \"$0/log\"; "
                                  "mv \"$0/sdk\" \"$0/moved\"; find \"$0/moved\" -name lambent-baker.pc");
  ASSERT_EQ(installed.exit_code, 0) << installed.err;
  const fs::path packages = fs::path(installed.out).parent_path();
  ::setenv("PKG_CONFIG_PATH", packages.c_str(), 1);
  const Outcome asked = shell("pkg-config --libs --cflags lambent-baker");
  ASSERT_EQ(asked.exit_code, 0) << asked.err;
  for (const char* word : {"-llambent-baker", "-llambent-sh", "-std=c++20"})
    EXPECT_NE(asked.out.find(word), std::string::npos) << asked.out;
  for (const char* word : {"-march", "-Werror", "-lembree"})
    EXPECT_EQ(asked.out.find(word), std::string::npos) << asked.out;

  testing::writeBytes(folder / "bands.cpp",
                      "#include <cstdio>\n#include <lambent/bake.hpp>\n#include <lambent/sh.hpp>\n"
                      "int main() {\n"
                      "  lambent::Baker baker;\n"
                      "  float bands[4];\n"
                      "  if (!baker.set(\"rays\", \"256\")) return 1;\n"
                      "  if (!lambent::evaluateHarmonics(2, {0, 1, 0}, bands)) return 2;\n"
                      "  std::printf(\"%.4f %.4f\", bands[0], bands[1]);\n"
                      "}\n");
  const Outcome built = shell("cd \"$0\"; " + otherCompiler() +
                              " bands.cpp -o bands $(pkg-config --cflags --libs lambent-baker) -Wl,-rpath," +
                              packages.parent_path().string() + "; ./bands");
  ASSERT_EQ(built.exit_code, 0) << built.err;
  EXPECT_EQ(built.out, "0.2821 0.4886");  // y_00 and y_1,-1 towards +Y: sqrt(1 / 4 pi) and sqrt(3 / 4 pi)
}

// Arrays that `lambent export` wrote give, in NumPy, what the library gives, which the GPU gives
// (tests/runtime/library). A draft of the gallery has plain, normal-mapped and glossy surfaces and bounces.
TEST_F(Library, ExportsNumbersThatShadeAsTheRuntimeDoes) {
  if (python("-c", {"import lambent, numpy"}).exit_code != 0)
    LAMBENT_LACKS("python", "there is no Python with NumPy and the module lambent");
  const std::string bundle = (folder / "gallery.lmb.glb").string(), arrays = (folder / "arrays").string();
  ASSERT_EQ(run(LAMBENT_PROGRAM,
                {"bake", LAMBENT_BINARY_DIR "/assets/gallery.glb", "-o", bundle, "--quality", "draft",
                 "--rays", "128", "--bounces", "1", "--refine", "off", "--effects", "diffuse"})
                .exit_code,
            0);
  const Outcome exported =
      run(LAMBENT_PROGRAM, {"export", bundle, "-o", arrays, "--light", LAMBENT_BINARY_DIR "/assets/sky.hdr",
                            "--order", "5", "--json"});
  ASSERT_EQ(exported.exit_code, 0) << exported.err;
  const auto described = nlohmann::json::parse(exported.out, nullptr, false);
  EXPECT_EQ(described, nlohmann::json::parse(bytesOf(fs::path(arrays) / "bundle.json"), nullptr, false));
  const Outcome compared = python(LAMBENT_SOURCE_DIR "/tests/programs/shade_exported.py", {bundle, arrays});
  EXPECT_EQ(compared.exit_code, 0) << compared.out << compared.err;
}

TEST_F(Library, InPythonDrawsTheErrorOfOrders) {
  if (python("-c", {"import lambent, matplotlib"}).exit_code != 0)
    LAMBENT_LACKS("python", "there is no Python with matplotlib and the module lambent");
  const fs::path plot = folder / "orders.png";
  const Outcome drawn = python(LAMBENT_SOURCE_DIR "/examples/orders.py", {plot.string()});
  ASSERT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_TRUE(bytesOf(plot).starts_with("\x89PNG"));
  std::istringstream lines(drawn.out);
  double before = 12.0;  // per cent
  int orders = 0;
  for (std::string word; lines >> word; ++orders) {
    double error = 0.0;
    lines >> word >> error >> word;
    EXPECT_LT(error, before) << drawn.out;
    before = error;
  }
  EXPECT_EQ(orders, 7);
  EXPECT_LT(before, 2.5);
}

TEST_F(Library, InPythonSaysWhatIsWrong) {
  if (python("-c", {"import lambent"}).exit_code != 0)
    LAMBENT_LACKS("python", "there is no Python with the module lambent");
  const Outcome wrong = python("-c", {"import lambent\nlambent.Bundle('nowhere.lmb.glb')"});
  EXPECT_NE(wrong.err.find("ValueError: nowhere.lmb.glb: no such file"), std::string::npos) << wrong.err;
  const Outcome stopped =
      python("-c", {"import lambent, sys\n"
                    "lambent.bake(sys.argv[1], sys.argv[2], progress=lambda f, s: False)",
                    LAMBENT_BINARY_DIR "/assets/gallery.glb", (folder / "out.lmb.glb").string()});
  EXPECT_NE(stopped.err.find("stopped"), std::string::npos) << stopped.err;
  EXPECT_EQ(fileCount(), 0);
}

}  // namespace
}  // namespace lambent
