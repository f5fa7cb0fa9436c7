#include "baker/pipeline/progress_record.hpp"

#include <algorithm>
#include <utility>

#include "baker/bake/bake.hpp"
#include "baker/cache/bytes.hpp"

namespace lambent::baker {

Key progressKey(const Scene& scene, const BakeOptions& options) {
  KeyMaker key = KeyMaker::ofStage("share");
  key.add(sceneDigest(scene));
  for (const auto& [name, word] : options.settings()) key.addText(name).addText(word);
  return key.key();
}

double findProgress(const Key& key, const Cache& cache) {
  const auto bytes = cache.find(key);
  if (!bytes) return 0.0;
  ByteReader in(*bytes);
  double share = 0.0;
  return in.read(share) && in.atEnd() && share > 0.0 && share < 1.0 ? share : 0.0;
}

ProgressWatch keepProgress(const Progress& progress, WholeProgress whole, Cache& cache, const Key& key) {
  constexpr double kEvery_s = 1.0;
  const std::chrono::duration<double> every(std::min(kEvery_s, cache.checkpointEvery()));
  return {progress, std::move(whole), every, [&cache, key](const WholeProgress::Seen& seen) {
            ByteWriter out;
            out.add(seen.share);
            cache.put(key, out.bytes());
          }};
}

}  // namespace lambent::baker
