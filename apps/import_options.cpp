#include "apps/import_options.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include "apps/command.h"
#include "base/input_file.h"
#include "scene/scenario/nearest.h"
#include "scene/scenario/toml_reading.h"

namespace headpin::apps {
namespace {

constexpr std::array<std::pair<std::string_view, double>, 5> kLengths = {
    {{"m", 1.0}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}, {"ft", 0.3048}}};
constexpr std::array<std::pair<std::string_view, double>, 5> kTimes = {
    {{"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}, {"100ns", 1e-7}}};

template <std::size_t N>
std::optional<double> of_name(const std::array<std::pair<std::string_view, double>, N>& all,
                              std::string_view name) {
  for (const auto& [its, value] : all) {
    if (its == name) return value;
  }
  return std::nullopt;
}

/// A word that a user gave for an option, or in a line of a file of columns.
struct Word {
  std::string text;
  std::string where;  ///< "--axes", or "mine.toml:4: axes"
  bool in_file = false;

  /// Wrong words are wrong usage in an option, and a wrong file in a file.
  [[noreturn]] void refuse(std::string_view expected) const {
    const std::string found = text.substr(0, 60);
    if (in_file) {
      throw std::invalid_argument(
          fmt::format("{}: expected {}, found '{}'", where, expected, found));
    }
    throw UsageError(fmt::format("{}: expected {}, found {}", where, expected, found));
  }
};

/// Reads X,Y,Z in metres.
Vec3 read_place(const Word& word) {
  Vec3 p = Vec3::Zero();
  const char *at = word.text.data(), *const end = at + word.text.size();
  for (int i = 0; i < 3; ++i) {
    const auto read = std::from_chars(at, end, p[i]);
    at = read.ptr;
    const bool right = read.ec == std::errc{} && std::abs(p[i]) <= 100.0 &&
                       (i == 2 ? at == end : at != end && *at++ == ',');
    if (!right) word.refuse("X,Y,Z in metres from -100 to 100");
  }
  return p;
}

std::string trimmed_word(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t\n");
  return begin == std::string::npos
             ? ""
             : text.substr(begin, text.find_last_not_of(" \t\n") - begin + 1);
}

std::vector<std::string> parts_of(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);)
    parts.push_back(trimmed_word(part));
  return parts;
}

bool same_letters(std::string word, std::string_view sorted) {
  std::ranges::sort(word);
  return word == sorted;
}

void read_units(const Word& word, devices::MotionOptions& motion) {
  motion.reading.unit_m = of_name(kLengths, word.text);
  if (!motion.reading.unit_m) word.refuse("m, cm, mm, in or ft");
}

/// s, ms, us, ns, or the rate of frames: 90Hz.
void read_time_unit(const Word& word, devices::MotionOptions& motion) {
  const std::string& text = word.text;
  motion.reading.time_unit_s = of_name(kTimes, text);
  if (motion.reading.time_unit_s) return;
  double rate = 0.0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), rate);
  const std::string_view rest(read.ptr, text.data() + text.size());
  if (read.ec != std::errc{} || rest != "Hz" || !(rate >= 1.0 && rate <= 1e5)) {
    word.refuse("s, ms, us, ns, 100ns, or the rate of frames such as 90Hz");
  }
  motion.reading.time_unit_s = 1.0 / rate;
}

/// Axes of positions, and of rotations where they differ: RSA,RSP.
void read_axes(const Word& word, devices::MotionOptions& motion) {
  const std::vector<std::string> parts = parts_of(word.text, ',');
  const auto right = [](const std::string& letters) {
    try {
      devices::Axes(letters, "");
    } catch (const std::invalid_argument&) {
      return false;
    }
    return true;
  };
  if (parts.empty() || parts.size() > 2 || !std::ranges::all_of(parts, right)) {
    word.refuse(
        "where +x, +y and +z point, one letter each of R or L (right, left), S or I (up, down), A "
        "or P (ahead, back), such as RSP, or RSA,RSP where rotations have others");
  }
  motion.reading.axes = parts[0];
  if (parts.size() == 2) motion.reading.turning = parts[1];
}

void read_rotations(const Word& all, devices::MotionOptions& motion) {
  for (const std::string& word : parts_of(all.text, ',')) {
    if (same_letters(word, "wxyz")) {
      motion.reading.quaternion = word;
    } else if (same_letters(word, "XYZ") || same_letters(word, "xyz") || word == "vector" ||
               word == "none") {
      motion.rotations = word;
    } else if (word == "inverse") {
      motion.reading.inverted = true;
    } else if (word == "deg" || word == "rad") {
      motion.degrees = word == "deg";
    } else {
      Word{word, all.where, all.in_file}.refuse(
          "the order of a quaternion (xyzw or wxyz), the order of angles (such as YXZ about "
          "turning or zxy about fixed axes), vector, none, inverse, deg or rad");
    }
  }
}

