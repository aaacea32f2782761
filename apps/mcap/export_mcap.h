#pragma once

#include <string>

#include "base/output_file.h"

namespace headpin::apps {

/// Simulates a trial again, writes it as MCAP and prints what is in it.
///
/// @param file      for the result
/// @param pictures  with those of both eyes
void export_mcap(const std::string& trial, base::OutputFile file, bool pictures, bool json);

}  // namespace headpin::apps
