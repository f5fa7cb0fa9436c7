// A BakeContext is what a bake hands to everything that it runs: whom to tell about progress, when to stop,
// and where results are kept. Stages read it and never change it; copies are cheap and refer to the same
// progress and cache.
#pragma once

#include <stop_token>
#include <string_view>

#include "baker/cache/cache.hpp"
#include "baker/cache/key.hpp"
#include "baker/jobs/progress.hpp"

namespace lambent::baker {

struct BakeContext {
  Progress& progress;
  std::stop_token stop = {};
  Cache* cache = nullptr;  // null: nothing is kept
  // The digest of all that the work at hand reads, under which its results are kept. While it is not set,
  // nothing is kept either.
  Key key = {};

  bool stopped() const { return stop.stop_requested(); }
  bool keeps() const { return cache != nullptr && key != Key{}; }
  bool checkpointDue() const { return keeps() && cache->checkpointDue(); }

  // Returns the context of the work with this key.
  BakeContext keyed(const Key& of) const { return {progress, stop, cache, of}; }
  // Returns the context of a named part of the same work.
  template <PlainBytes... Values>
  BakeContext part(std::string_view name, const Values&... values) const {
    if (!keeps()) return *this;
    KeyMaker maker;
    maker.add(key).addText(name);
    (maker.add(values), ...);
    return keyed(maker.key());
  }
};

}  // namespace lambent::baker
