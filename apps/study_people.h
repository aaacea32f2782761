#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "apps/study_folder.h"
#include "study/people.h"

/// The participants of a study with their data.
namespace headpin::apps {

/// Reads the answers and simulates the sessions of all participants again, several in parallel.
/// @throws std::invalid_argument  for answers that cannot be, naming file and line
std::vector<study::Person> people_of(const Study& study, int jobs);

/// The participants in the tables.
struct Counted {
  std::vector<study::Person> people;
  std::string of;  ///< "yes": virtual participants, "no": people, "mixed"; "n/a" if there are none
};

/// Which participants are counted together; people and virtual participants are not mixed by
/// default.
struct Mixing {
  bool mix = false;
  std::string only;  ///< people, virtual; empty for whoever there is
};
void add_mixing(CLI::App& command, Mixing& mixing);

/// @throws UsageError  for people and virtual participants together, unless that is wanted
Counted counted_of(const Study& study, const std::vector<study::Person>& all, const Mixing& mixing);

}  // namespace headpin::apps
