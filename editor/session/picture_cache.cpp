#include "editor/session/picture_cache.hpp"

#include <span>
#include <utility>

#include "baker/cache/bytes.hpp"

namespace lambent::editor {

namespace {

// Rises when pictures are made or written in another way.
constexpr std::uint32_t kPictureVersion = 1;

baker::Key keyOf(const Asset& asset) {
  return baker::KeyMaker()
      .addText("picture of an asset")
      .add(kPictureVersion)
      .addText(asset.file.string())
      .add(asset.bytes)
      .add(std::int64_t{asset.written.time_since_epoch().count()})
      .key();
}

}  // namespace

PictureCache::PictureCache(const std::filesystem::path& folder, std::uint64_t most_bytes) {
  if (folder.empty()) return;
  if (auto cache = baker::Cache::open(folder, most_bytes)) cache_ = std::move(*cache);
}

std::optional<spec::Rgba8Image> PictureCache::find(const Asset& asset) const {
  if (!cache_) return std::nullopt;
  const auto bytes = cache_->find(keyOf(asset));
  if (!bytes) return std::nullopt;
  baker::ByteReader reader(*bytes);
  spec::Rgba8Image picture;
  const bool read =
      reader.read(picture.width) && reader.read(picture.height) && reader.readList(picture.texels);
  if (!read || picture.texels.size() != std::size_t{4} * picture.width * picture.height) return std::nullopt;
  return picture;
}

void PictureCache::put(const Asset& asset, const spec::Rgba8Image& picture) {
  if (!cache_) return;
  baker::ByteWriter writer;
  writer.add(picture.width);
  writer.add(picture.height);
  writer.addList(picture.texels);
  // Pictures that were used a moment ago may go, too, since they can be made again.
  cache_->beginBake();
  cache_->put(keyOf(asset), writer.bytes());
}

}  // namespace lambent::editor
