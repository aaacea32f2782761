#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string_view>

/// The pages of the documentation by topic, for `headpin help TOPIC`.
namespace headpin::apps {

struct Topic {
  std::string_view name;   ///< what is typed
  std::string_view page;   ///< its file in docs/
  std::string_view title;  ///< the heading of that file
};

/// All topics, in the order of docs/README.md. No topic has the name of a command.
std::span<const Topic> topics();

/// Nothing for an unknown topic.
std::optional<Topic> find_topic(std::string_view name);

/// The folder of the pages: in share/doc/headpin once installed, else in the sources. Only `docs`
/// where neither is found.
std::filesystem::path docs_folder();

}  // namespace headpin::apps
