#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "apps/command.h"
#include "apps/condition.h"
#include "apps/options.h"
#include "apps/page_file.h"
#include "apps/streams.h"
#include "base/output_file.h"
#include "devices/base/version.h"
#include "scene/page/play_page.h"
#include "scene/stage/read_scenario.h"

namespace headpin::apps {

namespace {

struct PlayOptions {
  std::string scenario = "paper-room";
  std::optional<std::string> output, page;
  Condition condition;
  bool force = false, json = false;
};

void write_play_page(const PlayOptions& options) {
  const std::string page = options.page ? page_template(*options.page) : play_template();
  scene::Scenario scenario = scene::load_scenario(options.scenario);
  apply_condition(options.condition, scenario);
  scene::PageData data = scene::play_page(scenario);
  for (const nlohmann::json& sentence : data.json["missing_meshes"]) {
    say("headpin play: {}\n", printable(sentence.get<std::string>()));
  }
  data.json["version"] = devices::software_version();
  data.json["commit"] = devices::software_commit();
  const PageBlocks blocks = {
      {"play", deflated(data.json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace))},
      {"play-numbers", deflated(in_quanta(data))}};
  std::vector<std::filesystem::path> inputs = {options.scenario};
  if (options.page) inputs.emplace_back(*options.page);
  base::OutputFile out(*options.output,
                       {.overwrite = options.force, .standard_output = true, .inputs = inputs});
  const std::string html = filled(page, blocks);
  out.write(html.data(), html.size());
  out.commit();
  if (!options.json) return;
  print_json({{"scenario", scenario.name}, {"output", *options.output}, {"bytes", html.size()}});
}

}  // namespace

void add_play(CLI::App& app) {
  auto options = std::make_shared<PlayOptions>();
  CLI::App* command = app.add_subcommand(
      "play",
      "Write one HTML page in which a person plays a session: with a headset (WebXR), a mouse, "
      "touch or keys");
  command->add_option("SCENARIO", options->scenario, "name of a bundled scenario or a TOML file")
      ->capture_default_str();
  add_output(*command, "-o,--output", options->output,
             "page to write (.html); - is standard output", {".html", ".htm"})
      ->required();
  command->add_option("--page", options->page,
                      "page template; default: the one that is installed with the program");
  add_condition_options(*command, options->condition);
  add_force(*command, options->force);
  add_json(*command, options->json);
  command->footer(
      "The page needs no network and no other file. It records the session as a trial, which it "
      "saves at the end.\n\n"
      "Example:\n  headpin play paper-experiment -o play.html");
  command->callback([options] { write_play_page(*options); });
}

}  // namespace headpin::apps
