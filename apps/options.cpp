#include "apps/options.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/command.h"
#include "apps/output_name.h"
#include "render/gl_context.h"
#include "scene/scenario/nearest.h"

namespace headpin::apps {

namespace {

/// Reads all of a text as a number.
template <typename T>
std::optional<T> whole(const std::string& text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// The error in the name of an OpenGL context; empty if it is correct.
std::string wrong_context(std::string_view name) {
  if (render::is_context_name(name)) return "";
  return fmt::format("expected osmesa, egl, egl:auto or egl:NUMBER, found '{}'", name);
}

}  // namespace

CLI::Option* add_output(CLI::App& command, const std::string& names,
                        std::optional<std::string>& value, const std::string& help,
                        std::vector<std::string> endings) {
  return command.add_option(names, value, help)
      ->check(CLI::Validator(
          [endings = std::move(endings)](std::string& name) { return wrong_output(name, endings); },
          ""));
}

CLI::Option* add_force(CLI::App& command, bool& value) {
  return command.add_flag("--force", value, "replace existing output files");
}

CLI::Option* add_json(CLI::App& command, bool& value) {
  return command.add_flag("--json", value, "print one JSON object, also when it fails");
}

CLI::Option* add_gl(CLI::App& command, std::string& value) {
  // Without CLI11's envname: with it, even commands that do not draw would check the variable.
  command.parse_complete_callback([&value] {
    const char* const variable = std::getenv("HEADPIN_GL");
    if (!value.empty() || !variable || *variable == '\0') return;
    value = variable;
    if (const std::string wrong = wrong_context(value); !wrong.empty()) {
      throw UsageError("HEADPIN_GL in the environment: " + wrong);
    }
  });
  return command
      .add_option("--gl", value,
                  "OpenGL context: osmesa or egl draw on the processor; egl:auto or egl:NUMBER "
                  "draw on a device that `headpin doctor` lists, such as a graphics card; default: "
                  "HEADPIN_GL, or else the first of osmesa and egl that works")
      ->check(CLI::Validator([](std::string& name) { return wrong_context(name); },
                             "osmesa|egl|egl:auto|egl:N"));
}

CLI::Option* add_states(CLI::App& command, scene::States& value) {
  return command
      .add_option_function<std::string>(
          "--states",
          [&value](const std::string& name) {
            value = name == "all" ? scene::States::all : scene::States::changes;
          },
          "how the states of the ticks are stored. changes: only what changed, and a whole state "
          "about once a second; all: every state whole, for readers of format 1 [changes]")
      ->check(one_of({"changes", "all"}));
}

CLI::Option* add_longest_gap(CLI::App& command, double& value) {
  return command
      .add_option("--longest-gap", value,
                  "longest accepted gap between samples, in seconds; a longer one means that the "
                  "trial is damaged")
      ->check(number_from(0.001, 1e6))
      ->capture_default_str();
}

devices::LcmUrl lcm_url(const std::string& option, const std::string& typed, devices::LcmUse use) {
  try {
    return devices::LcmUrl(typed, option + " ", use);
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
}

CLI::Option* add_duration(CLI::App& command, std::optional<double>& value,
                          const std::string& help) {
  return command.add_option("--duration", value, help)->check(number_from(0.001, 1e6));
}

CLI::Validator number_from(double low, double high) {
  return CLI::Validator(
      [low, high](std::string& text) {
        const std::optional<double> value = whole<double>(text);
        if (value && *value >= low && *value <= high) return std::string();
        return fmt::format("expected a number from {} to {}, found {}", low, high, text);
      },
      fmt::format("{} to {}", low, high));
}

CLI::Validator whole_number_from(long long low, long long high) {
  return CLI::Validator(
      [low, high](std::string& text) {
        const std::optional<long long> value = whole<long long>(text);
        if (value && *value >= low && *value <= high) return std::string();
        return fmt::format("expected a whole number from {} to {}, found {}", low, high, text);
      },
      fmt::format("{} to {}", low, high));
}

CLI::Validator ending_in(std::string ending) {
  return CLI::Validator(
      [ending = std::move(ending)](std::string& name) {
        if (std::filesystem::path(name).extension() == ending) return std::string();
        return fmt::format("expected a name that ends in {}, found {}", ending, name);
      },
      "");
}

CLI::Validator one_of(std::vector<std::string> words) {
  const std::string all = fmt::format("{{{}}}", fmt::join(words, ","));
  return CLI::Validator(
      [words = std::move(words)](std::string& text) {
        if (std::ranges::count(words, text) > 0) return std::string();
        const bool number = text.find_first_not_of("0123456789.") == text.npos;
        const std::optional<std::string> meant =
            number ? std::nullopt : scene::nearest(text, words);
        return fmt::format("expected {}, found {}{}", either_of(words), text,
                           meant ? fmt::format("; the nearest is {}", *meant) : "");
      },
      all);
}

CLI::Validator seed() {
  return CLI::Validator(
      [](std::string& text) {
        if (whole<std::uint64_t>(text)) return std::string();
        return fmt::format("expected a whole number from 0 to 2^64 - 1, found {}", text);
      },
      "");
}

}  // namespace headpin::apps
