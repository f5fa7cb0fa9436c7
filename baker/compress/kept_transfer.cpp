#include "baker/compress/kept_transfer.hpp"

#include "baker/jobs/stage.hpp"

namespace lambent::baker {

CodedTransfer CachedCoding::code(std::span<const float> vectors, std::size_t count,
                                 const transfer::TransferShape& shape, const CodingSettings& settings) {
  Key key;
  if (context_.cache) {
    KeyMaker maker = KeyMaker::ofStage("coding");
    maker.add(shape).addList(vectors).add(settings.bound).add(settings.shown_energy);
    maker.add(settings.most_components).add(settings.loose_bound).add(settings.most_expanded_bytes);
    key = maker.add(settings.kernel_power).addList(settings.weights).key();
    kept_.push_back(key);
  }
  const BakeContext own = context_.keyed(key);
  CodedTransfer coded;
  findOrMake(own, coded, [&] {
    coded = codeTransfer(vectors, count, shape, settings, own.stop);
    return !own.stopped();
  });
  return coded;
}

void CachedCoding::drop() {
  for (const Key& key : kept_) dropValue(context_.keyed(key));
  kept_.clear();
}

}  // namespace lambent::baker
