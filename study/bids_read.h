#pragma once

#include <map>
#include <string>
#include <vector>

#include "study/bids.h"

namespace headpin::study {

/// A session read back from the tables of its trackers and events.
struct BidsTrial {
  scene::TrialHeader header;
  std::vector<devices::Sample> samples;  ///< in the order of the log
  Time end{};                            ///< of the session; 0 if the sidecar does not tell
};

/// @param texts  by name, as session_files() gives them, the folders left out
/// @throws std::invalid_argument  naming file and line: a table that does not fit its channels, what
///                                is no number, a session that headpin did not write or
///                                that lacks a table or a row
BidsTrial session_of(const std::map<std::string, std::string>& texts);

}  // namespace headpin::study
