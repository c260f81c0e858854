// What a process that is about to end need not take apart.
#pragma once

#include <deque>
#include <type_traits>
#include <utility>

namespace hb::tools {

// Leaves a value of many small pieces to the end of the process, which does not take it apart piece by piece.
template <class Value>
void keep_until_exit(Value&& value) {
  static_assert(!std::is_reference_v<Value>, "what is kept is moved");
  static auto& kept = *new std::deque<Value>;  // reachable to the end
  kept.push_back(std::move(value));
}

}  // namespace hb::tools
