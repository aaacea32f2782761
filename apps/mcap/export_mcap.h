#pragma once

#include <string>

namespace headpin::apps {

struct McapOptions {
  std::string trial, file;
  bool pictures = false;  ///< of both eyes
  bool force = false, json = false;
};

/// Simulates a trial again and writes it as MCAP.
void export_mcap(const McapOptions& options);

}  // namespace headpin::apps
