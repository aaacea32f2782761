#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <memory>

#include <fmt/format.h>

#include "apps/command.h"
#include "apps/environment.h"
#include "apps/reference.h"
#include "apps/topics.h"
#include "base/shell_word.h"
#include "devices/base/version.h"
#include "scene/scenario/files.h"
#include "scene/scenario/keys.h"
#include "scene/scenario/scenario.h"

// Manual pages and shell completion, generated from the parser's own options so that they always
// agree. The build calls this after linking.

namespace headpin::apps {

namespace {

namespace fs = std::filesystem;

std::vector<const CLI::App*> commands(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
}

/// The visible options.
std::vector<const CLI::Option*> options(const CLI::App& command, bool positional) {
  return command.get_options([=](const CLI::Option* option) {
    return option->get_positional() == positional && !option->get_group().empty();
  });
}

/// The options of a command and, for a group, of all commands in it; each name once.
std::vector<const CLI::Option*> options_in(const CLI::App& command) {
  std::vector<const CLI::Option*> all = options(command, false);
  for (const CLI::App* one : commands(command)) {
    for (const CLI::Option* option : options(*one, false)) {
      const auto same = [&](const CLI::Option* other) {
        return other->get_name() == option->get_name();
      };
      if (std::ranges::none_of(all, same)) all.push_back(option);
    }
  }
  return all;
}

/// `-o`, `--output`: every name of an option as it is typed.
std::vector<std::string> names(const CLI::Option& option) {
  std::vector<std::string> all;
  for (const std::string& name : option.get_snames()) all.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) all.push_back("--" + name);
  return all;
}

bool takes_value(const CLI::Option& option) {
  return option.get_items_expected_max() != 0;  // a flag has a type, but expects nothing
}

bool may_be_repeated(const CLI::Option& option) {
  return option.get_expected_max() >= CLI::detail::expected_max_vector_size;
}

/// The allowed words for a value; empty if other values are allowed.
std::vector<std::string> choices(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{'), close = type.find('}');
  if (open == std::string::npos || close == std::string::npos) return {};
  return CLI::detail::split(type.substr(open + 1, close - open - 1), ',');
}

/// The placeholder of a value: its kind, or the allowed words.
std::string placeholder(const CLI::Option& option) {
  if (const auto words = choices(option); !words.empty())
    return fmt::format("{}", fmt::join(words, "|"));
  const std::string type = option.get_type_name();
  return type.starts_with("[") ? type : type.substr(0, type.find_first_of(": "));
}

/// Text with troff's special characters escaped.
std::string roff(std::string_view text) {
  std::string out;
  bool line_begins = true;
  for (const char c : text) {
    if (line_begins && (c == '.' || c == '\'')) out += "\\&";
    out += c == '\\' ? std::string("\\e") : c == '-' ? std::string("\\-") : std::string(1, c);
    line_begins = c == '\n';
  }
  return out;
}

std::string trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of('\n');
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(" \n") - first + 1));
}

/// Examples of a page name the bundled trial where a package puts it.
std::string with_installed_trial(const std::string& text) {
  return CLI::detail::find_and_replace(text, "assets/trials/", "/usr/share/headpin/trials/");
}

std::string as_written(const char* heading, const std::string& text) {
  if (text.empty()) return {};
  return fmt::format(".SH {}\n.nf\n{}\n.fi\n", heading, roff(text));
}

std::string roff_option(const CLI::Option& option) {
  std::string line;
  for (const std::string& name : names(option)) {
    line += fmt::format("{}\\fB{}\\fR", line.empty() ? "" : ", ", roff(name));
  }
  if (takes_value(option)) line += fmt::format(" \\fI{}\\fR", roff(placeholder(option)));
  std::string says = option.get_description();
  if (!option.get_default_str().empty())
    says += fmt::format(" (default {})", option.get_default_str());
  if (option.get_required()) says += " (needed)";
  return fmt::format(".TP\n{}\n{}\n", line, roff(says));
}

