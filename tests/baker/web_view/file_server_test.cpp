// Tests the server of `lambent view` with requests as browsers send them, and as nobody should.
#include "baker/web_view/file_server.hpp"

#include <fstream>
#include <future>
#include <thread>

#include <gtest/gtest.h>
#include <httplib.h>

#include "tests/support/temporary_folder.hpp"

namespace lambent::baker {
namespace {

class Server : public ::testing::Test {
 protected:
  void SetUp() override {
    for (std::size_t i = 0; i < bytes_.size(); ++i) bytes_[i] = static_cast<char>(i * 7 % 251);
    write("bundle.lmb.glb", bytes_);
    write("viewer.js", "let a;");
    write("secret.js", "let b;");
    running_ = std::jthread([this](const std::stop_token& stop) {
      ended_ = serveFiles(
          {{"/bundle.lmb.glb", folder_.path() / "bundle.lmb.glb"},
           {"/viewer/viewer.js", folder_.path() / "viewer.js"},
           {"/gone.css", folder_.path() / "gone.css"}},
          "/viewer/viewer.js?a=b", 0, [this](const std::string& address) { began_.set_value(address); },
          stop);
    });
    const std::string address = began_.get_future().get();
    ASSERT_TRUE(address.starts_with("http://127.0.0.1:")) << address;
    port_ = std::stoi(address.substr(address.rfind(':') + 1));
  }
  void TearDown() override {
    running_.request_stop();
    running_.join();
    EXPECT_TRUE(ended_);
    EXPECT_FALSE(client().Get("/viewer/viewer.js")) << "it still answers";
  }

  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_.path() / name, std::ios::binary) << bytes;
  }
  httplib::Client client() const { return httplib::Client("127.0.0.1", port_); }
  httplib::Result range(const std::string& words) const {
    return client().Get("/bundle.lmb.glb", {{"Range", "bytes=" + words}});
  }

  testing::TemporaryFolder folder_;
  std::string bytes_ = std::string(200'000, '\0');  // more than one chunk
  int port_ = 0;
  std::promise<std::string> began_;
  Result<void> ended_;
  std::jthread running_;
};

TEST_F(Server, HandsOutWhatIsInItsTableWithItsType) {
  const auto whole = client().Get("/bundle.lmb.glb");
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->status, 200);
  EXPECT_EQ(whole->get_header_value("Content-Type"), "model/gltf-binary");
  EXPECT_EQ(whole->get_header_value("Accept-Ranges"), "bytes");
  EXPECT_TRUE(whole->body == bytes_);
  const auto script = client().Get("/viewer/viewer.js");
  ASSERT_TRUE(script);
  EXPECT_EQ(script->body, "let a;");
  EXPECT_EQ(script->get_header_value("Content-Type"), "text/javascript; charset=utf-8");
  const auto start = client().Get("/");
  ASSERT_TRUE(start);
  EXPECT_EQ(start->status, 302);
  EXPECT_EQ(start->get_header_value("Location"), "/viewer/viewer.js?a=b");
  const auto gone = client().Get("/gone.css");
  ASSERT_TRUE(gone);
  EXPECT_EQ(gone->status, 404);
}

TEST_F(Server, AnswersHeadWithTheLengthAlone) {
  const auto head = client().Head("/bundle.lmb.glb");
  ASSERT_TRUE(head);
  EXPECT_EQ(head->status, 200);
  EXPECT_EQ(head->get_header_value("Content-Length"), std::to_string(bytes_.size()));
  EXPECT_EQ(head->body, "");
}

TEST_F(Server, AnswersRangesWithTheirBytes) {
  const struct {
    const char* words;
    std::size_t first, end;
  } cases[] = {{"0-9", 0, 10},
               {"100-70099", 100, 70'100},  // two chunks
               {"199990-", 199'990, 200'000},
               {"-5", 199'995, 200'000},
               {"199990-999999", 199'990, 200'000},  // past the end
               {"-999999", 0, 200'000}};
  for (const auto& [words, first, end] : cases) {
    const auto part = range(words);
    ASSERT_TRUE(part) << words;
    EXPECT_EQ(part->status, 206) << words;
    EXPECT_TRUE(part->body == bytes_.substr(first, end - first)) << words;
    EXPECT_EQ(part->get_header_value("Content-Range"),
              "bytes " + std::to_string(first) + "-" + std::to_string(end - 1) + "/200000")
        << words;
  }
  const auto several = range("0-1,5-6");
  ASSERT_TRUE(several);
  EXPECT_EQ(several->status, 200);
  EXPECT_TRUE(several->body == bytes_);
}

TEST_F(Server, RefusesRangesBehindTheEnd) {
  for (const char* words : {"200000-", "200000-200001", "-0"}) {
    const auto part = range(words);
    ASSERT_TRUE(part) << words;
    EXPECT_EQ(part->status, 416) << words;
    EXPECT_LT(part->body.size(), 100u) << words;
  }
}

TEST_F(Server, LeadsToNoOtherFile) {
  for (const char* path :
       {"/secret.js", "/viewer/../secret.js", "/../secret.js", "/%2e%2e/secret.js", "/viewer/",
        "/viewer/..%2fsecret.js", "//etc/passwd", "/../../../../../../etc/passwd", "/viewer",
        "/%2e%2e/%2e%2e/%2e%2e/%2e%2e/%2e%2e/etc/passwd", "/viewer/viewer.js%00.css"}) {
    const auto answer = client().Get(path);
    ASSERT_TRUE(answer) << path;
    EXPECT_GE(answer->status, 400) << path;
    EXPECT_LT(answer->status, 500) << path;
    EXPECT_EQ(answer->body.find("let"), std::string::npos) << path;
    EXPECT_EQ(answer->body.find("root:"), std::string::npos) << path;
  }
}

// A page at evil.example whose name is made to lead here would send its own name as the host.
TEST_F(Server, AnswersToItsOwnNamesOnly) {
  const auto as = [&](const std::string& host) {
    const auto answer = client().Get("/viewer/viewer.js", {{"Host", host}});
    return answer ? answer->status : -1;
  };
  const std::string port = std::to_string(port_);
  EXPECT_EQ(as("127.0.0.1:" + port), 200);
  EXPECT_EQ(as("localhost:" + port), 200);
  for (const std::string& host : {"evil.example:" + port, std::string("evil.example"),
                                  std::string("127.0.0.1:1"), "127.0.0.1.evil.example:" + port})
    EXPECT_EQ(as(host), 403) << host;
  const auto answer = client().Get("/viewer/viewer.js");
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->get_header_value("Cross-Origin-Resource-Policy"), "same-origin");
  EXPECT_FALSE(answer->has_header("Access-Control-Allow-Origin"));
}

TEST_F(Server, IsForReadingOnly) {
  EXPECT_EQ(client().Post("/viewer/viewer.js", "x", "text/plain")->status, 405);
  EXPECT_EQ(client().Put("/new.js", "x", "text/plain")->status, 405);
  EXPECT_EQ(client().Delete("/viewer/viewer.js")->status, 405);
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "viewer.js"));
}

TEST_F(Server, SaysThatAPortIsTaken) {
  const auto second = serveFiles({}, "/", port_, [](const std::string&) {}, {});
  ASSERT_FALSE(second);
  EXPECT_NE(second.error().line().find("127.0.0.1:" + std::to_string(port_)), std::string::npos)
      << second.error().line();
}

// What is served of the viewer.
class ViewerFiles : public ::testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((web_ / name).parent_path());
    std::ofstream(web_ / name) << text;
  }

  testing::TemporaryFolder folder_;
  std::filesystem::path web_ = folder_.path() / "web";
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
