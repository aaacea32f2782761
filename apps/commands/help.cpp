#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "apps/command.h"
#include "apps/topics.h"
#include "apps/wrap.h"
#include "apps/wrong_use.h"
#include "scene/scenario/nearest.h"

namespace headpin::apps {

namespace {

/// All topics with the titles of their pages, and the folder of the pages.
void print_topics() {
  fmt::print("Topics; `headpin help TOPIC` prints the file of its page:\n");
  for (const Topic& topic : topics()) fmt::print("  {:<20}{}\n", topic.name, topic.title);
  fmt::print("All pages are in {}\n", docs_folder().string());
}

/// Prints the information about a topic. @return whether there is such a topic
bool print_topic(const std::string& name) {
  if (name == "topics") {
    print_topics();
    return true;
  }
  const std::optional<Topic> topic = find_topic(name);
  if (topic) fmt::print("{}\n{}\n", topic->title, (docs_folder() / topic->page).string());
  return topic.has_value();
}

/// Refuses a first word that is neither a command nor a topic.
void check_command_or_topic(const CLI::App& app, const std::vector<std::string>& words) {
  if (find_command(app, words.front())) return;
  if (words.front() == "topics" || find_topic(words.front())) {
    throw UsageError(
        fmt::format("expected no word behind the topic {}, found {}", words.front(), words[1]));
  }
  std::vector<std::string> names = {"topics"};
  for (const Topic& topic : topics()) names.emplace_back(topic.name);
  if (const std::optional<std::string> meant = scene::nearest(words.front(), names)) {
    throw UsageError(
        fmt::format("no command or topic '{}'; the nearest topic is {}", words.front(), *meant));
  }
  check_command(app, words.front());
}

void help(const CLI::App& app, const std::vector<std::string>& words) {
  if (words.size() == 1 && print_topic(words.front())) return;
  if (!words.empty()) check_command_or_topic(app, words);
  const CLI::App* at = &app;
  std::string before;
  for (const std::string& word : words) {
    check_command(*at, word);
    before += (before.empty() ? "" : " ") + at->get_name();
    at = find_command(*at, word);
  }
  const std::string name = before.empty() ? at->get_name() : before + " " + at->get_name();
  const std::string text = at->get_formatter()->make_help(at, name, CLI::AppFormatMode::Normal);
  fmt::print("{}", wrapped(text, terminal_width()));
}

}  // namespace

void add_help(CLI::App& app) {
  const auto words = std::make_shared<std::vector<std::string>>();
  CLI::App* command =
      app.add_subcommand("help", "Show how to use a command, or which page explains a topic");
  command->add_option("COMMAND", *words,
                      "a command such as replay, or a topic; `topics` lists the topics; default: "
                      "list all commands");
  command->footer("Examples:\n  headpin help replay\n  headpin help topics");
  command->callback([words, &app] { help(app, *words); });
}

}  // namespace headpin::apps
