#include "baker/cache/key.hpp"

#include <cstdio>

#include <xxhash.h>

namespace lambent::baker {

struct KeyMaker::State {
  struct Free {
    void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
  };
  std::unique_ptr<XXH3_state_t, Free> hash{XXH3_createState()};
};

std::string Key::hex() const {
  std::array<char, 33> text{};
  std::snprintf(text.data(), text.size(), "%016llx%016llx", static_cast<unsigned long long>(high),
                static_cast<unsigned long long>(low));
  return text.data();
}

KeyMaker::KeyMaker() : state_(std::make_unique<State>()) {
  XXH3_128bits_reset(state_->hash.get());
}
KeyMaker::KeyMaker(KeyMaker&&) noexcept = default;
KeyMaker& KeyMaker::operator=(KeyMaker&&) noexcept = default;
KeyMaker::~KeyMaker() = default;

KeyMaker KeyMaker::ofStage(std::string_view stage) {
  KeyMaker maker;
  maker.addText(programDigest());
  maker.addText(stage);
  return maker;
}

KeyMaker& KeyMaker::addBytes(std::span<const std::byte> bytes) {
  if (!bytes.empty()) XXH3_128bits_update(state_->hash.get(), bytes.data(), bytes.size());
  return *this;
}

Key KeyMaker::key() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(state_->hash.get());
  return {hash.high64, hash.low64};
}

}  // namespace lambent::baker