std::string page_begins(const std::string& name, const std::string& says) {
  const std::string title = CLI::detail::to_lower(name);
  std::string upper = title;
  std::ranges::transform(upper, upper.begin(), [](unsigned char c) { return std::toupper(c); });
  return fmt::format(".TH {} 1 \"\" \"headpin {}\" \"headpin\"\n.SH NAME\n{} \\- {}\n", roff(upper),
                     devices::software_version(), roff(title), roff(says));
}

constexpr const char* kExitStatus =
    ".SH EXIT STATUS\n0 done, 1 failed (one line on standard error says why), 2 wrong use, 75 what "
    "is "
    "needed is in use by another headpin and may be free later, 128+N stopped by signal N.\n";

/// The commands of a group, as a list; empty for a command that is not a group.
std::string group_in_words(const CLI::App& command, const std::string& words) {
  std::string listed;
  for (const CLI::App* one : commands(command)) {
    listed += fmt::format(".TP\n\\fBheadpin {} {}\\fR\n{}\n", roff(words), roff(one->get_name()),
                          roff(one->get_description()));
  }
  return listed.empty() ? listed : ".SH COMMANDS\n" + listed;
}

/// The manual page of one command.
///
/// @param words  the words of the command: "replay", "experiment plan"
std::string page(const CLI::App& command, const std::string& words) {
  const std::string name = "headpin-" + CLI::detail::find_and_replace(words, " ", "-");
  std::string synopsis = "\\fBheadpin " + roff(words) + "\\fR";
  std::string arguments;
  for (const CLI::Option* option : options(command, true)) {
    std::string word = option->get_name(true);
    std::ranges::transform(word, word.begin(), [](unsigned char c) { return std::toupper(c); });
    synopsis +=
        option->get_required() ? " \\fI" + roff(word) + "\\fR" : " [\\fI" + roff(word) + "\\fR]";
    arguments += fmt::format(".TP\n\\fI{}\\fR\n{}\n", roff(word), roff(option->get_description()));
  }
  std::string listed, group;
  for (const CLI::Option* option : options(command, false)) {
    if (option->get_group().empty()) continue;
    if (option->get_group() != group && option->get_group() != "Options") {
      group = option->get_group();
      listed += fmt::format(".SS {}\n", roff(group));
    }
    listed += roff_option(*option);
  }
  const std::string footer = with_installed_trial(command.get_footer());
  const std::size_t example = footer.rfind("Example:");
  const bool has_example = example != std::string::npos;
  return page_begins(name, command.get_description()) +
         fmt::format(".SH SYNOPSIS\n{} [\\fIOPTIONS\\fR]\n", synopsis) +
         group_in_words(command, words) + (arguments.empty() ? "" : ".SH ARGUMENTS\n" + arguments) +
         ".SH OPTIONS\n" + listed +
         as_written("NOTES", trimmed(footer.substr(0, has_example ? example : footer.size()))) +
         (has_example ? as_written("EXAMPLE", trimmed(footer.substr(example + 8))) : "") +
         kExitStatus + ".SH SEE ALSO\n.BR headpin (1)\n";
}

