// Defines a pass of the frame: an effect, or a stage that effects need. A pass declares what it reads and
// writes, says whether it is due, and updates what it keeps. The frame runs a list of passes (pass_list.hpp),
// times each, and knows nothing else of them. The passes of a step come first; those of a picture have a
// view.
//
// A resource is a type on the blackboard, or World and PictureTargets, which the context provides itself. Of
// `reads`, a pass sees what earlier passes wrote in this step; of `reads_before`, what the step before left,
// because light between bodies travels once per step.
#pragma once

#include <string_view>
#include <utility>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/frame/blackboard.hpp"
#include "runtime/frame/frame_context.hpp"
#include "runtime/frame/invalidation_log.hpp"

namespace lambent::frame {

struct PassInfo {
  std::string_view name;  // name in timings
  Resources reads{};
  Resources reads_before{};
  Resources writes{};
  std::uint32_t causes = 0;                // causes in the invalidation log that make it run
  std::vector<std::string_view> counts{};  // names of what it counts
};

class FramePass {
 public:
  explicit FramePass(PassInfo info) : info_(std::move(info)) {}
  virtual ~FramePass() = default;
  FramePass(const FramePass&) = delete;
  FramePass& operator=(const FramePass&) = delete;

  const PassInfo& info() const { return info_; }
  // Returns whether the pass has anything to update. A pass that is not due may release what it holds.
  virtual bool due(const FrameContext&) { return true; }
  virtual Result<void> update(FrameContext& frame) = 0;
  // Makes the next update compute everything anew.
  virtual void forget() {}
  // Returns whether another step on the same scene would change nothing.
  virtual bool settled() const { return true; }

 private:
  PassInfo info_;
};

}  // namespace lambent::frame
