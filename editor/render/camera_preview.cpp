#include "editor/render/camera_preview.hpp"

#include <algorithm>

#include "editor/session/viewing.hpp"

namespace lambent::editor {

namespace {

// The preview takes this share of the view's width, within limits in pixels.
constexpr float kShare = 0.3f;
constexpr float kLeastWidth = 128.0f, kMostWidth = 480.0f, kMostHeight = 360.0f;

spec::Size sizeOf(const Session& session, float aspect) {
  const float width =
      std::clamp(kShare * static_cast<float>(session.viewing.size.width), kLeastWidth, kMostWidth);
  const float height = std::clamp(width / aspect, 16.0f, kMostHeight);
  return {static_cast<std::uint32_t>(std::max(16.0f, std::min(width, height * aspect))),
          static_cast<std::uint32_t>(height)};
}

}  // namespace

bool CameraPreview::due(Session& session, std::uint64_t edits, bool stale) {
  const ecs::Entity camera = shownCamera(session);
  if (!session.document.registry().alive(camera)) {
    texture_ = {};
    camera_ = {};
    session.picture.preview_waits = false;
    return false;
  }
  if (!(camera == camera_) || edits != edits_) stale_ = true;
  stale_ = stale_ || stale;
  camera_ = camera, edits_ = edits;
  session.picture.preview_waits = stale_;
  return stale_ && session.picture.settled && !session.viewing.scale.coarse();
}

Result<void> CameraPreview::draw(Session& session, frame::Frame& frame) {
  stale_ = session.picture.preview_waits = false;
  const float aspect = aspectOf(session, camera_);
  const spec::Size size = sizeOf(session, aspect);
  const auto view = viewOfCamera(session, camera_, aspect);
  if (!view) return failAgain(view.error());
  Stage& stage = session.stage;
  frame::FrameSettings settings = stage.settings();
  settings.exposure_ev = session.picture.exposure_ev;  // as the view beside it
  if (auto set = frame.setSettings(settings); !set) return set;
  frame.resize(size);
  frame.setView({});
  frame.setOverlays({});
  if (auto drawn = frame.render(stage.world(), stage.environment(), *view); !drawn) return drawn;
  const gpu::TextureDesc& desc = frame.picture().desc();
  if (!texture_ || texture_.desc().width != desc.width || texture_.desc().height != desc.height)
    texture_ =
        gpu::Texture("camera preview", {.format = desc.format, .width = desc.width, .height = desc.height});
  glCopyImageSubData(frame.picture().id(), GL_TEXTURE_2D, 0, 0, 0, 0, texture_.id(), GL_TEXTURE_2D, 0, 0, 0,
                     0, static_cast<GLsizei>(desc.width), static_cast<GLsizei>(desc.height), 1);
  return {};
}

}  // namespace lambent::editor