std::string overview(const CLI::App& app) {
  std::string listed, see;
  for (const CLI::App* command : commands(app)) {
    listed += fmt::format(".TP\n\\fBheadpin {}\\fR\n{}\n", roff(command->get_name()),
                          roff(command->get_description()));
    see +=
        fmt::format("{}.BR headpin\\-{} (1)", see.empty() ? "" : ",\n", roff(command->get_name()));
  }
  std::string scenarios;
  for (const std::string& name : scene::scenario_names()) {
    scenarios += (scenarios.empty() ? "" : ", ") + name;
  }
  std::string taken, environment;
  for (const CLI::Option* option : options(app, false)) taken += roff_option(*option);
  for (const auto& [name, says] : kEnvironment) {
    environment += fmt::format(".TP\n\\fB{}\\fR\n{}\n", name, roff(says));
  }
  return page_begins("headpin", "a headless immersive bowling simulator with tracked devices") +
         ".SH SYNOPSIS\n\\fBheadpin\\fR \\fICOMMAND\\fR [\\fIARGUMENTS\\fR]\n"
         ".SH DESCRIPTION\nSamples of trackers go in; a hand, a ball and skittles are simulated "
         "from "
         "them, to the bit;\nwhat happened and what each eye saw comes out. A trial is one LCM "
         "event "
         "log that has it all.\n.SH COMMANDS\n" +
         listed + ".SH OPTIONS\n" + taken + ".SH SCENARIOS\n" + roff(scenarios) + "\n" +
         kExitStatus + ".SH ENVIRONMENT\n" + environment + ".SH SEE ALSO\n" + see + "\n";
}

std::vector<std::string> names_of(const std::vector<const CLI::App*>& commands) {
  std::vector<std::string> all;
  for (const CLI::App* command : commands) all.push_back(command->get_name());
  return all;
}

/// Keys of scenarios as they are typed behind `--set`, without entries of lists.
std::vector<scene::ScenarioKey> typed_keys() {
  std::vector<scene::ScenarioKey> keys = scene::scenario_keys();
  std::erase_if(keys, [](const scene::ScenarioKey& key) {
    return key.kind == "table" || key.key.find('[') != std::string::npos;
  });
  return keys;
}

/// The keys whose values are chosen from a few words, and these words.
std::vector<std::pair<std::string, std::string>> keys_of_words() {
  std::vector<std::pair<std::string, std::string>> all;
  for (const scene::ScenarioKey& key : typed_keys()) {
    std::string of = key.kind == "true or false" ? "true false" : key.allowed;
    if (key.kind != "true or false" && (key.kind != "text" || of.empty())) continue;
    std::erase(of, ',');
    all.emplace_back(key.key, of);
  }
  return all;
}

/// Keys as they are typed, with what separates them from their values.
std::vector<std::string> keys_with_equals() {
  std::vector<std::string> all;
  for (const scene::ScenarioKey& key : typed_keys()) all.push_back(key.key + "=");
  return all;
}

/// What may follow the name of a command: commands in it, what it can do, or what it can tell of.
std::vector<std::string> first_words(const CLI::App& command) {
  std::vector<std::string> all = names_of(commands(command));
  if (command.get_name() == "help") {
    all = names_of(commands(*command.get_parent()));
    all.emplace_back("topics");
    for (const Topic& topic : topics()) all.emplace_back(topic.name);
  } else if (const auto taken = options(command, true); all.empty() && !taken.empty()) {
    all = choices(*taken.front());
  }
  return all;
}

/// The names that are allowed for this option, besides files.
std::vector<std::string> known_names(const CLI::Option& option) {
  return option.check_name("--scenario") ? scene::scenario_names() : std::vector<std::string>{};
}

std::string in_quotes(const std::vector<std::string>& words) {
  return base::shell_word(fmt::format("{}", fmt::join(words, " ")));
}

/// A branch of `case`: what may follow an option of a command.
std::string bash_value(const std::string& command, const CLI::Option& option) {
  std::vector<std::string> patterns;
  for (const std::string& name : names(option)) {
    patterns.push_back(base::shell_word(command + ":" + name));
  }
  std::string then = "files=yes";
  if (const auto of = choices(option); !of.empty()) {
    then = "words=" + in_quotes(of);
  } else if (const auto known = known_names(option); !known.empty()) {
    then = "words=" + in_quotes(known) + "; files=yes";
  } else if (option.check_name("--set")) {
    then = "words=$keys; compopt -o nospace 2>/dev/null";
  }
  return fmt::format("    {}) {} ;;\n", fmt::join(patterns, "|"), then);
}

/// Branches of `case` for the values of the keys that are chosen from a few words.
std::string bash_keys() {
  std::string branches;
  for (const auto& [key, words] : keys_of_words()) {
    branches += fmt::format("    *:{}) words={} ;;\n", key, base::shell_word(words));
  }
  return branches;
}

