#include "baker/sweep/store.hpp"

#include <fstream>
#include <system_error>

#include "runtime/base/atomic_file.hpp"

namespace lambent::baker {

using nlohmann::json;

Result<Store> Store::open(const std::filesystem::path& file) {
  Store store(file);
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return store;
  const Result<std::string> text = readTextFile(file);
  if (!text) return failAgain(text.error());
  store.cut_short_ = !text->empty() && text->back() != '\n';
  for (std::size_t at = 0; at < text->size();) {
    const std::size_t end = std::min(text->find('\n', at), text->size());
    json line = json::parse(text->begin() + static_cast<std::ptrdiff_t>(at),
                            text->begin() + static_cast<std::ptrdiff_t>(end), nullptr, /*exceptions=*/false);
    at = end + 1;
    if (!line.is_object() || !line.contains("key") || !line["key"].is_string() || !line.contains("row"))
      continue;
    store.rows_.insert_or_assign(line["key"].get<std::string>(), std::move(line["row"]));
  }
  return store;
}

Result<void> Store::add(const std::string& key, const std::string& what, json row) {
  const json line = {{"key", key}, {"what", what}, {"row", row}};
  std::ofstream out(file_, std::ios::app);
  if (cut_short_) out << '\n';
  out << line.dump(-1, ' ', false, json::error_handler_t::replace) << '\n';
  out.close();
  if (!out) return fail(file_.string(), "cannot be written", "see that its folder is there and not full");
  cut_short_ = false;
  rows_.insert_or_assign(key, std::move(row));
  ++added_;
  return {};
}

}  // namespace lambent::baker
