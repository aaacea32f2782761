#pragma once

#include <vector>

#include "scene/record/trial.h"

/// JSON of what was amiss in a trial, as `info` and the page show it.
namespace headpin::scene {

/// Numbers of bytes and messages that were left out while a trial was read.
/// @tparam Json  a class of nlohmann's: sorted or in this order
template <typename Json>
Json skipped_json(const Skipped& skipped) {
  return {{"bytes", skipped.bytes},
          {"cut_bytes", skipped.cut_bytes},
          {"undecodable", skipped.undecodable},
          {"implausible", skipped.implausible},
          {"other_trials", skipped.other_trials},
          {"foreign", skipped.foreign},
          {"baseless", skipped.baseless},
          {"doubled", skipped.doubled},
          {"misdated", skipped.misdated}};
}

/// Times during which a device was in trouble.
/// @param seconds  gives a device time in seconds
template <typename Json, typename Seconds>
Json trouble_json(const std::vector<Trouble>& trouble, Seconds seconds) {
  Json out = Json::array();
  for (const Trouble& one : trouble) {
    out.push_back({{"kind", one.kind},
                   {"device", one.device},
                   {"messages", one.messages},
                   {"from_s", seconds(one.from)},
                   {"to_s", seconds(one.to)}});
  }
  return out;
}

}  // namespace headpin::scene
