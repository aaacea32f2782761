#pragma once

/// Scheduling priorities.
namespace headpin::apps {

enum class Priority { real_time, raised, same };

/// Raises the priority of the calling thread and of threads that it starts later.
///
/// Uses real-time scheduling if that is allowed (CAP_SYS_NICE, or `ulimit -r` of 1) and there is
/// another processor for other programs. Otherwise it raises the nice value, which by default Linux
/// applies only among the programs of one login session.
///
/// @return  the achieved priority
Priority go_first();

/// The priority that go_first() would achieve.
Priority to_be_had();

}  // namespace headpin::apps
