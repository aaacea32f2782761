#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/damage.h"
#include "apps/options.h"
#include "apps/page_file.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "apps/trial_page.h"
#include "apps/whatif.h"
#include "base/input_file.h"
#include "base/output_file.h"
#include "base/shell_word.h"
#include "devices/base/version.h"
#include "scene/page/page_data.h"
#include "scene/record/first_difference.h"
#include "scene/watch/counterparts.h"
#include "scene/watch/totals.h"
#include "sweep/whatif_svg.h"

namespace headpin::apps {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostEmbedded = 20'000'000;  // bytes; a larger video stays beside the page
constexpr std::size_t kMostRead = 2'000'000'000;   // bytes of a log that goes into a page

std::string command_of(const TrialPage& options) {
  std::string command = "headpin report " + base::shell_word(options.trial);
  if (options.other) command += " " + base::shell_word(*options.other);
  command += " -o " + base::shell_word(*options.output);
  if (options.video) command += " --video " + base::shell_word(*options.video);
  if (options.whatif) command += fmt::format(" --whatif {}", *options.whatif);
  if (options.page) command += " --page " + base::shell_word(*options.page);
  if (options.longest_gap != TrialPage{}.longest_gap) {
    command += fmt::format(" --longest-gap {}", options.longest_gap);
  }
  return command;
}

std::string text_of(const nlohmann::json& object) {
  return object.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string file_name(const std::string& path) {
  return fs::path(path).filename().string();
}

/// Adds one trial to the page; the names of its blocks end with `which`.
void add_trial(const std::string& path, const scene::PageData& data, const std::string& which,
               PageBlocks& blocks) {
  nlohmann::json text = data.json;
  text["trial"]["name"] = file_name(path);
  blocks["json" + which] = deflated(text_of(text));
  blocks["numbers" + which] = deflated(in_quanta(data));
}

/// Simulates a trial and gives the state of each tick.
scene::NextState simulated(const scene::Recorded& recorded, scene::Session& session,
                           scene::TrialPlayer& source) {
  const std::int64_t ticks = recorded.ticks();
  return [&session, &source, ticks]() -> std::optional<scene::TickState> {
    check_stop();
    if (session.tick >= ticks) return std::nullopt;
    scene::advance(session, source);
    scene::TickState state;
    scene::tick_state(session, state);
    return state;
  };
}

/// The first difference between the simulations of two trials, and the bodies of only one of them.
void add_comparison(const scene::Recorded& a, const scene::Recorded& b, nlohmann::json& about) {
  scene::TrialPlayer in_a(a.file), in_b(b.file);
  scene::Session sa = scene::make_session(a.scenario), sb = scene::make_session(b.scenario);
  const scene::SharedBodies shared =
      scene::shared_bodies(scene::body_names(*sa.stage), scene::body_names(*sb.stage));
  const auto difference = scene::compare(simulated(a, sa, in_a), simulated(b, sb, in_b), shared);
  about["first_difference"] = difference ? scene::to_json(*difference) : nlohmann::json();
  about["bodies_only_in_a"] = shared.only_in_a;
  about["bodies_only_in_b"] = shared.only_in_b;
}

/// The log without its states, if its simulation has the same bits. Only for old logs it does not,
/// because there the states show when samples were available.
std::string log_block(const std::string& path, const std::string& game_hash, Time longest_gap) {
  const std::vector<std::uint8_t> inputs = log_of_inputs(path);
  const scene::Recorded recorded = scene::load_trial(inputs, path, longest_gap);
  scene::Session session = scene::make_session(recorded.scenario);
  scene::TrialPlayer source(recorded.file);
  scene::NoPace pace;
  const std::int64_t ticks = recorded.ticks();
  scene::run(session, source, pace, {}, [&](const scene::Session& s) {
    check_stop();
    return s.tick >= ticks;
  });
  if (scene::in_hex(session.game_hash.value()) == game_hash) {
    return deflated(inputs);
  }
  return deflated(base::read_bytes(path, kMostRead));
}

/// Whether a file begins like an MP4 file: with a file type box (ISO 14496-12, 4.3).
bool is_mp4(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view kType = "ftyp";
  return bytes.size() > 8 && std::equal(kType.begin(), kType.end(), bytes.begin() + 4);
}

/// The path of a large video.
fs::path beside_page(const TrialPage& options) {
  return fs::path(*options.output).replace_extension(".mp4");
}

/// Puts the video into the page, or beside it if it is large.
///
/// @param inputs  files that the copy must not replace
nlohmann::json add_video(const TrialPage& options, const std::vector<fs::path>& inputs,
                         PageBlocks& blocks) {
  if (!options.video) return {};
  const base::InputFile video(*options.video);
  std::vector<std::uint8_t> bytes(std::min(video.size(), kMostEmbedded));
  bytes.resize(video.read(0, bytes));
  if (!is_mp4(bytes)) {
    throw UsageError(fmt::format(
        "--video {}: expected an MP4, which browsers show, found something else; `headpin frames "
        "--video NAME.mkv` writes NAME.mp4 beside it",
        *options.video));
  }
  if (video.size() <= kMostEmbedded) {
    blocks["video"] = base64(bytes);
    return {{"embedded", true}};
  }
  const fs::path beside = beside_page(options);
  if (!base::same_file(beside, *options.video)) {
    base::OutputFile copy(beside.string(), {.overwrite = options.force, .inputs = inputs});
    for (std::size_t at = 0; const std::size_t n = video.read(at, bytes); at += n) {
      check_stop();
      copy.write(bytes.data(), n);
    }
    copy.commit();
  }
  return {{"embedded", false}, {"file", beside.filename().string()}};
}

/// Results of other releases of a throw, as pictures and text like `headpin whatif`.
nlohmann::json whatif_of(const TrialPage& options) {
  WhatIfQuestion question;
  question.trials = {options.trial};
  question.number = *options.whatif;
  question.option = "--whatif";
  question.longest_gap = options.longest_gap;
  question.jobs = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const sweep::WhatIf whatif = ask_what_if(question, "");
  nlohmann::json moments = nlohmann::json::array();
  for (std::size_t i = 0; i < whatif.moments.size(); ++i) {
    const sweep::Outcome& outcome = whatif.of_moments[i];
    nlohmann::json row = {1e3 * seconds(whatif.moments[i].shift), nullptr, nullptr, nullptr};
    if (const auto execution = sweep::execution_of(outcome.thrown)) {
      row[1] = execution->speed;
      row[2] = execution->direction_deg;
    }
    if (outcome.released) row[3] = outcome.down;
    moments.push_back(row);
  }
  return {{"lines", in_lines(whatif)},
          {"moments", moments},
          {"moments_svg", sweep::moments_svg(whatif)},
          {"map_svg", sweep::map_svg(whatif)}};
}

/// The page shows both trials at the same ticks.
void require_same_ticks(const TrialPage& options, const scene::Recorded& a,
                        const scene::Recorded& b) {
  const std::int64_t rate = a.scenario.rates.physics_hz, other = b.scenario.rates.physics_hz;
  if (rate == other) return;
  throw std::runtime_error(fmt::format(
      "{}: {} ticks a second; expected {}, as {} has, to show both in one page; `headpin replay` "
      "with --set rates.physics_hz={} makes such a trial, and `headpin compare` needs none",
      *options.other, other, rate, options.trial, rate));
}

}  // namespace

nlohmann::ordered_json write_page(const TrialPage& options) {
  watch_stop_signals();
  if (options.video &&
      base::follow_links(beside_page(options)) == base::follow_links(*options.output)) {
    throw UsageError(fmt::format(
        "-o {}: a video that is kept beside the page gets this name; expected another, such as "
        "NAME.html",
        *options.output));
  }
  const std::string page = options.page ? page_template(*options.page) : page_template();
  const Time longest_gap = microseconds(options.longest_gap);
  const scene::Recorded recorded = scene::load_trial(options.trial, longest_gap);
  say_what_is_missing("report", options.trial, recorded.file.summary());
  PageBlocks blocks;
  nlohmann::json about = {{"version", devices::software_version()},
                          {"commit", devices::software_commit()},
                          {"command", command_of(options)},
                          {"first_difference", nullptr}};
  const scene::PageData data = scene::page_data(recorded, scene::PageLooks(recorded.scenario));
  add_trial(options.trial, data, "", blocks);
  if (options.other) {
    const scene::Recorded other = scene::load_trial(*options.other, longest_gap);
    say_what_is_missing("report", *options.other, other.file.summary());
    require_same_ticks(options, recorded, other);
    const bool looks_alike =
        recorded.file.summary().header.scenario == other.file.summary().header.scenario;
    add_trial(*options.other,
              scene::page_data(other, scene::PageLooks(other.scenario), {}, !looks_alike), "-other",
              blocks);
    add_comparison(recorded, other, about);
    about["scenario_differences"] =
        scene::to_json(scene::differences(recorded.scenario, other.scenario));
    const std::vector<scene::Event> events_a = scene::events_of(recorded, [] { check_stop(); });
    const std::vector<scene::Event> events_b = scene::events_of(other, [] { check_stop(); });
    about["only_thrown_in_a"] = scene::to_json(scene::without_counterpart(events_a, events_b));
    about["only_thrown_in_b"] = scene::to_json(scene::without_counterpart(events_b, events_a));
  }
  const nlohmann::json& hash = data.json["hash"];
  const std::string log = log_block(options.trial, hash["game_replayed"], longest_gap);
  about["log_left_out"] = log.size() > kMostEmbedded;
  if (log.size() <= kMostEmbedded) blocks["log"] = log;

  std::vector<fs::path> inputs = {options.trial};
  for (const auto& input : {options.other, options.video, options.page}) {
    if (input) inputs.emplace_back(*input);
  }
  base::OutputFile out(
      *options.output,
      {.overwrite = options.force, .standard_output = !options.video, .inputs = inputs});
  about["video"] = add_video(options, inputs, blocks);
  if (options.whatif) blocks["whatif"] = deflated(text_of(whatif_of(options)));
  blocks["about"] = deflated(text_of(about));
  const std::string html = filled(page, blocks);
  out.write(html.data(), html.size());
  check_stop();
  out.commit();

  return {{"trial", options.trial},
          {"output", *options.output},
          {"bytes", html.size()},
          {"ticks", data.json["ticks"]},
          {"skittles_down", data.json["summary"]["skittles_down"]},
          {"verified_ticks", hash["verified_ticks"]},
          {"state_hash", hash["replayed"]},
          {"game_hash", hash["game_replayed"]}};
}

void add_report(CLI::App& app) {
  auto options = std::make_shared<TrialPage>();
  CLI::App* command = app.add_subcommand(
      "report",
      "Write one HTML page that shows a trial in 3D and in numbers, and can simulate it again");
  command->add_option("TRIAL", options->trial, "a trial (.lcmlog); - is standard input")
      ->required();
  command->add_option("OTHER", options->other, "another trial, shown with the first");
  add_output(*command, "-o,--output", options->output,
             "page to write (.html); - is standard output", {".html", ".htm"})
      ->required();
  command->add_option("--video", options->video,
                      "video of both eyes (the .mp4 of `headpin frames --video`): embedded in the "
                      "page or, above 20 MB, copied next to it");
  command
      ->add_option("--whatif", options->whatif,
                   "number of a throw: also show what other releases of it would have felled, as "
                   "`headpin whatif` with its defaults")
      ->check(whole_number_from(1, 1'000'000));
  command->add_option("--page", options->page,
                      "page template; default: the one that is installed with the program");
  add_force(*command, options->force);
  add_longest_gap(*command, options->longest_gap);
  add_json(*command, options->json);
  command->footer(
      "The page needs no network and no other file. Any browser since 2023 opens it.\n\n"
      "Example:\n  headpin report assets/trials/demo.lcmlog -o trial.html");
  command->callback([options] {
    const nlohmann::ordered_json made = write_page(*options);
    if (options->json) print_json(made);
  });
}

}  // namespace headpin::apps
