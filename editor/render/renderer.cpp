#include "editor/render/renderer.hpp"

#include <utility>

namespace lambent::editor {

Result<Renderer> Renderer::create(const Session& session) {
  auto picture = Picture::create(session);
  if (!picture) return failAgain(picture.error());
  return Renderer(std::move(*picture));
}

void Renderer::update(Session& session, spec::Size size) {
  picture_.update(session, size);
  reference_.update(session);
  session.settings.update(session);
  session.qualities.update(session);
  thumbnails_.update(session, picture_.texture());
  materials_.update(session);
}

}  // namespace lambent::editor
