#include "apps/priority.h"

#include <thread>

#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

namespace headpin::apps {

Priority go_first() {
  sched_param least{};
  least.sched_priority = sched_get_priority_min(SCHED_FIFO);
  if (std::thread::hardware_concurrency() > 1 && sched_setscheduler(0, SCHED_FIFO, &least) == 0) {
    return Priority::real_time;
  }
  const bool raised = setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), -10) == 0;
  return raised ? Priority::raised : Priority::same;
}

Priority to_be_had() {
  Priority found = Priority::same;
  std::thread([&found] { found = go_first(); }).join();  // only this thread gets the priority
  return found;
}

}  // namespace headpin::apps
