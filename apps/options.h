#pragma once

#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "devices/lcm/url.h"
#include "scene/record/log.h"

/// Options of several commands.
namespace headpin::apps {

/// A file or folder to write. An empty name is wrong use, and so is the ending of a kind of file that
/// the command does not write.
/// @param endings  of the files that it writes, such as `.svg`; none where it writes a folder
CLI::Option* add_output(CLI::App& command, const std::string& names,
                        std::optional<std::string>& value, const std::string& help,
                        std::vector<std::string> endings);
CLI::Option* add_force(CLI::App& command, bool& value);
CLI::Option* add_json(CLI::App& command, bool& value);

/// --gl: osmesa or egl; if empty, the first of them that works.
CLI::Option* add_gl(CLI::App& command, std::string& value);

/// --states: `changes`, or `all` states whole.
CLI::Option* add_states(CLI::App& command, scene::States& value);

/// --longest-gap: longest accepted gap between samples in seconds.
CLI::Option* add_longest_gap(CLI::App& command, double& value);

/// The LCM URL of an option such as --lcm.
/// @throws UsageError  naming the option and the URL
devices::LcmUrl lcm_url(const std::string& option, const std::string& typed, devices::LcmUse use);

/// --duration in seconds.
CLI::Option* add_duration(CLI::App& command, std::optional<double>& value, const std::string& help);

/// A finite number from `low` to `high`; CLI11's own check lets NaN through.
CLI::Validator number_from(double low, double high);

/// A whole number from `low` to `high`.
CLI::Validator whole_number_from(long long low, long long high);

/// A name with that ending.
CLI::Validator ending_in(std::string ending);

/// One of some words; the error names the nearest one.
CLI::Validator one_of(std::vector<std::string> words);

/// A whole number from 0 to 2^64 - 1; CLI11 reads -1 as the largest.
CLI::Validator seed();

}  // namespace headpin::apps
