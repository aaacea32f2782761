#pragma once

#include <functional>
#include <thread>
#include <vector>

/// Work that several threads share.
namespace headpin::base {

/// Begins threads that each call `work`: `wanted` of them, or as many as the system makes.
///
/// @return  none where no thread can be made; then whoever called does the work
std::vector<std::jthread> begin_threads(int wanted, const std::function<void()>& work);

/// Calls `work` in as many threads, and waits for them; in this one where none can be made.
///
/// @param work  takes what nobody has taken, until nothing is left; throws nothing
void in_threads(int wanted, const std::function<void()>& work);

}  // namespace headpin::base
