#include "runtime/frame/frame_context.hpp"

#include <algorithm>

#include "runtime/frame/frame_pass.hpp"

namespace lambent::frame {

void FrameContext::because(std::string_view otherwise) const {
  scope->because(log.of(pass->causes, otherwise));
}

bool FrameContext::declares(std::type_index type, bool to_write) const {
  const auto has = [&](const Resources& types) { return std::ranges::find(types, type) != types.end(); };
  return has(pass->writes) || (!to_write && (has(pass->reads) || has(pass->reads_before)));
}

}  // namespace lambent::frame
