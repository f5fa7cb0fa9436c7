// What passes of a frame keep for each other, found by its type: lights of groups, shaded samples, shadow
// maps. A pass offers its own objects once, when it is made, and they live as long as the frame.
#pragma once

#include <cassert>
#include <map>
#include <typeindex>
#include <vector>

namespace lambent::frame {

// Types that stand for what a pass reads and writes.
using Resources = std::vector<std::type_index>;
template <class... Types>
Resources resources() {
  return {std::type_index(typeid(Types))...};
}

class Blackboard {
 public:
  // One object of each type.
  template <class Type>
  void offer(Type& object) {
    const bool first = objects_.emplace(typeid(Type), &object).second;
    assert(first);
    (void)first;
  }
  // Something of the type must have been offered.
  template <class Type>
  Type& get() const {
    const auto found = objects_.find(typeid(Type));
    assert(found != objects_.end());
    return *static_cast<Type*>(found->second);
  }

 private:
  std::map<std::type_index, void*> objects_;
};

}  // namespace lambent::frame
