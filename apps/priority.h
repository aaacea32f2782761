#pragma once

/// Who goes first where there are fewer processors than work.
namespace headpin::apps {

enum class Priority { real_time, raised, same };

/// Puts the calling thread, and those that it starts from now on, before what else the machine does.
///
/// By real-time scheduling where that is allowed (CAP_SYS_NICE, or `ulimit -r` of 1) and leaves
/// another processor to the others. A raised priority is the next best: it counts among the programs
/// of one session alone where the kernel groups them by session, as Linux does by default.
///
/// @return  what it got
Priority go_first();

/// What go_first() would get, without taking it.
Priority to_be_had();

}  // namespace headpin::apps
