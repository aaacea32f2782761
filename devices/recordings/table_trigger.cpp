#include "devices/recordings/table_trigger.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "devices/recordings/column_names.h"
#include "devices/recordings/marker_file.h"

namespace headpin::devices {
namespace {

/// What a cell says of a trigger: a number, or 1 and 0 for a word. Nothing for blank and other cells.
std::optional<double> trigger_value(const AnyTable& table, std::string_view cell) {
  if (const auto number = table.number(cell)) return number;
  const std::string word = small_letters(cell);
  if (is_one_of(word, {"true", "on", "yes"})) return 1.0;
  if (is_one_of(word, {"false", "off", "no"})) return 0.0;
  if (const auto pressed = pressed_by(words_of(cell))) return *pressed ? 1.0 : 0.0;
  return std::nullopt;
}

/// Whether a column is pressed in a row, and not in a later one.
bool is_pressed_and_let_go(const AnyTable& table, std::size_t column) {
  double most = 0.0;
  for (const AnyTable::Row& row : table.rows)
    most = std::max(most, trigger_value(table, row.cells[column]).value_or(0.0));
  bool pressed = false;
  for (const AnyTable::Row& row : table.rows) {
    const auto value = trigger_value(table, row.cells[column]);
    if (!value) continue;
    const bool now = *value > 0.5 * most;
    if (pressed && !now) return true;
    pressed = now;
  }
  return false;
}

bool is_called_trigger(const AnyTable& table, std::size_t column) {
  const std::vector<std::string> words = words_of(table.columns[column].name);
  return std::ranges::find(words, "trigger") != words.end();
}

}  // namespace

void tell_once(std::vector<std::string>& notes, std::string note) {
  if (std::ranges::find(notes, note) == notes.end()) notes.push_back(std::move(note));
}

std::vector<Stamped<bool>> presses(const AnyTable& table, std::size_t column, const TimedRows& rows,
                                   std::vector<std::string>& notes) {
  double most = 0.0;
  std::size_t silent = 0;
  for (const auto& [time, row] : rows) {
    const auto value = trigger_value(table, row->cells[column]);
    most = std::max(most, value.value_or(0.0));
    silent += !value;
  }
  const std::string& name = table.columns[column].name;
  if (silent == rows.size()) {
    tell_once(notes,
              fmt::format(
                  "the trigger '{}' has no numbers, and no words such as grab and release: ignored",
                  name));
    return {};
  }
  const auto is_released = [&](const auto& row) {
    const auto value = trigger_value(table, row.second->cells[column]);
    return value && *value <= 0.5 * most;
  };
  const bool keeps = std::ranges::any_of(rows, is_released);
  if (silent > 0) {
    tell_once(notes,
              fmt::format("the trigger '{}' is blank or no number in {} of {} rows: {}", name,
                          silent, rows.size(), keeps ? "the value before is kept" : "not pressed"));
  }
  std::vector<Stamped<bool>> changes;
  for (const auto& row : rows) {
    const bool before = !changes.empty() && changes.back().value;
    const bool says = trigger_value(table, row.second->cells[column]).has_value();
    const bool pressed = says ? !is_released(row) : keeps && before;
    if (pressed != before) changes.push_back({row.first, pressed});
  }
  if (std::ranges::none_of(changes, [](const Stamped<bool>& change) { return !change.value; })) {
    tell_once(notes, fmt::format("the trigger '{}' is never pressed and let go: not used", name));
  }
  return changes;
}

std::size_t better_trigger(const AnyTable& table, std::size_t first, std::size_t second) {
  const auto rank = [&](std::size_t column) {
    return std::pair(is_pressed_and_let_go(table, column), is_called_trigger(table, column));
  };
  return rank(second) > rank(first) ? second : first;
}

}  // namespace headpin::devices
