#include "apps/given_options.h"

namespace headpin::apps {

std::vector<std::string> given_options(const CLI::App& command,
                                       const std::set<const CLI::Option*>& without) {
  std::vector<std::string> words;
  for (const CLI::Option* option : command.get_options()) {
    if (without.contains(option)) continue;
    const std::vector<std::string>& values = option->results();
    if (values.size() == 1 && values.front() == option->get_default_str()) continue;
    for (const std::string& value : values) words.push_back(option->get_name() + "=" + value);
  }
  return words;
}

}  // namespace headpin::apps
