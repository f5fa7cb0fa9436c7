#include "baker/web_view/file_server.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <mutex>
#include <sstream>
#include <system_error>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <glob.h>
#include <httplib.h>

#include "runtime/base/atomic_file.hpp"
#include "runtime/base/process.hpp"

namespace lambent::baker {

namespace fs = std::filesystem;

namespace {

constexpr const char* kHint =
    "run npm ci in the folder web of Lambent's sources, and install or pack again where this is a package";

// Adds the files that a line of the list names; * stands for a part of a name, but not for folders. The
// address "viewer" of a folder "/usr/share/lambent/web/viewer" begins behind `web`.
Result<void> addMatches(const fs::path& web, const std::string& line, ServedFiles& files) {
  glob_t found = {};
  const int failed = ::glob((web / line).c_str(), 0, nullptr, &found);
  for (std::size_t i = 0; failed == 0 && i < found.gl_pathc; ++i) {
    const std::string file = found.gl_pathv[i];
    files[file.substr(web.string().size())] = file;
  }
  ::globfree(&found);
  if (failed != 0) return fail((web / line).string(), "is missing, which the viewer loads", kHint);
  return {};
}

}  // namespace

Result<ServedFiles> viewerFiles(const fs::path& web) {
  const fs::path list = web / "viewer/files.txt";
  const Result<std::string> text = readTextFile(list);
  if (!text) return fail(list.string(), "is missing, which lists the files of the viewer", kHint);
  ServedFiles files;
  std::istringstream lines(*text);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line.starts_with('#')) continue;
    if (const auto added = addMatches(web, line, files); !added) return failAgain(added.error());
  }
  return files;
}

Result<fs::path> findWebFolder() {
  const Result<fs::path> self = ownProgram();
  if (!self) return failAgain(self.error());
  return self->parent_path().parent_path() / "share/lambent/web";
}

namespace {

bool isSet(const char* variable) {
  const char* value = std::getenv(variable);
  return value && *value;
}

}  // namespace

bool openBrowser(const std::string& address) {
  // Without a display xdg-open would show text browsers in the terminal.
  if (!isSet("DISPLAY") && !isSet("WAYLAND_DISPLAY")) return false;
  const Result<Ran> asked = runToAnyEnd(
      "/bin/sh",
      {"-c", "command -v xdg-open && (setsid xdg-open \"$0\" </dev/null >/dev/null 2>&1 &)", address}, {});
  return asked && asked->exit_code == 0;
}

