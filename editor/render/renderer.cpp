#include "editor/render/renderer.hpp"

#include <algorithm>
#include <utility>

#include "editor/session/viewing.hpp"
#include "runtime/frame/frame_parts.hpp"

namespace lambent::editor {

PictureClock::Query PictureClock::timestamp() {
  if (free_.empty()) {
    GLuint id = 0;
    glCreateQueries(GL_TIMESTAMP, 1, &id);
    free_.emplace_back(id);
  }
  Query query = std::move(free_.back());
  free_.pop_back();
  glQueryCounter(query.id(), GL_TIMESTAMP);
  return query;
}

void PictureClock::begin() {
  begun_ = std::chrono::steady_clock::now();
  first_ = timestamp();
}

void PictureClock::end(bool whole) {
  const std::chrono::duration<double, std::milli> cpu = std::chrono::steady_clock::now() - begun_;
  Query last = timestamp();
  pictures_.push_back({std::move(first_), std::move(last), cpu.count(), whole});
  glFlush();  // otherwise a driver may hold the commands back until something else is drawn
}

std::optional<PictureClock::Time> PictureClock::take() {
  if (pictures_.empty()) return std::nullopt;
  Picture& oldest = pictures_.front();
  GLint ready = 0;
  glGetQueryObjectiv(oldest.last.id(), GL_QUERY_RESULT_AVAILABLE, &ready);
  if (ready == 0) return std::nullopt;
  GLuint64 from_ns = 0, to_ns = 0;
  glGetQueryObjectui64v(oldest.first.id(), GL_QUERY_RESULT, &from_ns);
  glGetQueryObjectui64v(oldest.last.id(), GL_QUERY_RESULT, &to_ns);
  const double gpu_ms = 1e-6 * static_cast<double>(to_ns - std::min(from_ns, to_ns));
  const Time time{std::max(gpu_ms, oldest.cpu_ms), oldest.whole};
  free_.push_back(std::move(oldest.first));
  free_.push_back(std::move(oldest.last));
  pictures_.pop_front();
  return time;
}

namespace {

// Returns the overlays that are asked for, with boxes around what is selected.
frame::OverlayOptions overlaysOf(const Session& session) {
  frame::OverlayOptions overlays = session.viewing.overlays;
  if (!session.handles.shown) return overlays;
  // A light that is selected shows its size and cones.
  const ecs::Entity primary = session.selection.primaryEntity(session.document);
  overlays.lights |= session.document.registry().has<scene::LocalLightComponent>(primary);
  constexpr glm::vec4 kColor(1.0f, 0.62f, 0.2f, 0.9f);
  for (const TurnedBox& turned : selectionBoxes(session.document, session.selection)) {
    const scene::Box& box = turned.box;
    const auto corner = [&](int i) {
      return glm::vec3(turned.world_from_box * glm::vec4((i & 1) != 0 ? box.max.x : box.min.x,
                                                         (i & 2) != 0 ? box.max.y : box.min.y,
                                                         (i & 4) != 0 ? box.max.z : box.min.z, 1.0f));
    };
    for (int i = 0; i < 8; ++i)
      for (const int bit : {1, 2, 4})
        if ((i & bit) == 0) overlays.lines.push_back({corner(i), corner(i | bit), kColor});
  }
  return overlays;
}

// Returns a number that rises with every edit and selection that changes the picture.
std::uint64_t editsVersion(const Session& session) {
  return session.history.version() + session.selection.version();
}

}  // namespace

Result<Picture> Picture::create(const Session& session) {
  auto frame = frame::Frame::create({.size = session.viewing.size, .output = frame::Output::Display},
                                    session.stage.environment());
  if (!frame) return failAgain(frame.error());
  return Picture(std::move(*frame));
}

Result<std::optional<frame::Picked>> Picture::pick(Session& session, float x, float y) {
  return frame_.pick(session.stage.world(), session.viewing.shown_view, x, y);
}

// Reads what is known only once the GPU has finished, so that nothing waits for it.
void Picture::readFinished(Session& session) {
  PictureFacts& facts = session.picture;
  while (const auto time = clock_.take()) {
    facts.times.add(time->milliseconds);
    if (time->whole) session.viewing.scale.wholeTook(time->milliseconds);
  }
  facts.in_flight = clock_.inFlight();
  if (facts.in_flight || !std::exchange(unread_, false)) return;
  facts.negative_pixels = frame_.negativePixels();
  facts.exposure_ev = frame_.exposureEv();
}

Result<void> Picture::draw(Session& session, const spec::View& view, spec::Size size) {
  Stage& stage = session.stage;
  if (!(size == frame_.options().size)) frame_.resize(size);
  if (auto set = frame_.setSettings(stage.settings()); !set) return set;
  frame_.setView(session.viewing.surfaces);
  frame_.setOverlays(overlaysOf(session));
  stage.followEnvironment();
  stage.world().updateTransforms();
  if (auto drawn = frame_.render(stage.world(), stage.environment(), view); !drawn) return drawn;
  PictureFacts& facts = session.picture;
  const frame::StepCounts& counts = facts.counts = frame_.counts();
  facts.legend = frame_.legend();
  facts.passes = frame_.timers().latest();
  facts.volume_bytes = frame_.parts().volume.textureBytes();
  facts.settled = stage.world().loaded() && counts["light_probes_captured"] == 0 &&
                  counts["light_probes_waiting"] == 0 && counts["cells_shaded"] == 0 &&
                  counts["draws_shaded"] == 0 && counts["reflection_probes_captured"] == 0;
  return {};
}

void Picture::update(Session& session, spec::Size size) {
  readFinished(session);
  Viewing& viewing = session.viewing;
  viewing.size = size;
  const auto view = viewing.view(session.document, size);
  if (!view) return session.log.error(view.error());
  viewing.shown_view = *view;
  const bool resized = !(size == drawn_.size);
  // Another size changes the aspect, which does not count as movement: otherwise slow pictures would be drawn
  // coarse, that is at another size, and so on for ever.
  const bool view_moved = view->view_from_world != drawn_.view.view_from_world ||
                          (!resized && view->clip_from_view != drawn_.view.clip_from_view);
  const bool moved = view_moved || drawn_.edits != editsVersion(session);
  const bool live = session.playback.playing || !session.picture.settled;
  const bool needed = moved || resized || viewing.changed || live;
  const bool moves = moved || session.playback.playing || session.history.open();
  const bool coarse = viewing.scale.coarse();
  if (!moves && viewing.scale.settle()) viewing.changed = true;
  if (!needed) return;
  viewing.changed = false;
  drawn_ = {editsVersion(session), *view, size};
  clock_.begin();
  if (auto drawn = draw(session, *view, size); !drawn) session.log.error(drawn.error());
  clock_.end(/*whole=*/!coarse);
  viewing.scale.drawn(moves);
  session.picture.in_flight = unread_ = true;
  ++session.picture.drawn;
}

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
  if (!tone_mapper_) tone_mapper_.emplace(/*samples=*/0, /*linear=*/false);
  shown_ = textureOf("reference, shown", size, GL_RGBA8);
  shown_target_ = gpu::Framebuffer("reference, shown", shown_, nullptr);
  shown_target_.bind();
  gpu::Counters counters;
  if (auto done = tone_mapper_->run(radiance_, session.picture.exposure_ev, counters); !done) return done;
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
}

}  // namespace lambent::editor
