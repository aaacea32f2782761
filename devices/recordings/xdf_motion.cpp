#include "devices/recordings/xdf_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "devices/recordings/marker_file.h"
#include "devices/recordings/table_motion.h"
#include "devices/recordings/text_encoding.h"
#include "devices/recordings/text_table.h"
#include "devices/recordings/xdf_clock.h"

namespace headpin::devices {
namespace {

constexpr std::size_t kMostCells = 60'000'000;

/// The component that a type of LSL's meta-data for motion says; empty for other types.
std::string_view component_of_type(std::string_view type) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 14> kTypes = {{
      {"positionx", "x"},
      {"positiony", "y"},
      {"positionz", "z"},
      {"orientationa", "qw"},
      {"orientationb", "qx"},
      {"orientationc", "qy"},
      {"orientationd", "qz"},
      {"orientationw", "qw"},
      {"orientationx", "qx"},
      {"orientationy", "qy"},
      {"orientationz", "qz"},
      {"orientationp", "pitch"},
      {"orientationh", "heading"},
      {"orientationr", "roll"},
  }};
  const std::string small = small_letters(type);
  const auto found = std::ranges::find(kTypes, small, [](const auto& one) { return one.first; });
  return found == kTypes.end() ? std::string_view{} : found->second;
}

/// The object in the label of a channel with such a type: "head" of "Head_X", "HeadA" and "head_qa".
std::string object_in(const std::string& label) {
  const Component component = component_of(label);
  if (component.quantity != Quantity::none) return component.object;
  std::vector<std::string> words = words_of(label);
  if (!words.empty() && words.back().size() <= 2) words.pop_back();
  return fmt::format("{}", fmt::join(words, " "));
}

/// What a stream's column is called: "OptiTrack Head qw".
std::string column_name(const XdfStream& stream, std::size_t channel) {
  const XdfChannel& its = stream.channels[channel];
  const std::string_view component = component_of_type(its.type);
  std::string name = its.label;
  if (!component.empty()) {
    const std::string object = its.object.empty() ? object_in(its.label) : its.object;
    name = fmt::format("{}{}{}", object, object.empty() ? "" : " ", component);
  } else if (name.empty()) {
    name = stream.channels.size() == 1 ? "" : fmt::format("channel {}", channel + 1);
  }
  if (name.empty()) return stream.name;
  const bool said = small_letters(name).starts_with(small_letters(stream.name));
  return said ? name : stream.name + " " + name;
}

bool is_told(const std::string& name, const std::string& label, const MotionOptions& options) {
  const auto names_it = [&](const std::string& told) {
    const std::size_t star = told.find('*');
    if (star == std::string::npos) return told == name || told == label;
    return name.starts_with(told.substr(0, star)) && name.ends_with(told.substr(star + 1));
  };
  return std::ranges::any_of(options.columns,
                             [&](const ToldColumn& one) { return names_it(one.column); }) ||
         std::ranges::any_of(options.names, [&](const std::string& one) {
           return !one.empty() && name.starts_with(one);
         });
}

/// Streams of signals of the body, of sound and of pictures: a channel "Trigger" is none of a hand.
bool is_signal(const XdfStream& stream) {
  return is_one_of(small_letters(stream.type),
                   {"eeg", "emg", "ecg", "ekg", "eog", "nirs", "fnirs", "eda", "gsr", "ppg",
                    "audio", "video", "videoraw", "videocompressed", "gaze", "eyetracking"});
}

/// Whether a stream has words, a whole position, a button, or a column that the user told.
bool may_be_motion(const XdfStream& stream, const MotionOptions& options) {
  if (stream.has_words()) return true;
  std::vector<std::pair<std::string, int>> places;  // of objects: which of x, y, z
  bool button = false;
  for (std::size_t c = 0; c < stream.channels.size(); ++c) {
    const std::string name = column_name(stream, c);
    if (is_told(name, stream.channels[c].label, options)) return true;
    const Component component = component_of(name);
    button = button || component.quantity == Quantity::trigger;
    if (component.quantity != Quantity::position) continue;
    auto place = std::ranges::find(places, component.object, &std::pair<std::string, int>::first);
    if (place == places.end()) place = places.insert(places.end(), {component.object, 0});
    place->second |= 1 << component.index;
  }
  const bool placed = std::ranges::any_of(places, [](const auto& one) { return one.second == 7; });
  return !is_signal(stream) && (placed || button);
}

std::string said_of(const XdfStream& stream) {
  return fmt::format("'{}' ({}{}{} channel{})", beginning(stream.name, 40),
                     beginning(stream.type, 20), stream.type.empty() ? "" : ", ",
                     stream.channels.size(), stream.channels.size() == 1 ? "" : "s");
}

/// The streams of a file that may be motion, as a table.
class StreamTable {
 public:
  StreamTable(const XdfBytes& bytes, std::string_view where, MotionOptions options)
      : options_(std::move(options)) {
    XdfFile file = read_xdf(
        bytes, where, [&](const XdfStream& stream) { return may_be_motion(stream, options_); });
    table_.of_streams = true;
    table_.kind = "XDF";
    table_.notes = std::move(file.notes);
    make_names_differ(file.streams);
    add_columns(file.streams, where);
    for (XdfStream& stream : file.streams) add_times(stream);
    add_rows(file.streams, where);
    tell_trigger(file.streams);
  }

