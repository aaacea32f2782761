#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "devices/trial/log.h"

/// Options that several commands have: one name, one check and one sentence each.
namespace headpin::apps {

/// A file or folder to write; an empty name is wrong use.
CLI::Option* add_output(CLI::App& command, const std::string& names,
                        std::optional<std::string>& value, const std::string& help);
CLI::Option* add_force(CLI::App& command, bool& value);
CLI::Option* add_json(CLI::App& command, bool& value);

/// What draws: osmesa, egl or, when empty, the first of them that does.
CLI::Option* add_gl(CLI::App& command, std::string& value);

/// How a trial tells states: `changes`, or `all` of them whole.
CLI::Option* add_states(CLI::App& command, devices::States& value);

/// Seconds without a sample that a trial may have before it is taken for damaged.
CLI::Option* add_longest_gap(CLI::App& command, double& value);

/// Seconds that something lasts.
CLI::Option* add_duration(CLI::App& command, std::optional<double>& value, const std::string& help);

/// A finite number from `low` to `high`; CLI11's own check lets NaN through.
CLI::Validator number_from(double low, double high);

/// A whole number from 0 to 2^64 - 1; CLI11 reads -1 as the largest.
CLI::Validator seed();

}  // namespace headpin::apps
