#pragma once

#include "apps/import_options.h"

/// Imports trials that `headpin export --xdf` wrote.
namespace headpin::apps {

/// Whether this is the file of such a trial. With options that say how a recording is read (axes, columns, names) it
/// is read as any other.
bool is_xdf_session(const ImportOptions& options);

/// Makes the trial again: the same samples, in the same order, under the same header, and the events
/// outside the simulation. With --explain, says so.
void import_xdf_session(const ImportOptions& options);

}  // namespace headpin::apps
