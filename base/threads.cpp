#include "base/threads.h"

#include <new>
#include <system_error>

namespace headpin::base {

std::vector<std::jthread> begin_threads(int wanted, const std::function<void()>& work) {
  std::vector<std::jthread> threads;
  try {
    for (int i = 0; i < wanted; ++i) threads.emplace_back(work);
  } catch (const std::system_error&) {  // a limit on threads or addresses is reached
  } catch (const std::bad_alloc&) {
  }
  return threads;
}

void in_threads(int wanted, const std::function<void()>& work) {
  if (begin_threads(wanted, work).empty()) work();
}

}  // namespace headpin::base