/// What a line of a file of columns says, where no option says it.
void take_setting(const std::string& key, const std::string& value, const std::string& source,
                  const ImportOptions& options, devices::MotionOptions& motion) {
  const Word word{value, fmt::format("{}: {}", source, key), true};
  if (key == "units") {
    if (options.units.empty()) read_units(word, motion);
  } else if (key == "time_unit") {
    if (options.time_unit.empty()) read_time_unit(word, motion);
  } else if (key == "axes") {
    if (options.axes.empty()) read_axes(word, motion);
  } else if (key == "rotations") {
    if (options.rotations.empty()) read_rotations(word, motion);
  } else if (devices::is_column_key(key)) {
    motion.columns.push_back({key, value, source});
  } else {
    throw std::invalid_argument(
        fmt::format("{}: unknown key '{}'; expected {} (or units, time_unit, axes, rotations)",
                    source, key, devices::kColumnKeys));
  }
}

void read_mapping(const ImportOptions& options, devices::MotionOptions& motion) {
  const std::string& path = options.columns;
  const std::string text = base::read_text(path, 1'000'000);
  const toml::table root = scene::parse_toml(text, path);
  const auto take = [&](const std::string& key, const toml::node& node) {
    const std::string source = fmt::format("{}:{}", path, node.source().begin.line);
    const auto* value = node.as_string();
    if (!value) {
      throw std::invalid_argument(fmt::format("{}: {}: expected a name in quotes", source, key));
    }
    take_setting(key, value->get(), source, options, motion);
  };
  for (const auto& [key, node] : root) {
    const std::string name(key.str());
    if (const toml::table* part = node.as_table()) {
      for (const auto& [component, inner] : *part) {
        take(fmt::format("{}.{}", name, component.str()), inner);
      }
    } else {
      take(name, node);
    }
  }
}

/// "time=t, head=HMD_*": columns in the text of the option itself.
void read_columns(const ImportOptions& options, devices::MotionOptions& motion) {
  if (options.columns.empty()) return;
  if (options.columns.ends_with(".toml")) return read_mapping(options, motion);
  for (const std::string& part : parts_of(options.columns, ',')) {
    const std::size_t sign = part.find('=');
    if (sign == std::string::npos) {
      Word{options.columns, "--columns"}.refuse(
          "WHAT=COLUMN, ... such as time=t, head=HMD_*; or a .toml file");
    }
    const std::string key = trimmed_word(part.substr(0, sign));
    if (std::ranges::find(motion.columns, key, &devices::ToldColumn::key) != motion.columns.end()) {
      Word{key, "--columns"}.refuse("each key once");
    }
    motion.columns.push_back({key, trimmed_word(part.substr(sign + 1)), "--columns"});
  }
}

void read_names(const ImportOptions& options, devices::MotionOptions& motion) {
  if (options.names.empty()) return;
  std::istringstream names(options.names);
  for (std::string& name : motion.names) std::getline(names, name, ',');
  const auto& [head, left, right] = motion.names;
  if (std::ranges::count(options.names, ',') != 2 || head.empty() ||
      (left.empty() && right.empty())) {
    Word{options.names, "--names"}.refuse(
        "three names HEAD,LEFT,RIGHT, one hand of which may be empty");
  }
}

/// A text that ends in a list of columns.
std::string with_explain(std::string text) {
  if (text.ends_with("...")) text += " (--explain shows all)";
  return text;
}

/// Says of a told column what the table has instead.
[[noreturn]] void refuse_column(const devices::WrongColumn& error) {
  const devices::ToldColumn& told = error.told;
  const std::optional<std::string> meant = scene::nearest(told.column, error.known);
  const std::string text =
      meant ? fmt::format("{}: {}; the nearest is {}", told.source, error.wrong, *meant)
            : with_explain(error.what());
  if (told.source.starts_with("--")) throw UsageError(text);
  throw std::invalid_argument(text);
}

/// What `read()` gives; its errors name the options with which it would succeed.
auto with_options(const auto& read) {
  try {
    return read();
  } catch (const devices::WrongColumn& error) {
    refuse_column(error);
  } catch (const devices::UnclearColumns& error) {
    throw std::invalid_argument(with_explain(error.what()) +
                                "; --columns 'time=t, head=HMD_*, right=ctrl_*' says which columns "
                                "are meant");
  } catch (const devices::UnclearObjects& error) {
    throw std::invalid_argument(std::string(error.what()) +
                                "; --names HEAD,LEFT,RIGHT says which; a hand may be left empty");
  }
}

}  // namespace

