// The table of a bake's options: one row for each, with its name, its help and how it is written as a word.
// The command line, the editor's panel and its command, the checks before a bake, the settings that a bundle
// records and the journal of unfinished bakes go by it. A new option is a member of BakeOptions and a row.
// Errors: words that are not of the option's kind, values outside its range.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "baker/bake/options.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker {

struct OptionRow {
  std::string_view name;     // as in --name, in scripts and journals; never changed
  std::string_view setting;  // in the settings that a bundle records; empty: it does not change the bytes
  std::string_view kind;     // what a word looks like, for help: "N|auto"
  std::string_view help;
  std::vector<std::string_view> words{};  // that stand for values; `only_words`: it takes no others
  bool only_words = false;
  bool shows_default = false;  // the default is a value like others, not "auto" or "none"

  std::string (*word)(const BakeOptions&) = nullptr;
  // The setting's value; most often the word.
  std::string (*record)(const BakeOptions&) = nullptr;
  // Takes a word over. Ranges are left to check(), but for those that the command line holds to be wrong
  // usage.
  Result<void> (*put)(BakeOptions&, std::string_view word) = nullptr;
  // Takes over what word() or record() wrote; false where it is not of the option's kind.
  bool (*read)(BakeOptions&, std::string_view word) = nullptr;
  Result<void> (*check)(const BakeOptions&) = nullptr;
};

// In the order of the help.
std::span<const OptionRow> optionRows();
const OptionRow* findOption(std::string_view name);  // null: there is none

// By name, as scripts do.
Result<void> putOption(BakeOptions& options, std::string_view name, std::string_view word);
// Every row in its range.
Result<void> checkOptions(const BakeOptions& options);

}  // namespace lambent::baker