  const AnyTable& table() const { return table_; }
  const MotionOptions& options() const { return options_; }

 private:
  /// Streams of one program often have one name.
  static void make_names_differ(std::vector<XdfStream>& streams) {
    std::vector<std::string> names;
    for (XdfStream& stream : streams) {
      const auto same = std::ranges::count(names, stream.name);
      names.push_back(stream.name);
      if (same > 0) stream.name += fmt::format(" {}", same + 1);
    }
  }

  void add_columns(const std::vector<XdfStream>& streams, std::string_view where) {
    table_.columns.push_back({"time", "time", "time", "s"});
    std::vector<std::string> others;
    bool numbers = false;
    for (const XdfStream& stream : streams) {
      if (!stream.kept) {
        others.push_back(said_of(stream));
        continue;
      }
      numbers = numbers || !stream.has_words();
      for (std::size_t c = 0; c < stream.channels.size(); ++c) {
        const XdfChannel& channel = stream.channels[c];
        const std::string name = column_name(stream, c);
        const std::string label = channel.label.empty() ? name : channel.label;
        table_.columns.push_back({name, label, label, small_letters(channel.unit)});
      }
    }
    const std::size_t most = 5, left = others.size() - std::min(most, others.size());
    others.resize(others.size() - left);
    const std::string list = fmt::format("{}{}", fmt::join(others, ", "),
                                         left > 0 ? fmt::format(" and {} more", left) : "");
    if (!numbers) {
      throw std::invalid_argument(
          fmt::format("{}: expected a stream with the positions of head and hand; found {}{}{}",
                      where, others.empty() ? "none" : list, table_.notes.empty() ? "" : "; ",
                      table_.notes.empty() ? "" : table_.notes.front()));
    }
    if (!others.empty()) table_.notes.push_back("streams without motion are ignored: " + list);
  }

  void add_times(XdfStream& stream) {
    std::vector<std::string> notes;
    stream.times = synchronised(stream.times, stream.offsets, notes);
    for (const std::string& note : notes) {
      table_.notes.push_back(fmt::format("stream '{}': {}", stream.name, note));
    }
  }

