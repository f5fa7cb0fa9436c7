// A pass of the frame: an effect, or a stage that effects need. It declares what it reads and writes, says
// whether it is due, and brings what it keeps up to date; the frame walks a list of them (pass_list.hpp),
// times each, and knows no more of any. Passes of a step come first, those of a picture have a view.
//
// A resource is a type on the blackboard, or World and PictureTargets, which the context hands out itself. A
// pass reads what passes before it in the list wrote in this step, and of `reads_before` what the step before
// left: light that bodies throw on each other travels one step a frame.
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
  std::string_view name;  // as it is timed
  Resources reads{};
  Resources reads_before{};
  Resources writes{};
  std::uint32_t causes = 0;                // of the invalidation log, that make it run
  std::vector<std::string_view> counts{};  // names of what it counts
};

class FramePass {
 public:
  explicit FramePass(PassInfo info) : info_(std::move(info)) {}
  virtual ~FramePass() = default;
  FramePass(const FramePass&) = delete;
  FramePass& operator=(const FramePass&) = delete;

  const PassInfo& info() const { return info_; }
  // Whether it has anything to bring up to date. One that is not due may let go of what it holds.
  virtual bool due(const FrameContext&) { return true; }
  virtual Result<void> update(FrameContext& frame) = 0;
  // The next update computes everything anew.
  virtual void forget() {}
  // Whether another step on the same scene would change nothing.
  virtual bool settled() const { return true; }

 private:
  PassInfo info_;
};

}  // namespace lambent::frame
