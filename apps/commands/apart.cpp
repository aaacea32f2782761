#include "sweep/apart.h"

#include <algorithm>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/condition.h"
#include "apps/damage.h"
#include "apps/options.h"
#include "apps/progress.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "base/output_file.h"
#include "scene/watch/recorded.h"
#include "study/csv.h"

namespace headpin::apps {

namespace {

struct ApartOptions {
  std::string a;
  std::optional<std::string> b, output;
  Condition condition;
  std::string gl;
  double longest_gap = seconds(devices::kLongestGap);
  bool force = false, json = false;
};

/// One of the two sessions.
struct Simulated {
  scene::Recorded recorded;
  scene::Session session;
  scene::TrialPlayer source;

  explicit Simulated(scene::Recorded trial)
      : recorded(std::move(trial)),
        session(scene::make_session(recorded.scenario)),
        source(recorded.file) {
    session.hashes = false;
  }
  Simulated(const Simulated&) = delete;
  Simulated& operator=(const Simulated&) = delete;
};

scene::Recorded loaded(const std::string& path, const ApartOptions& options) {
  return scene::load_trial(path, microseconds(options.longest_gap));
}

nlohmann::ordered_json to_json(const sweep::Difference& difference) {
  return {{"a", difference.a},
          {"b", difference.b},
          {"size", difference.size},
          {"times", difference.times},
          {"at_s", nearest_seconds(difference.at)},
          {"first_s", difference.first ? nlohmann::ordered_json(nearest_seconds(*difference.first))
                                       : nlohmann::ordered_json()}};
}

nlohmann::ordered_json to_json(const std::optional<sweep::Difference>& difference) {
  return difference ? to_json(*difference) : nlohmann::ordered_json();
}

nlohmann::ordered_json to_json(const sweep::BodyApart& body) {
  return {{"body", body.body},
          {"left_arcmin", body.arcmin[0]},
          {"right_arcmin", body.arcmin[1]},
          {"place", to_json(body.place)},
          {"off_view_deg", body.off_view_deg},
          {"speed", to_json(body.speed)},
          {"contact", to_json(body.contact)},
          {"bounce", to_json(body.bounce)}};
}

/// Whether the body differs in any way.
bool differs(const sweep::BodyApart& body) {
  return body.place.size > 0.0 || (body.contact && body.contact->size > 0.0) ||
         (body.bounce && body.bounce->size > 0.0);
}

std::string csv_of(const sweep::Apart& apart) {
  std::string text =
      study::csv_line({"body", "left_arcmin", "right_arcmin", "place_times", "place_at_s",
                       "place_first_s", "off_view_deg", "speed_a_degps", "speed_b_degps",
                       "speed_times", "speed_at_s", "speed_first_s", "contact_a_s", "contact_b_s",
                       "contact_times", "bounce_a_m", "bounce_b_m", "bounce_times"});
  const auto number = [](double value) { return fmt::format("{}", value); };
  const auto first = [&](const sweep::Difference& difference) {
    return difference.first ? number(nearest_seconds(*difference.first)) : std::string();
  };
  for (const sweep::BodyApart& body : apart.bodies()) {
    const bool was_seen = body.place.size > 0.0;
    std::vector<std::string> cells = {body.body,
                                      number(body.arcmin[0]),
                                      number(body.arcmin[1]),
                                      number(body.place.times),
                                      was_seen ? number(nearest_seconds(body.place.at)) : "",
                                      first(body.place),
                                      was_seen ? number(body.off_view_deg) : ""};
    const auto pair = [&](const std::optional<sweep::Difference>& difference, bool times) {
      if (!difference) return cells.resize(cells.size() + (times ? 5 : 3));
      cells.push_back(number(difference->a));
      cells.push_back(number(difference->b));
      cells.push_back(number(difference->times));
      if (!times) return;
      cells.push_back(number(nearest_seconds(difference->at)));
      cells.push_back(first(*difference));
    };
    pair(body.speed, true);
    pair(body.contact, false);
    pair(body.bounce, false);
    text += study::csv_line(cells);
  }
  return text;
}

void print_table(const sweep::Apart& apart) {
  if (std::ranges::none_of(apart.bodies(), differs)) return;
  fmt::print("{:<14}{:>20}{:>14}{:>12}{:>10}{:>12}{:>10}\n", "body", "left, right [arcmin]",
             "times seen", "from [s]", "speed", "contact", "bounce");
  const auto times = [](const std::optional<sweep::Difference>& difference) {
    return difference ? sweep::in_digits(difference->times, 2) : std::string("-");
  };
  for (const sweep::BodyApart& body : apart.bodies()) {
    if (!differs(body)) continue;
    const std::string from =
        body.place.first ? fmt::format("{:.2f}", seconds(*body.place.first)) : "-";
    fmt::print("{:<14}{:>20}{:>14}{:>12}{:>10}{:>12}{:>10}\n", body.body,
               fmt::format("{}, {}", sweep::in_digits(body.arcmin[0], 3),
                           sweep::in_digits(body.arcmin[1], 3)),
               sweep::in_digits(body.place.times, 2), from, times(body.speed), times(body.contact),
               times(body.bounce));
  }
}

sweep::Apart apart_of(const Simulated& a, const Simulated& b, const ApartOptions& options) {
  const std::string other = options.b.value_or(options.a + " under the condition");
  try {
    return {a.session, b.session, options.gl, {options.a, other}};
  } catch (const std::invalid_argument& error) {
    if (options.b) throw;
    throw UsageError(error.what());
  }
}

/// The answer; of trials that do not end together also until when it holds.
std::vector<std::string> answer(const sweep::Apart& apart, const Simulated& a, const Simulated& b,
                                const ApartOptions& options) {
  std::vector<std::string> sentences = sweep::in_sentences(apart);
  const double of_a = seconds(a.recorded.file.summary().end);
  const double of_b = seconds(b.recorded.file.summary().end);
  if (a.recorded.ticks() == b.recorded.ticks() || !options.b) return sentences;
  const bool a_first = a.recorded.ticks() < b.recorded.ticks();
  sentences.push_back(
      fmt::format("Only the first {:.2f} s were compared: there {} ends. {} has {:.2f} s.",
                  seconds(a.session.now()), printable(a_first ? options.a : *options.b),
                  printable(a_first ? *options.b : options.a), a_first ? of_b : of_a));
  return sentences;
}

void tell_apart(const ApartOptions& options) {
  watch_stop_signals();
  std::optional<base::OutputFile> file;
  if (options.output) {
    std::vector<std::filesystem::path> inputs = {options.a};
    if (options.b) inputs.emplace_back(*options.b);
    file.emplace(*options.output, base::OutputFile::Options{.overwrite = options.force,
                                                            .standard_output = !options.json,
                                                            .inputs = inputs});
  }
  Simulated a(loaded(options.a, options));
  scene::Recorded other = loaded(options.b.value_or(options.a), options);
  apply_condition(options.condition, other.scenario);
  Simulated b(std::move(other));
  say_what_is_missing("apart", options.a, a.recorded.file.summary());
  if (options.b) say_what_is_missing("apart", *options.b, b.recorded.file.summary());
  sweep::Apart apart = apart_of(a, b, options);
  const std::int64_t ticks = std::min(a.recorded.ticks(), b.recorded.ticks());
  {
    Progress progress("ticks", ticks);
    while (a.session.tick < ticks) {
      check_stop();
      scene::advance(a.session, a.source);
      scene::advance(b.session, b.source);
      apart.tick(a.session, b.session);
      progress.show(a.session.tick);
    }
  }
  if (file) {
    const std::string text = csv_of(apart);
    file->write(text.data(), text.size());
    check_stop();
    file->commit();
  }
  if (options.json) {
    nlohmann::ordered_json bodies = nlohmann::ordered_json::array();
    for (const sweep::BodyApart& body : apart.bodies()) bodies.push_back(to_json(body));
    return print_json({{"answer", answer(apart, a, b, options)},
                       {"compared_frames", apart.frames()},
                       {"pixel_arcmin", apart.pixel_arcmin()},
                       {"limit_arcmin", apart.limit_arcmin()},
                       {"apart", bodies},
                       {"output", options.output ? nlohmann::ordered_json(*options.output)
                                                 : nlohmann::ordered_json()}});
  }
  if (options.output == "-") return;
  print_table(apart);
  for (const std::string& sentence : answer(apart, a, b, options)) fmt::print("{}\n", sentence);
}

}  // namespace

void add_apart(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "apart", "Say what the eyes can tell apart between two conditions of one recording");
  const auto options = std::make_shared<ApartOptions>();
  command->add_option("TRIAL", options->a, "a trial (.lcmlog); - is standard input")->required();
  command->add_option("OTHER", options->b,
                      "another trial of the same recording; by default, TRIAL under the condition");
  add_output(*command, "-o,--output", options->output,
             "table to write (.csv); - is standard output", {".csv"});
  add_gl(*command, options->gl);
  add_force(*command, options->force);
  add_longest_gap(*command, options->longest_gap);
  add_json(*command, options->json);
  add_condition_options(*command, options->condition);
  command->footer(
      "Both are simulated again. Each difference is given as a multiple of what people or the "
      "display can tell\napart; `headpin help seen` has the thresholds and their sources.\n\n"
      "Examples:\n  headpin apart assets/trials/demo.lcmlog --friction 0\n"
      "  headpin apart rough.lcmlog smooth.lcmlog -o apart.csv");
  command->callback([options] { tell_apart(*options); });
}

}  // namespace headpin::apps