/// What completes the words of `headpin`, of a command, or of a command in a group.
struct BashTables {
  std::string options, values, firsts;

  void add(const CLI::App& command, const std::string& name) {
    std::vector<std::string> typed;
    for (const CLI::Option* option : apps::options(command, false)) {
      const std::vector<std::string> these = names(*option);
      typed.insert(typed.end(), these.begin(), these.end());
      if (takes_value(*option)) values += bash_value(name, *option);
    }
    options += fmt::format("      {}) words={} ;;\n", base::shell_word(name), in_quotes(typed));
    for (const CLI::App* one : commands(command)) add(*one, name + " " + one->get_name());
    if (const auto first = first_words(command); !first.empty()) {
      firsts += fmt::format("    {}) words={} ;;\n", base::shell_word(name), in_quotes(first));
    }
  }
};

std::string bash_completion(const CLI::App& app) {
  BashTables tables;
  std::vector<std::string> all = names_of(commands(app)), groups;
  for (const CLI::App* command : commands(app)) {
    tables.add(*command, command->get_name());
    if (!commands(*command).empty()) groups.push_back(command->get_name());
  }
  all.insert(all.end(), {"--help", "--version"});
  return "# bash completion for headpin; written by the program\n"
         "_headpin() {\n"
         "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}\n"
         "  local words= files= at=${COMP_WORDS[1]} keys=" +
         in_quotes(keys_with_equals()) +
         "\n"
         "  COMPREPLY=()\n"
         "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
         "    mapfile -t COMPREPLY < <(compgen -W " +
         in_quotes(all) +
         " -- \"$word\")\n"
         "    return\n"
         "  fi\n"
         "  # bash parts words at `=`: --shape=true and --set KEY=VALUE are three words.\n"
         "  if [ \"$word\" = = ]; then\n"
         "    word=\n"
         "  elif [ \"$before\" = = ] && [ \"$COMP_CWORD\" -gt 2 ]; then\n"
         "    before=${COMP_WORDS[COMP_CWORD-2]}\n"
         "  fi\n"
         "  if [ \"$COMP_CWORD\" -gt 2 ]; then\n"
         "    case $at in " +
         fmt::format("{}", fmt::join(groups, "|")) +
         ") at=\"$at ${COMP_WORDS[2]}\" ;; esac\n"
         "  elif [[ $word != -* ]]; then\n"
         "    case $at in\n" +
         tables.firsts +
         "    esac\n"
         "  fi\n"
         "  [ -n \"$words\" ] || case $at:$before in\n" +
         tables.values + bash_keys() +
         "    *)\n"
         "      files=yes\n"
         "      [[ $word == -* ]] && case $at in\n" +
         tables.options +
         "      esac ;;\n"
         "  esac\n"
         "  [ -z \"$words\" ] || mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$word\")\n"
         "  [ -n \"$files\" ] || return 0\n"
         "  compopt -o filenames 2>/dev/null  # of files alone are folders and special signs marked\n"
         "  mapfile -t -O \"${#COMPREPLY[@]}\" COMPREPLY < <(compgen -f -- \"$word\")\n"
         "}\n"
         "complete -F _headpin headpin\n";
}

std::string zsh_text(std::string text) {
  for (const char* special : {"\\", ":", "[", "]"}) {
    text = CLI::detail::find_and_replace(text, special, std::string("\\") + special);
  }
  return text;
}

/// A function that completes KEY=VALUE behind `--set`.
std::string zsh_keys() {
  std::string branches;
  for (const auto& [key, words] : keys_of_words()) {
    branches += fmt::format("    {}) compadd -- {} ;;\n", key, words);
  }
  return "_headpin_keys() {\n"
         "  local key=${PREFIX%%=*}\n"
         "  if ! compset -P '*='; then\n"
         "    compadd -S '' -- " +
         fmt::format("{}", fmt::join(keys_with_equals(), " ")) +
         "\n"
         "    return\n"
         "  fi\n"
         "  case $key in\n" +
         branches +
         "  esac\n"
         "}\n";
}

