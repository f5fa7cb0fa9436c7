// Holds what the passes of a frame share, found by its type: lights of groups, shaded samples, shadow maps. A
// pass offers its own objects once, when it is made, and they live as long as the frame.
#pragma once

#include <cassert>
#include <map>
#include <typeindex>
#include <vector>

namespace lambent::frame {

// Lists the types that a pass reads or writes.
using Resources = std::vector<std::type_index>;
template <class... Types>
Resources resources() {
  return {std::type_index(typeid(Types))...};
}

class Blackboard {
 public:
  // Offers an object. There may be only one of each type.
  template <class Type>
  void offer(Type& object) {
    const bool first = objects_.emplace(typeid(Type), &object).second;
    assert(first);
    (void)first;
  }
  // Returns the object of a type, which must have been offered.
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