devices::MotionOptions declared(const ImportOptions& options) {
  devices::MotionOptions motion;
  motion.names_source = "--names";
  read_columns(options, motion);
  if (!options.units.empty()) read_units({options.units, "--units"}, motion);
  if (!options.time_unit.empty()) read_time_unit({options.time_unit, "--time-unit"}, motion);
  if (!options.axes.empty()) read_axes({options.axes, "--axes"}, motion);
  if (!options.rotations.empty()) read_rotations({options.rotations, "--rotations"}, motion);
  motion.only_hand_is_left = options.hand == "left";
  motion.no_hand = options.hand == "none";
  if (options.hand == "left" || options.hand == "right") {
    motion.left_throws = options.hand == "left";
  }
  if (!options.transmitter.empty())
    motion.p_origin = read_place({options.transmitter, "--transmitter"});
  if (!options.head.empty()) motion.p_head = read_place({options.head, "--head"});
  read_names(options, motion);
  return motion;
}

devices::MotionRecording read_declared(const std::string& file,
                                       const devices::MotionOptions& motion) {
  return with_options([&] { return devices::read_motion(file, motion); });
}

devices::TableFindings inspect_declared(const std::string& file,
                                        const devices::MotionOptions& motion) {
  return with_options([&] { return devices::format_of(file)->inspect(file, motion); });
}

namespace {

std::string name_of(const auto& all, double value) {
  for (const auto& [name, its] : all) {
    if (its == value) return std::string(name);
  }
  return "";
}

std::string time_unit_name(double unit_s) {
  const std::string name = name_of(kTimes, unit_s);
  return name.empty() ? fmt::format("{:.9g}Hz", 1.0 / unit_s) : name;
}

std::string axes_text(const devices::Reading& reading) {
  return reading.turning == reading.axes ? reading.axes : reading.axes + "," + reading.turning;
}

std::string rotations_text(const devices::Reading& reading) {
  std::vector<std::string> words;  // of parts with a quaternion, and of parts with angles
  const bool one_order = !reading.quaternion.empty() && !reading.own_orders;
  if (one_order && reading.angles != "none") words.push_back(reading.quaternion);
  if (!reading.angles.empty()) words.push_back(reading.angles);
  if (reading.inverted) words.emplace_back("inverse");
  return fmt::format("{}", fmt::join(words, ","));
}

}  // namespace

std::string options_between(const devices::Reading& was, const devices::Reading& is) {
  std::string text;
  const auto add = [&](const std::string& option, const std::string& value) {
    text += fmt::format("{}{} {}", text.empty() ? "" : " ", option, value);
  };
  if (is.unit_m != was.unit_m && !is.own_units) add("--units", name_of(kLengths, is.unit_m));
  if (is.time_unit_s != was.time_unit_s) add("--time-unit", time_unit_name(is.time_unit_s));
  if (axes_text(is) != axes_text(was)) add("--axes", axes_text(is));
  if (rotations_text(is) != rotations_text(was)) add("--rotations", rotations_text(is));
  return text;
}

std::string mapping_text(const std::string& file, const devices::ToldColumns& columns,
                         const std::vector<std::string>& names,
                         const devices::MotionRecording* recording) {
  std::string text =
      "# How `headpin import --columns` reads " + file + ": a name, or #3 for the third column.\n";
  const auto line = [&](std::string_view key, const std::string& value) {
    std::ostringstream quoted;
    quoted << toml::value<std::string>(value);
    text += fmt::format("{} = {}\n", key, quoted.str());
  };
  for (const devices::ToldColumn& one : columns) {
    if (one.key.find('.') == std::string::npos) line(one.key, one.column);
  }
  if (recording) {
    const devices::Reading& reading = recording->reading;
    line("time_unit", time_unit_name(reading.time_unit_s));
    if (!reading.own_units) line("units", name_of(kLengths, reading.unit_m));
    line("axes", axes_text(reading));
    if (const std::string rotations = rotations_text(reading); !rotations.empty())
      line("rotations", rotations);
  }
  if (columns.empty() || !recording) {
    text +=
        "# To be said: time = 'COLUMN', and for [head] and [right] or [left] x, y, z, and qw, qx, "
        "qy, qz.\n";
    for (const std::string& name : names) text += "#   " + name + "\n";
  }
  for (const char* part : devices::kPartKeys) {
    bool first = true;
    for (const devices::ToldColumn& one : columns) {
      if (!one.key.starts_with(std::string(part) + ".")) continue;
      if (first) text += fmt::format("\n[{}]\n", part);
      first = false;
      line(one.key.substr(one.key.find('.') + 1), one.column);
    }
  }
  return text;
}

}  // namespace headpin::apps
