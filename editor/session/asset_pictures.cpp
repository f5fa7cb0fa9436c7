#include "editor/session/asset_pictures.hpp"

#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "editor/session/picture_cache.hpp"
#include "editor/session/small_pictures.hpp"

namespace lambent::editor {

namespace {

// How many pictures are held in memory; a window shows far fewer at a time.
constexpr std::size_t kMostPictures = 512;

}  // namespace

// Finds, makes and keeps pictures on a thread of its own.
struct AssetPictures::Worker {
  struct Request {
    Asset asset;
    spec::Rgba8Image keep{};  // empty: the picture is wanted
  };
  struct Made {
    Asset asset;
    spec::Rgba8Image image{};
    std::string error{};
  };

  explicit Worker(std::filesystem::path folder)
      : thread([this, folder = std::move(folder)](std::stop_token stop) { run(stop, folder); }) {}

  void add(Request request) {
    const std::lock_guard hold(lock);
    requests.push_back(std::move(request));
    wake.notify_one();
  }
  std::vector<Made> take() {
    const std::lock_guard hold(lock);
    return std::exchange(made, {});
  }

  void run(std::stop_token stop, const std::filesystem::path& folder) {
    PictureCache cache(folder);
    while (true) {
      std::unique_lock hold(lock);
      if (!wake.wait(hold, stop, [this] { return !requests.empty(); })) return;
      const Request request = std::move(requests.front());
      requests.pop_front();
      hold.unlock();
      if (!request.keep.texels.empty()) {
        cache.put(request.asset, request.keep);
        continue;
      }
      if (stop.stop_requested()) continue;  // only what is to be kept still matters
      Made one = make(request.asset, cache);
      hold.lock();
      made.push_back(std::move(one));
    }
  }
  // Returns the picture that came with the file: one of its name beside it, in the shape of a view, since
  // textures are named like their scenes, too. The samples have such pictures.
  static spec::Rgba8Image pictureBeside(const Asset& asset) {
    const std::filesystem::path file = asset.file.parent_path() / (nameOf(asset) + ".png");
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored)) return {};
    const auto picture = spec::readPng(file);
    if (!picture || std::uint64_t{9} * picture->width != std::uint64_t{16} * picture->height) return {};
    return smallPictureOf(*picture);
  }
  static Made make(const Asset& asset, PictureCache& cache) {
    try {
      if (auto found = cache.find(asset)) return {.asset = asset, .image = std::move(*found)};
      if (asset.kind != AssetKind::EnvironmentMap) return {.asset = asset, .image = pictureBeside(asset)};
      const auto map = spec::readLightImage(asset.file);
      if (!map) return {.asset = asset, .error = map.error().line()};
      Made one{.asset = asset, .image = smallPictureOf(*map)};
      cache.put(asset, one.image);
      return one;
    } catch (const std::exception& failure) {  // out of memory, mostly
      return {.asset = asset, .error = failure.what()};
    }
  }

  std::mutex lock;  // protects the members below
  std::condition_variable_any wake;
  std::deque<Request> requests;
  std::vector<Made> made;
  std::jthread thread;  // it is joined before the others go
};

AssetPictures::AssetPictures(const std::filesystem::path& folder)
    : worker_(std::make_unique<Worker>(folder)) {}
AssetPictures::~AssetPictures() = default;

const AssetPictures::Picture& AssetPictures::of(const Asset& asset) {
  const auto [asked, first] = asked_.try_emplace(asset.file, asset);
  Picture& picture = pictures_[asset.file];
  if (!first && asked->second == asset) return picture;
  asked->second = asset;
  picture = {.coming = true};
  ++coming_;
  worker_->add({.asset = asset});
  return picture;
}

bool AssetPictures::lacks(const Asset& asset) {
  const Picture& picture = of(asset);
  return !picture.coming && picture.texture == 0 && picture.image.texels.empty();
}

void AssetPictures::keep(const Asset& asset, spec::Rgba8Image image) {
  asked_[asset.file] = asset;
  worker_->add({.asset = asset, .keep = image});
  Picture& picture = pictures_[asset.file];
  picture.image = std::move(image);
  picture.error.clear();
  picture.coming = false;
}

void AssetPictures::update() {
  for (Worker::Made& made : worker_->take()) {
    --coming_;
    // The file may have changed, or its picture may have come from the view, in the meantime.
    const auto asked = asked_.find(made.asset.file);
    if (asked == asked_.end() || asked->second != made.asset) continue;
    Picture& picture = pictures_[made.asset.file];
    if (!std::exchange(picture.coming, false)) continue;
    picture.image = std::move(made.image);
    picture.error = std::move(made.error);
  }
  // What is still shown is found on disk again.
  if (pictures_.size() <= kMostPictures || busy()) return;
  pictures_.clear();
  asked_.clear();
}

}  // namespace lambent::editor