  /// All cells as text, and a row for each sample in the order of the times.
  void add_rows(const std::vector<XdfStream>& streams, std::string_view where) {
    std::size_t rows = 0;
    for (const XdfStream& stream : streams) rows += stream.times.size();
    if (rows > kMostCells / table_.columns.size()) {
      throw std::invalid_argument(
          fmt::format("{}: {} samples in {} columns are too many; expected at most {} cells", where,
                      rows, table_.columns.size(), kMostCells));
    }
    std::vector<std::size_t> ends;
    for (const XdfStream& stream : streams) write_cells(stream, ends);
    std::vector<std::pair<double, AnyTable::Row>> timed;
    timed.reserve(rows);
    std::size_t first = 1, cell = 0, begin = 0;
    const auto next = [&] {
      const std::string_view text = std::string_view(text_).substr(begin, ends[cell] - begin);
      begin = ends[cell++];
      return trimmed(text);
    };
    for (const XdfStream& stream : streams) {
      if (!stream.kept) continue;
      for (std::size_t i = 0; i < stream.times.size(); ++i) {
        AnyTable::Row row{i + 1, std::vector<std::string_view>(table_.columns.size())};
        row.cells[0] = next();
        for (std::size_t c = 0; c < stream.channels.size(); ++c) row.cells[first + c] = next();
        const double time = stream.times[i];
        timed.emplace_back(std::isfinite(time) ? time : std::numeric_limits<double>::infinity(),
                           std::move(row));
      }
      first += stream.channels.size();
    }
    std::ranges::stable_sort(timed, {}, [](const auto& one) { return one.first; });
    table_.rows.reserve(rows);
    for (auto& [time, row] : timed) table_.rows.push_back(std::move(row));
  }

  /// Appends time and values of each sample to the text.
  void write_cells(const XdfStream& stream, std::vector<std::size_t>& ends) {
    const std::size_t width = stream.channels.size();
    for (std::size_t i = 0; i < stream.times.size(); ++i) {
      fmt::format_to(std::back_inserter(text_), "{}", stream.times[i]);
      ends.push_back(text_.size());
      for (std::size_t k = i * width; k < (i + 1) * width; ++k) {
        if (stream.has_words()) {
          text_ += stream.words[k];
        } else {
          fmt::format_to(std::back_inserter(text_), "{}", stream.numbers[k]);
        }
        ends.push_back(text_.size());
      }
    }
  }

  /// Without a button, grab and release may be markers.
  void tell_trigger(const std::vector<XdfStream>& streams) {
    const auto is_trigger = [](const auto& one) {
      return one.key.find("trigger") != std::string::npos;
    };
    const bool told = std::ranges::any_of(options_.columns, is_trigger);
    const bool button = std::ranges::any_of(table_.columns, [](const FoundColumn& column) {
      return component_of(column.name).quantity == Quantity::trigger;
    });
    if (told || button) return;
    for (const XdfStream& stream : streams) {
      const std::size_t width = stream.channels.size();
      for (std::size_t c = 0; c < width && stream.has_words(); ++c) {
        std::array<bool, 2> says{};
        for (std::size_t k = c; k < stream.words.size(); k += width) {
          if (const auto pressed = pressed_by(words_of(stream.words[k]))) says[*pressed] = true;
        }
        if (!says[0] || !says[1]) continue;
        const std::string name = column_name(stream, c);
        table_.notes.push_back(fmt::format("grab and release are the markers '{}'", name));
        options_.columns.push_back({"trigger", name, "markers"});
        return;
      }
    }
  }

  MotionOptions options_;
  std::string text_;  // of all cells
  AnyTable table_;
};

}  // namespace

XdfBytes bytes_of(FileWindow& file) {
  return {file.size(), [&file](std::size_t at, std::size_t count) { return file.read(at, count); }};
}

MotionTracks parse_xdf_motion(const XdfBytes& bytes, std::string_view where,
                              const MotionOptions& options) {
  const StreamTable read(bytes, where, options);
  return tracks_in(read.table(), where, read.options());
}

TableFindings inspect_xdf(const XdfBytes& bytes, std::string_view where,
                          const MotionOptions& options) {
  const StreamTable read(bytes, where, options);
  return findings_in(read.table(), where, read.options());
}

}  // namespace headpin::devices
