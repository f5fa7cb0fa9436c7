#include "baker/cache/key.hpp"

#include <cstdio>

#include <xxhash.h>

namespace lambent::baker {

void KeyMaker::Free::operator()(XXH3_state_s* hash) const {
  XXH3_freeState(hash);
}

std::string Key::hex() const {
  std::array<char, 33> text{};
  std::snprintf(text.data(), text.size(), "%016llx%016llx", static_cast<unsigned long long>(high),
                static_cast<unsigned long long>(low));
  return text.data();
}

KeyMaker::KeyMaker() : hash_(XXH3_createState()) {
  XXH3_128bits_reset(hash_.get());
}

KeyMaker KeyMaker::ofStage(std::string_view stage) {
  KeyMaker maker;
  maker.addText(programDigest());
  maker.addText(stage);
  return maker;
}

KeyMaker& KeyMaker::addBytes(std::span<const std::byte> bytes) {
  if (!bytes.empty()) XXH3_128bits_update(hash_.get(), bytes.data(), bytes.size());
  return *this;
}

Key KeyMaker::key() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(hash_.get());
  return {hash.high64, hash.low64};
}

}  // namespace lambent::baker
