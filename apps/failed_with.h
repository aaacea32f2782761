#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

namespace headpin::apps {

/// A failure of a command that has results to tell. With --json they are in the object that tells the failure.
struct FailedWith : std::runtime_error {
  FailedWith(const std::string& why, nlohmann::ordered_json its_results)
      : std::runtime_error(why), results(std::move(its_results)) {}

  nlohmann::ordered_json results;  ///< an object
};

}  // namespace headpin::apps
