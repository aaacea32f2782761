#pragma once

#include "apps/import_options.h"

/// Imports complete trials that headpin wrote in another format.
namespace headpin::apps {

/// Makes the trial again: the same samples, in an order of the same effect, under the same header, and the events
/// outside the simulation. Reads what `export` and `experiment export` write: tables, XDF, Motion-BIDS. With --explain,
/// says so. With options that say how a recording is read (axes, columns, names), it is read as any other.
///
/// @return  whether the file is such a trial; nothing is written if not
/// @throws UsageError             an option that a complete trial does not need
/// @throws std::invalid_argument  naming file and line of what is damaged
bool import_session(const ImportOptions& options);

}  // namespace headpin::apps
