// Reads bundles whole: container, JSON, every payload. Mutants have the right checksums, so that they get
// past them.
#include <cstring>
#include <vector>

#include "runtime/bundle/container.hpp"
#include "runtime/bundle/description.hpp"
#include "runtime/bundle/description_json.hpp"
#include "tests/fuzz/input_file.hpp"
#include "tests/fuzz/json_mutator.hpp"

namespace {

using namespace lambent::bundle;
using lambent::fuzz::Random;

constexpr std::size_t kJsonAt = kGlbHeaderBytes + kGlbChunkHeaderBytes;

std::uint32_t wordAt(const std::vector<std::uint8_t>& bytes, std::size_t at) {
  std::uint32_t word = 0;
  if (at + 4 <= bytes.size()) std::memcpy(&word, bytes.data() + at, 4);
  return word;
}

std::uint64_t checksumOf(std::span<const std::uint8_t> bytes) {
  return checksum(std::as_bytes(bytes));
}

// Writes the container around JSON and binary chunk, with the checksums that belong to them.
std::vector<std::uint8_t> container(Json json, std::vector<std::uint8_t> binary) {
  try {
    auto& extension = json.at("extensions").at(std::string(kExtensionName));
    auto& checksums = extension.at("checksums");
    for (std::size_t i = 0; i < checksums.size(); ++i) {
      const auto& view = json.at("bufferViews").at(i);
      const auto number = [&](const char* name) {
        return view.contains(name) && view[name].is_number_unsigned() ? view[name].get<std::uint64_t>() : 0;
      };
      const std::uint64_t offset = number("byteOffset"), length = (number("byteLength") + 7) / 8 * 8;
      if (offset <= binary.size() && length <= binary.size() - offset)
        checksums[i] = hexJson(checksumOf(std::span(binary).subspan(offset, length)));
    }
  } catch (const nlohmann::json::exception&) {
    // It has lost what would hold them.
  }
  std::string text = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  text.append((8 - (kJsonAt + text.size() + kGlbChunkHeaderBytes) % 8) % 8, ' ');
  const std::uint64_t whole = checksumOf({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}),
                      complement = ~whole;
  if (binary.size() >= 16) {
    std::memcpy(binary.data(), &whole, 8);
    std::memcpy(binary.data() + 8, &complement, 8);
  }
  std::vector<std::uint8_t> out;
  const auto word = [&](std::uint64_t value) {
    for (int k = 0; k < 4; ++k) out.push_back(static_cast<std::uint8_t>(value >> (8 * k)));
  };
  word(kGlbMagic), word(2), word(kJsonAt + text.size() + kGlbChunkHeaderBytes + binary.size());
  word(text.size()), word(kGlbJsonChunk);
  out.insert(out.end(), text.begin(), text.end());
  word(binary.size()), word(kGlbBinChunk);
  out.insert(out.end(), binary.begin(), binary.end());
  return out;
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most,
                                               unsigned seed) {
  Random random(seed);
  std::vector<std::uint8_t> bytes(data, data + size);
  const std::size_t json_length = wordAt(bytes, 12);
  if (size < kJsonAt + kGlbChunkHeaderBytes || json_length > size - kJsonAt - kGlbChunkHeaderBytes ||
      random() % 16 == 0)
    return LLVMFuzzerMutate(data, size, most);
  Json json =
      nlohmann::json::parse(std::string(bytes.begin() + kJsonAt,
                                        bytes.begin() + static_cast<std::ptrdiff_t>(kJsonAt + json_length)),
                            nullptr, false);
  std::vector<std::uint8_t> binary(
      bytes.begin() + static_cast<std::ptrdiff_t>(kJsonAt + json_length + kGlbChunkHeaderBytes), bytes.end());
  if (json.is_discarded()) return LLVMFuzzerMutate(data, size, most);
  if (random() % 2 == 0 && binary.size() > 16) {
    for (std::uint32_t times = 1 + static_cast<std::uint32_t>(random() % 4); times > 0; --times)
      binary[16 + random() % (binary.size() - 16)] = static_cast<std::uint8_t>(random());
  } else {
    lambent::fuzz::mutate(json, random);
  }
  const std::vector<std::uint8_t> out = container(std::move(json), std::move(binary));
  if (out.size() > most) return LLVMFuzzerMutate(data, size, most);
  std::memcpy(data, out.data(), out.size());
  return out.size();
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto path = lambent::fuzz::inputFile("bundle.glb", {data, size});
  if (const auto reader = Reader::open(path)) static_cast<void>(reader->checkAll());
  return 0;
}
