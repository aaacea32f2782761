#include "devices/recordings/column_names.h"

#include <algorithm>
#include <cctype>
#include <cstdint>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "devices/recordings/any_table.h"

namespace headpin::devices {
namespace {

std::string joined(std::vector<std::string> words, std::size_t count) {
  words.resize(count);
  return fmt::format("{}", fmt::join(words, " "));
}

std::size_t index_in(std::string_view letters, char letter) {
  return letters.find(letter);
}

Quantity quantity_called(std::string_view word) {
  if (is_one_of(word, {"pos", "position", "p", "loc", "location", "translation", "trans", "t"}))
    return Quantity::position;
  if (is_one_of(word,
                {"q", "quat", "quaternion", "rotation", "rot", "orientation", "ori", "orient"})) {
    return Quantity::quaternion;
  }
  if (is_one_of(word, {"euler", "angle", "angles", "eul"})) return Quantity::angle;
  return Quantity::none;
}

/// "qx", "posx", "rotw", "tz", "rx": a quantity and a letter in one word.
std::optional<Component> two_in_one(std::string_view word) {
  if (word.size() < 2) return std::nullopt;
  const std::size_t letter = index_in("xyz", word.back());
  const std::string_view quantity = word.substr(0, word.size() - 1);
  const Quantity said = quantity == "e"   ? Quantity::angle
                        : quantity == "r" ? Quantity::quaternion
                                          : quantity_called(quantity);
  if (word.back() == 'w' && said == Quantity::quaternion) return Component{said, 0, {}};
  if (letter >= 3 || said == Quantity::none) return std::nullopt;
  if (said == Quantity::quaternion) {
    // "rx" without an "rw" is an angle: decided when all columns are known.
    return Component{said, letter + 1, {}};
  }
  return Component{said, letter, {}};
}

/// Words between an object and its component that say nothing: "local", "global".
bool says_nothing(std::string_view word) {
  return is_one_of(word, {"local", "global", "world", "pose", "transform", "m", "mm", "cm", "deg",
                          "rad", "angles"});
}

std::size_t last_word(const std::vector<std::string>& words, std::size_t count) {
  while (count > 0 && says_nothing(words[count - 1])) --count;
  return count;
}

/// Whether a text ends with a Latin letter beyond ASCII, or an accent on a letter: in UTF-8, or a byte of Latin 1.
bool ends_with_latin_letter(std::string_view text) {
  const auto byte = [&](std::size_t back) -> std::uint32_t {
    return back > text.size() ? 0u : static_cast<unsigned char>(text[text.size() - back]);
  };
  // The signs of times and divided by.
  const auto is_sign = [](std::uint32_t code) { return code == 0xd7 || code == 0xf7; };
  if (byte(1) >= 0xc0) return !is_sign(byte(1));  // no byte of UTF-8 is so at the end of a sign
  if (byte(1) < 0x80) return false;
  if (byte(3) == 0xe1) return byte(2) >= 0xb8 && byte(2) <= 0xbb;  // U+1E00 to U+1EFF
  if (byte(2) < 0xc0 || byte(2) >= 0xe0) return false;
  const std::uint32_t code = ((byte(2) & 0x1fu) << 6u) | (byte(1) & 0x3fu);
  const bool letter = code >= 0xc0 && code < 0x2b0 && !is_sign(code);
  return letter || (code >= 0x300 && code < 0x370);
}

}  // namespace

Component component_of(const std::string& name) {
  std::vector<std::string> words = words_of(name);
  std::size_t n = words.size();
  // A unit behind the name: "head_x_mm".
  while (n > 1 &&
         is_one_of(words[n - 1], {"m", "mm", "cm", "deg", "rad", "degrees", "meters", "metres"}))
    --n;
  if (n == 0) return {};
  const std::string& last = words[n - 1];

  const bool measured = n > 1 && is_one_of(last, {"value", "state", "pressed", "axis"});
  if (measured &&
      is_one_of(words[n - 2], {"trigger", "squeeze", "grip", "button", "grab", "pinch"})) {
    return {Quantity::trigger, 0, joined(words, n - 2)};
  }
  if (is_one_of(last, {"trigger", "squeeze", "grip", "button", "pressed", "grab", "pinch"})) {
    return {Quantity::trigger, 0, joined(words, n - 1)};
  }
  if (const std::size_t angle = is_one_of(last, {"pitch"})                       ? 0
                                : is_one_of(last, {"yaw", "heading", "azimuth"}) ? 1
                                : is_one_of(last, {"roll"})                      ? 2
                                                                                 : 3;
      angle < 3) {
    std::size_t before = last_word(words, n - 1);
    if (before > 0 && quantity_called(words[before - 1]) != Quantity::none) --before;
    return {Quantity::angle, angle, joined(words, before)};
  }
  // "m00" or "r11": words are split at digits.
  const bool digits =
      last.size() == 2 && std::ranges::all_of(last, [](char c) { return c >= '0' && c <= '3'; });
  if (digits && n > 1 && is_one_of(words[n - 2], {"m", "r", "mat", "matrix", "rot", "rotation"})) {
    const std::size_t before = last_word(words, n - 2);
    return {Quantity::matrix,
            10u * static_cast<std::size_t>(last[0] - '0') + static_cast<std::size_t>(last[1] - '0'),
            joined(words, before)};
  }
  if (auto both = two_in_one(last)) {
    std::size_t before = last_word(words, n - 1);
    both->object = joined(words, before);
    return *both;
  }
  if (last.size() != 1 || index_in("wxyz", last[0]) > 3) return {};
  const std::size_t letter = index_in("wxyz", last[0]);
  std::size_t before = last_word(words, n - 1);
  Quantity said = before > 0 ? quantity_called(words[before - 1]) : Quantity::none;
  if (said != Quantity::none) --before;
  // "rotation.eulerAngles.x", "rot_q_x"
  if (before > 0 && said != Quantity::none && said != Quantity::position &&
      quantity_called(words[before - 1]) != Quantity::none)
    --before;
  if (said == Quantity::none) said = letter == 0 ? Quantity::quaternion : Quantity::position;
  if (letter == 0 && said != Quantity::quaternion) return {};
  const std::string object = joined(words, last_word(words, before));
  return {said, said == Quantity::quaternion ? letter : letter - 1, object};
}

std::vector<std::string> words_of(std::string_view name) {
  std::vector<std::string> words;
  const auto is = [](char x, int (*test)(int)) { return test(static_cast<unsigned char>(x)) != 0; };
  char before = ' ';
  for (std::size_t i = 0; i < name.size(); ++i) {
    const char c = name[i], after = i + 1 < name.size() ? name[i + 1] : ' ';
    const auto byte = static_cast<unsigned char>(c);
    const bool part_of_word = is(c, std::isalnum) || byte >= 128;
    // Letters beyond ASCII that follow each other are of one word, and small letters behind Latin ones.
    const bool goes_on = (byte >= 128 && static_cast<unsigned char>(before) >= 128) ||
                         (is(c, std::islower) && ends_with_latin_letter(name.substr(0, i)));
    // "posX" and "HMDPos" are two words each.
    const bool capital =
        is(c, std::isupper) &&
        (is(before, std::islower) || (is(before, std::isupper) && is(after, std::islower)));
    const bool begins =
        !is(before, std::isalnum) || capital || is(c, std::isdigit) != is(before, std::isdigit);
    if (part_of_word) {
      if ((begins && !goes_on) || words.empty()) words.emplace_back();
      words.back() += static_cast<char>(std::tolower(byte));
    }
    before = c;
  }
  return words;
}

std::optional<std::size_t> part_of_name(std::string_view name) {
  const std::vector<std::string> words = words_of(name);
  const std::string text = small_letters(name);
  const auto has = [&](std::string_view part) { return text.find(part) != std::string::npos; };
  const auto word = [&](std::string_view whole_word) {
    return std::ranges::find(words, whole_word) != words.end();
  };
  const bool eye = has("eye");  // Unity's LeftEyeAnchor is no hand, CenterEyeAnchor the head
  if (has("hmd") || has("camera") || has("helmet") || has("headset") || has("glasses") ||
      word("view") || word("viewer") || has("centereye") || has("center eye") ||
      (has("head") && !has("ahead"))) {
    return 0;
  }
  if (eye) return std::nullopt;
  if (has("left") || word("l") || word("lhand")) return 1;
  if (has("right") || word("r") || word("rhand")) return 2;
  return std::nullopt;
}

}  // namespace headpin::devices