std::string zsh_option(const CLI::Option& option) {
  std::vector<std::string> all = names(option);
  const std::string once =
      may_be_repeated(option) ? "'*'" : base::shell_word(fmt::format("({})", fmt::join(all, " ")));
  if (takes_value(option)) {  // in the next word, or in the same
    for (std::string& name : all) name += name.starts_with("--") ? "=" : "+";
  }
  const std::string several = all.size() > 1 ? fmt::format("{{{}}}", fmt::join(all, ",")) : all[0];
  std::string after = fmt::format("[{}]", zsh_text(option.get_description()));
  if (option.check_name("--set")) {
    after += ":KEY=VALUE:_headpin_keys";
  } else if (takes_value(option)) {
    const auto of = choices(option), files = known_names(option);
    after += fmt::format(":{}:", zsh_text(placeholder(option)));
    after += !of.empty()      ? fmt::format("({})", fmt::join(of, " "))
             : !files.empty() ? fmt::format("{{compadd {}; _files}}", fmt::join(files, " "))
                              : std::string("_files");
  }
  return fmt::format("        {}{}{} \\\n", once, several, base::shell_word(after));
}

std::string zsh_completion(const CLI::App& app) {
  std::string listed, each;
  for (const CLI::App* command : commands(app)) {
    listed +=
        "    " + base::shell_word(command->get_name() + ":" + command->get_description()) + "\n";
    each += "    " + command->get_name() + ")\n      _arguments \\\n";
    for (const CLI::Option* option : options_in(*command)) each += zsh_option(*option);
    if (const auto first = first_words(*command); !first.empty()) {
      each += fmt::format("        '1:{}:({})' \\\n",
                          commands(*command).empty() ? "word" : "command", fmt::join(first, " "));
    }
    each += "        '*:file:_files' ;;\n";
  }
  return "#compdef headpin\n# written by the program\n" + zsh_keys() +
         "_headpin() {\n"
         "  local -a commands=(\n" +
         listed +
         "  )\n"
         "  if (( CURRENT == 2 )); then\n"
         "    _describe command commands\n"
         "    return\n"
         "  fi\n"
         "  shift words\n"
         "  (( CURRENT-- ))\n"
         "  case $words[1] in\n" +
         each +
         "  esac\n"
         "}\n"
         "_headpin \"$@\"\n";
}

void write_page(const fs::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) throw std::runtime_error(path.string() + ": cannot be written");
}

void write_all(const CLI::App& app, const fs::path& folder) {
  fs::create_directories(folder / "man1");
  write_page(folder / "man1" / "headpin.1", overview(app));
  for (const CLI::App* command : commands(app)) {
    const std::string name = command->get_name();
    write_page(folder / "man1" / ("headpin-" + name + ".1"), page(*command, name));
    for (const CLI::App* one : commands(*command)) {
      write_page(folder / "man1" / fmt::format("headpin-{}-{}.1", name, one->get_name()),
                 page(*one, name + " " + one->get_name()));
    }
  }
  write_page(folder / "headpin.bash", bash_completion(app));
  write_page(folder / "_headpin", zsh_completion(app));
  fs::create_directories(folder / "docs");
  for (const auto& [name, text] : reference_pages()) write_page(folder / "docs" / name, text);
}

}  // namespace

void add_manual(CLI::App& app) {
  const auto folder = std::make_shared<std::string>();
  CLI::App* command =
      app.add_subcommand("manual", "Write manual pages, completion and the pages of docs")
          ->group("");  // for the build; not shown in the help
  command->add_option("FOLDER", *folder, "where to; man1/ is made in it")->required();
  command->callback([&app, folder] { write_all(app, *folder); });
}

}  // namespace headpin::apps
