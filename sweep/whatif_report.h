#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sweep/whatif.h"

/// The tables and pictures of a what-if.
namespace headpin::sweep {

/// One of the participant's own throws.
struct OwnThrow {
  std::string trial;  ///< name of its file
  int number = 0;     ///< in its trial, from 1
  scene::ThrowRow thrown;
  std::optional<Execution> execution;
};

/// Everything that was simulated about one throw.
struct WhatIf {
  std::string trial;
  int number = 0;  ///< of the throw in its trial, from 1
  scene::ThrowRow thrown;
  Outcome real;              ///< of the release as it was
  std::int64_t rack = 0;     ///< skittles
  std::int64_t success = 0;  ///< so many skittles down are a success
  std::vector<Release> moments;
  std::vector<Outcome> of_moments;
  std::optional<Window> window;
  ReleaseGrid grid;
  std::vector<Outcome> of_grid;
  std::optional<MissRooms> miss;  ///< nothing where the grid has one board
  std::vector<OwnThrow> own;      ///< of all trials that were given
  std::optional<Costs> costs;
  std::vector<std::size_t> in_costs;  ///< which of `own`, in the order of `costs->down`
};

}  // namespace headpin::sweep
