// Implements lambent view BUNDLE [--light MAP] [--port N] [--no-browser].
#include <cstdio>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "baker/cli/commands.hpp"
#include "baker/web_view/file_server.hpp"
#include "runtime/base/atomic_file.hpp"
#include "runtime/base/lower_case.hpp"
#include "runtime/bundle/container.hpp"
#include "runtime/command_line/help.hpp"

namespace lambent::baker {

namespace {

struct ViewArguments {
  std::filesystem::path bundle, light;
  int port = 0;
  bool no_browser = false;
};

// Adds the map under a name that says its format, and to the words that the viewer begins with.
Result<void> addLight(const std::filesystem::path& light, ServedFiles& files, std::string& start) {
  const std::string extension = lowerCase(light.extension().string());
  if (extension != ".hdr" && extension != ".exr")
    return fail(light.string(), "is no environment map that the viewer reads",
                "give --light an .hdr or .exr file");
  if (const auto readable = checkRegularFile(light, "an environment map"); !readable)
    return failAgain(readable.error());
  files["/light" + extension] = light;
  start += "&light=/light" + extension;
  return {};
}

int runView(const ViewArguments& a) {
  if (const auto bundle = bundle::Reader::open(a.bundle); !bundle) return reportError(bundle.error());
  ServedFiles files = {{"/bundle.lmb.glb", a.bundle}};
  std::string start = "/viewer/index.html?bundle=/bundle.lmb.glb";
  if (!a.light.empty())
    if (const auto added = addLight(a.light, files, start); !added) return reportError(added.error());
  const auto web = findWebFolder();
  if (!web) return reportError(web.error());
  auto viewer = viewerFiles(*web);
  if (!viewer) return reportError(viewer.error());
  files.merge(*viewer);

  const std::stop_source stop;
  const InterruptGuard interrupts(stop);
  const auto began = [&](const std::string& address) {
    fmt::print("{} shows {}; interrupt to end\n", address, a.bundle.string());
    std::fflush(stdout);
    if (!a.no_browser && !openBrowser(address))
      reportNotice({}, "no browser can be opened here; open the address above in one");
  };
  const auto served = serveFiles(files, start, a.port, began, stop.get_token());
  return served ? 0 : reportError(served.error());
}

}  // namespace

void addViewCommand(CLI::App& app, Command& run) {
  auto a = std::make_shared<ViewArguments>();
  CLI::App* command =
      app.add_subcommand("view", "Show a bundle in the browser, from a server on this machine");
  command->add_option("BUNDLE", a->bundle, "The bundle, .lmb.glb")->required();
  command_line::addValue(*command, "--light", a->light, "MAP", "Environment map to begin with, .hdr or .exr");
  command_line::addValue(*command, "--port", a->port, "N", "Port at 127.0.0.1; default one that is free")
      ->check(CLI::Range(1, 65535).description(""));
  command->add_flag("--no-browser", a->no_browser, "Print the address only");
  command_line::addExamples(*command, {{"lambent view scene.lmb.glb", "opens it in the browser"},
                                       {"lambent view scene.lmb.glb --light sky.hdr --port 8080 --no-browser",
                                        "serves it at http://127.0.0.1:8080/"}});
  command->callback([a, &run] { run = [a] { return runView(*a); }; });
}

}  // namespace lambent::baker
