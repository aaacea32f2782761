#pragma once

#include <string>

#include "base/output_file.h"

/// Imports sessions that `headpin experiment export` wrote.
namespace headpin::apps {

/// Whether this is the table of a tracker of such a session.
bool is_bids_session(const std::string& path);

/// Makes the trial again: the same samples, in the same order, under the same header.
///
/// @param path    the table of one of its trackers
/// @param output  for the trial
void import_bids_session(const std::string& path, base::OutputFile output, bool json);

}  // namespace headpin::apps