namespace {

constexpr const char* kHost = "127.0.0.1";
constexpr std::size_t kChunkBytes = 1 << 16;

const char* typeOf(const fs::path& file) {
  static constexpr std::array<std::pair<const char*, const char*>, 9> kTypes = {{
      {".html", "text/html; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".mjs", "text/javascript; charset=utf-8"},
      {".wasm", "application/wasm"},
      {".glb", "model/gltf-binary"},
      {".hdr", "image/vnd.radiance"},
      {".exr", "image/x-exr"},
      {".txt", "text/plain; charset=utf-8"},
  }};
  const std::string extension = file.extension().string();
  const auto found =
      std::find_if(kTypes.begin(), kTypes.end(), [&](const auto& type) { return extension == type.first; });
  return found == kTypes.end() ? "application/octet-stream" : found->second;
}

// Cuts the range that was asked for to the file. Returns false if nothing of the file is in it.
bool cutRange(httplib::Range& range, std::ptrdiff_t size) {
  auto& [first, last] = range;
  if (first < 0) {  // the last bytes
    if (last <= 0) return false;
    first = std::max<std::ptrdiff_t>(0, size - last);
    last = size - 1;
  }
  if (last < 0 || last >= size) last = size - 1;
  return first <= last;
}

void answer(httplib::Response& response, int status, const std::string& sentence) {
  response.status = status;
  response.set_content(sentence + "\n", "text/plain; charset=utf-8");
}

void sendFile(const httplib::Request& request, httplib::Response& response, const fs::path& path) {
  std::error_code failed;
  const auto size = static_cast<std::size_t>(fs::file_size(path, failed));
  const auto file = std::make_shared<std::ifstream>(path, std::ios::binary);
  if (failed || !*file) return answer(response, 404, "This file is gone.");
  // Version 0.11 of the library, which Debian 12 has, takes ranges as they are asked for, even those that
  // leave the file. The request is its own object and not constant there. Several ranges at once get the
  // whole file.
  auto& ranges = const_cast<httplib::Request&>(request).ranges;
  if (ranges.size() > 1) ranges.clear();
  if (!ranges.empty() && !cutRange(ranges[0], static_cast<std::ptrdiff_t>(size))) {
    ranges.clear();
    response.set_header("Content-Range", fmt::format("bytes */{}", size));
    return answer(response, 416, "The file is shorter.");
  }
  response.set_header("Accept-Ranges", "bytes");
  if (size == 0) return response.set_content("", typeOf(path));
  response.set_content_provider(size, typeOf(path),
                                [file](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
                                  std::array<char, kChunkBytes> chunk;
                                  const std::size_t count = std::min(length, chunk.size());
                                  file->seekg(static_cast<std::streamoff>(offset));
                                  return file->read(chunk.data(), static_cast<std::streamsize>(count)) &&
                                         sink.write(chunk.data(), count);
                                });
}

void handle(const ServedFiles& files, const std::string& start, int port, const httplib::Request& request,
            httplib::Response& response) {
  response.set_header("X-Content-Type-Options", "nosniff");
  response.set_header("Cross-Origin-Resource-Policy", "same-origin");
  response.set_header("Cache-Control", "no-store");  // a bundle that was baked again shows
  // The viewer takes nothing from elsewhere. Draco's decoder is a worker made of a blob, and WebAssembly.
  response.set_header("Content-Security-Policy",
                      "default-src 'self' 'unsafe-inline' 'wasm-unsafe-eval' blob: data:");
  const std::string host = request.get_header_value("Host");
  if (host != fmt::format("{}:{}", kHost, port) && host != fmt::format("localhost:{}", port))
    return answer(response, 403, "This server answers to 127.0.0.1 and localhost only.");
  if (request.method != "GET" && request.method != "HEAD") {
    response.set_header("Allow", "GET, HEAD");
    return answer(response, 405, "Files can be read here.");
  }
  if (request.path == "/") return response.set_redirect(start);
  const auto found = files.find(request.path);
  if (found == files.end()) return answer(response, 404, "There is no such file here.");
  sendFile(request, response, found->second);
}

}  // namespace

Result<void> serveFiles(const ServedFiles& files, const std::string& start, int port,
                        const std::function<void(const std::string& address)>& began,
                        const std::stop_token& stop) {
  httplib::Server server;
  // The library's own choice lets several programs have one port.
  server.set_socket_options([](socket_t socket) {
    const int yes = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  // One answer a connection, and a second for the request: no idle connection of a browser holds a thread or
  // the end up.
  server.set_keep_alive_max_count(1);
  server.set_keep_alive_timeout(1);
  server.set_read_timeout(1);
  int bound = port;
  if (port == 0)
    bound = server.bind_to_any_port(kHost);
  else if (!server.bind_to_port(kHost, port))
    bound = -1;
  if (bound <= 0)
    return fail(fmt::format("{}:{}", kHost, port),
                "cannot be listened at, since another program does or you may not",
                "give --port another number, or leave it out");
  server.set_pre_routing_handler([&](const httplib::Request& request, httplib::Response& response) {
    handle(files, start, bound, request, response);
    return httplib::Server::HandlerResponse::Handled;
  });
  const std::string address = fmt::format("http://{}:{}/", kHost, bound);
  began(address);
  std::atomic<bool> ended = false;
  std::mutex lock;
  std::condition_variable_any wake;
  std::jthread listening([&] {
    server.listen_after_bind();
    const std::lock_guard hold(lock);
    ended = true;
    wake.notify_all();
  });
  // A server that has not begun cannot be stopped.
  while (!server.is_running() && !ended) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  {
    std::unique_lock hold(lock);
    wake.wait(hold, stop, [&] { return ended.load(); });
  }
  const bool asked = stop.stop_requested();
  server.stop();
  listening.join();
  if (!asked) return fail(address, "was ended by the system", "try again");
  return {};
}

}  // namespace lambent::baker
