#include "editor/render/renderer.hpp"

#include <utility>

namespace lambent::editor {

namespace {

gpu::Texture textureOf(const char* label, spec::Size size, GLenum format) {
  return gpu::Texture(label, {.format = format, .width = size.width, .height = size.height});
}

void write(const gpu::Texture& texture, GLenum type, const void* texels) {
  glTextureSubImage2D(texture.id(), 0, 0, 0, static_cast<GLsizei>(texture.desc().width),
                      static_cast<GLsizei>(texture.desc().height), GL_RGBA, type, texels);
}

}  // namespace

Result<spec::RgbaImage> ReferencePicture::linearPicture(Session& session, spec::Size size) {
  Stage& stage = session.stage;
  if (!linear_) {
    auto made = frame::Frame::create(
        {.size = size, .output = frame::Output::Linear, .wait_for_captures = true}, stage.environment());
    if (!made) return failAgain(made.error());
    linear_ = std::move(*made);
  }
  linear_->resize(size);
  if (auto set = linear_->setSettings(stage.settings()); !set) return failAgain(set.error());
  if (auto drawn = linear_->render(stage.world(), stage.environment(), session.reference.view()); !drawn)
    return failAgain(drawn.error());
  return linear_->readLinear();
}

Result<void> ReferencePicture::show(Session& session, const baker::reference::Snapshot& snapshot) {
  const spec::Size size{snapshot.image.width, snapshot.image.height};
  radiance_ = textureOf("reference", size, GL_RGBA32F);
  write(radiance_, GL_FLOAT, snapshot.image.texels.data());
  if (!tone_mapper_) {
    auto made = frame::ToneMapper::create(/*samples=*/0, /*linear=*/false);
    if (!made) return failAgain(made.error());
    tone_mapper_ = std::move(*made);
  }
  shown_ = textureOf("reference, shown", size, GL_RGBA8);
  shown_target_ = gpu::Framebuffer("reference, shown", shown_, nullptr);
  glBindFramebuffer(GL_FRAMEBUFFER, shown_target_.id());
  glViewport(0, 0, static_cast<GLsizei>(size.width), static_cast<GLsizei>(size.height));
  gpu::Counters counters;
  tone_mapper_->run(radiance_, session.picture.exposure_ev, counters);
  if (snapshot.spp == 0 || !session.picture.settled) return {};
  return compare(session, snapshot);
}

Result<void> ReferencePicture::compare(Session& session, const baker::reference::Snapshot& snapshot) {
  const auto picture = linearPicture(session, {snapshot.image.width, snapshot.image.height});
  if (!picture) return failAgain(picture.error());
  const bool halves = snapshot.halves[0].width > 0 && snapshot.halves[1].width > 0;
  auto difference = baker::differenceOf(*picture, halves ? snapshot.halves[0] : snapshot.image,
                                        halves ? &snapshot.halves[1] : nullptr, {}, "reference");
  if (difference) {
    heat_ = textureOf("heat map", {snapshot.image.width, snapshot.image.height}, GL_RGBA8);
    write(heat_, GL_UNSIGNED_BYTE, difference->heat.texels.data());
  }
  session.reference.compared(std::move(difference));
  return {};
}

void ReferencePicture::update(Session& session) {
  ReferenceView& reference = session.reference;
  const bool any = reference.update(session);
  if (!reference.on()) linear_.reset();
  const auto now = any ? reference.snapshot() : nullptr;
  const float exposure_ev = session.picture.exposure_ev;
  const bool compared = reference.difference() || !session.picture.settled;
  if (!now || (now == reference.seen() && exposure_ev == exposure_ev_ && compared)) return;
  if (const auto done = show(session, *now); !done) session.log.error(done.error());
  reference.shown(now);
  exposure_ev_ = exposure_ev;
}

Result<Renderer> Renderer::create(const Session& session) {
  auto made = Picture::create(session);
  if (!made) return failAgain(made.error());
  return Renderer{.picture = std::move(*made)};
}

void Renderer::update(Session& session, spec::Size size) {
  picture.update(session, size);
  reference.update(session);
  session.settings.update(session);
  thumbnails.update(session);
  materials.update(session);
}

}  // namespace lambent::editor
