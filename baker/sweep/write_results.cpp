#include "baker/sweep/write_results.hpp"

#include <string>
#include <utility>

#include "baker/sweep/advice.hpp"
#include "baker/sweep/csv.hpp"
#include "baker/sweep/page.hpp"
#include "baker/sweep/page_parts.hpp"
#include "runtime/base/atomic_file.hpp"

namespace lambent::baker {

Result<std::vector<std::filesystem::path>> writeResults(const SweepResults& results,
                                                        const std::filesystem::path& folder) {
  auto page = pageOf(results);
  if (!page) return failAgain(std::move(page.error()));
  std::vector<std::pair<std::filesystem::path, std::string>> files = {
      {folder / "index.html", std::move(*page)},
      {folder / "settings.csv", settingsCsv(results)},
      {folder / "times.csv", timesCsv(results)}};
  for (const Cost& cost : costs()) {
    const Advice advice = adviceOn(cost, results.settings);
    files.emplace_back(folder / (std::string(cost.id) + ".svg"),
                       svgOf(plotOf(results, cost, advice), PlotPlace::Alone));
  }
  std::vector<std::filesystem::path> written;
  for (const auto& [path, text] : files) {
    auto file = AtomicFile::open(path);
    if (!file) return failAgain(std::move(file.error()));
    if (auto done = file->write(text); !done) return failAgain(std::move(done.error()));
    if (auto done = file->commit(); !done) return failAgain(std::move(done.error()));
    written.push_back(path);
  }
  return written;
}

}  // namespace lambent::baker
