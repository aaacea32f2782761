#include "study/model.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "base/hash.h"
#include "base/random.h"
#include "study/csv.h"

namespace headpin::study {

namespace {

// Purposes of random numbers; the item's name is added.
constexpr std::uint64_t kDealt = 1000, kGiven = 2000;

std::uint64_t number_of(const std::string& text) {
  Fnv hash;
  for (const char c : text) hash.add(static_cast<std::uint8_t>(c));
  return hash.value();
}

std::optional<std::size_t> factor_with_letter(const Design& design, const std::string& letter) {
  const auto found = std::ranges::find(design.factors, letter, &Factor::letter);
  if (found == design.factors.end()) return std::nullopt;
  return static_cast<std::size_t>(found - design.factors.begin());
}

/// Number of earlier places with that changed parameter.
std::int64_t rank_of(const Design& design, std::uint64_t seed, std::int64_t place,
                     std::size_t changed) {
  std::int64_t in_block = 0;
  for (const DesignRow& row : design.rows) in_block += row.changed == changed ? row.people : 0;
  const std::int64_t block = place / design.block();
  std::int64_t rank = block * in_block;
  for (std::int64_t other = block * design.block(); other < place; ++other) {
    rank += design.rows[allot(design, seed, other).row].changed == changed;
  }
  return rank;
}

/// The answer for a rank, from shuffled decks of the published answers.
std::string dealt(const PublishedAnswers& published, std::uint64_t seed, std::int64_t rank) {
  std::vector<std::string> deck;
  for (const auto& [answer, count] : published.counts) {
    deck.insert(deck.end(), static_cast<std::size_t>(count), answer);
  }
  const auto size = static_cast<std::int64_t>(deck.size());
  const std::uint64_t which = number_of(published.item) + published.changed.value_or(99);
  Random random(seed, kDealt + which, static_cast<std::uint64_t>(rank / size));
  for (std::size_t i = deck.size(); i > 1; --i) std::swap(deck[i - 1], deck[random.next() % i]);
  return deck[static_cast<std::size_t>(rank % size)];
}

std::string any_answer(const Item& item, Random& random) {
  if (!item.is_scale()) return item.choices[random.next() % item.choices.size()].id;
  const auto answers = static_cast<std::uint64_t>(item.high - item.low + 1);
  return fmt::format("{}", item.low + static_cast<int>(random.next() % answers));
}

std::string scored_answer(const Item& item, double probability, Random& random) {
  const bool high = random.uniform() < probability;
  const int from = high ? *item.counts_from : item.low;
  const int to = high ? item.high : *item.counts_from - 1;
  return fmt::format(
      "{}", from + static_cast<int>(random.next() % static_cast<std::uint64_t>(to - from + 1)));
}

}  // namespace

std::optional<double> value_of(const Term& term, const Design& design, const Allotted& allotted,
                               const Answers& answers) {
  const DesignRow& row = design.rows[allotted.row];
  if ((term.changed && row.changed != *term.changed) ||
      (term.unless && row.changed == *term.unless)) {
    return 0.0;
  }
  if (term.of.empty()) return 1.0;
  if (const auto factor = factor_with_letter(design, term.of)) {
    return row.cell[*factor] == (term.is.empty() ? '1' : term.is.front()) ? 1.0 : 0.0;
  }
  const Answer* answer = find(answers, term.of);
  if (!answer || answer->answer == kNoAnswer) return std::nullopt;
  if (!term.is.empty()) return answer->answer == term.is ? 1.0 : 0.0;
  return whole_in(answer->answer);
}

std::optional<std::vector<double>> values_of(const Design& design, const Allotted& allotted,
                                             const Answers& answers) {
  std::vector<double> values;
  for (const Term& term : design.terms) {
    const auto value = value_of(term, design, allotted, answers);
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  return values;
}

std::string in_r(const Term& term, const Design& design) {
  const auto key = [&](std::size_t factor) { return design.factors[factor].key; };
  std::string among;  // people; an answer of others does not matter, nor that it is missing
  if (term.changed) among = fmt::format("p$changed == \"{}\"", key(*term.changed));
  if (term.unless) {
    among += fmt::format("{}p$changed != \"{}\"", among.empty() ? "" : " & ", key(*term.unless));
  }
  if (term.of.empty()) return among.empty() ? "rep(1, nrow(p))" : fmt::format("1 * ({})", among);
  const std::string value =
      term.is.empty() ? "p$" + term.of : fmt::format("1 * (p${} == \"{}\")", term.of, term.is);
  return among.empty() ? value : fmt::format("ifelse({}, {}, 0)", among, value);
}

double published_estimate(const Design& design, std::size_t term) {
  if (design.terms[term].estimate) return *design.terms[term].estimate;
  throw std::invalid_argument(
      fmt::format("design '{}' has no published model: its term '{}' has no estimate", design.name,
                  design.terms[term].name));
}

double published_probability(const Design& design, const std::vector<double>& values) {
  double eta = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) eta += published_estimate(design, i) * values[i];
  return 1.0 / (1.0 + std::exp(-eta));
}

bool has_published_model(const Design& design) {
  return !design.terms.empty() &&
         std::ranges::all_of(design.terms, [](const Term& term) { return !!term.estimate; });
}

Answers draw_answers(const Design& design, const Questionnaire& questions, std::uint64_t seed,
                     const PlannedParticipant& participant) {
  if (design.terms.empty()) {
    throw std::invalid_argument(
        fmt::format("design '{}' has no published model: it has no terms", design.name));
  }
  const std::size_t changed = design.rows[participant.allotted.row].changed;
  const std::uint64_t name = number_of(participant.id);
  Answers answers;
  for (const Item& item : questions.items) {
    if (item.counts_from) continue;
    Random random(seed, kGiven + number_of(item.id), name);
    std::string answer = any_answer(item, random);
    for (const PublishedAnswers& published : design.published) {
      if (published.item != item.id || (published.changed && *published.changed != changed))
        continue;
      const std::int64_t rank =
          published.changed ? rank_of(design, seed, participant.place, changed) : participant.place;
      answer = dealt(published, seed, rank);
    }
    answers.push_back({item.id, answer, kDrawn});
  }
  const auto values = values_of(design, participant.allotted, answers);
  if (!values) {  // of a study that was planned before check_items() refused this
    throw std::invalid_argument(
        fmt::format("design '{}': published.counts has n/a for an item that a term uses; expected "
                    "answers only",
                    design.name));
  }
  const double probability = published_probability(design, *values);
  for (const Item& item : questions.items) {
    if (!item.counts_from) continue;
    Random random(seed, kGiven + number_of(item.id), name);
    answers.push_back({item.id, scored_answer(item, probability, random), kDrawn});
  }
  std::ranges::sort(answers, {}, [&](const Answer& answer) { return questions.find(answer.item); });
  return answers;
}

}  // namespace headpin::study
