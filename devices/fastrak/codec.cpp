#include "devices/fastrak/codec.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>

namespace headpin::devices {
namespace {

constexpr std::size_t kHead = 3;  // '0', station, error

/// The content of an item; the extended-precision item of the same number has the same content.
enum class Content {
  none,
  space,
  line_end,
  position,
  relative,
  angles,
  row1,
  row2,
  row3,
  quaternion,
  stylus_switch,
};

enum class Width { plain, extended, compact };

struct Item {
  Content content = Content::none;
  Width width = Width::plain;

  /// Of an item that has numbers.
  int values() const { return content == Content::quaternion ? 4 : 3; }
  /// Digits behind the point in plain ASCII.
  int decimals() const { return content <= Content::angles ? 2 : 4; }
};

Item item_of(int number) {
  switch (number) {
    case 0:
    case 50:
      return {Content::space};
    case 1:
    case 51:
      return {Content::line_end};
    case 2:
      return {Content::position};
    case 3:
      return {Content::relative};
    case 4:
      return {Content::angles};
    case 5:
      return {Content::row1};
    case 6:
      return {Content::row2};
    case 7:
      return {Content::row3};
    case 11:
      return {Content::quaternion};
    case 16:
    case 66:
      return {Content::stylus_switch};
    case 18:
      return {Content::position, Width::compact};
    case 19:
      return {Content::angles, Width::compact};
    case 20:
      return {Content::quaternion, Width::compact};
    case 52:
      return {Content::position, Width::extended};
    case 53:
      return {Content::relative, Width::extended};
    case 54:
      return {Content::angles, Width::extended};
    case 55:
      return {Content::row1, Width::extended};
    case 56:
      return {Content::row2, Width::extended};
    case 57:
      return {Content::row3, Width::extended};
    case 61:
      return {Content::quaternion, Width::extended};
    default:
      return {};
  }
}

std::size_t value_length(const Item& item, bool binary) {
  if (item.width == Width::compact) return 2;
  if (binary) return 4;
  return item.width == Width::extended ? 13 : 7;
}

std::size_t length_of(const Item& item, bool binary) {
  switch (item.content) {
    case Content::none:
      return 0;
    case Content::space:
      return 1;
    case Content::line_end:
    case Content::stylus_switch:
      return 2;
    default:
      return static_cast<std::size_t>(item.values()) * value_length(item, binary);
  }
}

/// Full-scale value of a compact item, which is its code 8192.
double full_scale(const Item& item, const FastrakFormat& format) {
  switch (item.content) {
    case Content::angles:
      return 180.0;
    case Content::quaternion:
      return 1.0;
    default:
      return format.centimetres ? 300.0 : 118.110;
  }
}

using Values = std::array<double, 4>;

Values values_of(const FastrakRecord& r, Content content) {
  const auto three = [](const auto& v) { return Values{v(0), v(1), v(2), 0.0}; };
  switch (content) {
    case Content::position:
      return three(r.position);
    case Content::relative:
      return three(r.relative);
    case Content::angles:
      return three(r.angles_deg);
    case Content::row1:
      return three(r.attitude.row(0));
    case Content::row2:
      return three(r.attitude.row(1));
    case Content::row3:
      return three(r.attitude.row(2));
    case Content::quaternion:
      return r.quaternion;
    default:
      return {};
  }
}

void set_values(FastrakRecord& r, Content content, const Values& v) {
  const Vec3 three(v[0], v[1], v[2]);
  switch (content) {
    case Content::position:
      r.position = three;
      break;
    case Content::relative:
      r.relative = three;
      break;
    case Content::angles:
      r.angles_deg = three;
      break;
    case Content::row1:
      r.attitude.row(0) = three;
      break;
    case Content::row2:
      r.attitude.row(1) = three;
      break;
    case Content::row3:
      r.attitude.row(2) = three;
      break;
    case Content::quaternion:
      r.quaternion = v;
      break;
    default:
      break;
  }
}

/// Whether a value without error letter is possible. Rounding to four decimals changes the norm of
/// a unit vector by less than 2e-4; float32 and 14 bits change it even less.
bool possible(Content content, const Values& v) {
  constexpr double kRounding = 1e-3;
  switch (content) {
    case Content::position:
      return std::ranges::all_of(v, [](double x) { return std::abs(x) <= kFastrakFarthest; });
    case Content::angles:
      return std::abs(v[0]) <= 180.01 && std::abs(v[1]) <= 90.01 && std::abs(v[2]) <= 180.01;
    case Content::row1:
    case Content::row2:
    case Content::row3:
    case Content::quaternion:
      return std::abs(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + v[3] * v[3] - 1.0) <= kRounding;
    default:
      return true;
  }
}

void append(std::string_view text, std::vector<std::uint8_t>& out) {
  out.insert(out.end(), text.begin(), text.end());
}

/// `value` rounded to `decimals`, right-justified in `width` columns, blank for plus.
void append_fixed(double value, int width, int decimals, std::vector<std::uint8_t>& out) {
  double largest = std::pow(10.0, width - decimals - 2) - std::pow(10.0, -decimals);
  if (std::isnan(value)) value = 0.0;
  value = std::clamp(value, -largest, largest);
  std::array<char, 32> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value,
                                          std::chars_format::fixed, decimals);
  std::string_view digits(text.data(), static_cast<std::size_t>(end - text.data()));
  if (digits.find_first_not_of("-0.") == std::string_view::npos && digits.front() == '-') {
    digits.remove_prefix(1);  // no minus before a zero
  }
  out.insert(out.end(), static_cast<std::size_t>(width) - digits.size(), ' ');
  append(digits, out);
}

/// Extended precision: sign, d.ddddd, E, sign, two digits, blank: 13 columns.
void append_extended(double value, std::vector<std::uint8_t>& out) {
  if (!std::isfinite(value) || std::abs(value) < 1e-99) value = 0.0;
  value = std::clamp(value, -9.99999e99, 9.99999e99);
  std::array<char, 32> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value,
                                          std::chars_format::scientific, 5);
  std::string_view digits(text.data(), static_cast<std::size_t>(end - text.data()));
  if (digits.front() != '-') out.push_back(' ');
  const std::size_t e = digits.find('e');
  append(digits.substr(0, e), out);
  out.push_back('E');
  append(digits.substr(e + 1), out);
  out.push_back(' ');
}

void append_float(double value, std::vector<std::uint8_t>& out) {
  const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(value) + 0.0F);  // no -0
  for (int shift = 0; shift < 32; shift += 8) {
    out.push_back(static_cast<std::uint8_t>(bits >> shift));
  }
}

/// Fourteen bits in two's complement, the low seven first; bit 7 stays clear.
void append_compact(double value, double scale, std::vector<std::uint8_t>& out) {
  const double code = std::isnan(value) ? 0.0 : std::clamp(value / scale * 8192.0, -8192.0, 8191.0);
  const auto bits = static_cast<unsigned>(std::lround(code));
  out.push_back(static_cast<std::uint8_t>(bits & 0x7Fu));
  out.push_back(static_cast<std::uint8_t>((bits >> 7) & 0x7Fu));
}

bool is_digit(std::uint8_t c) {
  return c >= '0' && c <= '9';
}

/// Columns of blanks, a sign, digits, point and exactly `decimals` digits.
bool read_fixed(Bytes text, int decimals, double& value) {
  const std::size_t point = text.size() - static_cast<std::size_t>(decimals) - 1;
  std::size_t at = 0;
  while (at < point && text[at] == ' ') ++at;
  const bool minus = text[at] == '-';
  if (minus || text[at] == '+') ++at;
  if (at >= point || text[point] != '.') return false;
  std::int64_t digits = 0;
  for (; at < text.size(); ++at) {
    if (at == point) continue;
    if (!is_digit(text[at])) return false;
    digits = 10 * digits + (text[at] - '0');
  }
  // One division of two exact numbers: the double nearest to the decimal.
  const double magnitude = static_cast<double>(digits) / (decimals == 2 ? 100.0 : 10000.0);
  value = minus ? -magnitude : magnitude;
  return true;
}

bool read_extended(Bytes text, double& value) {
  const auto shaped = [&](std::size_t i) {
    const std::uint8_t c = text[i];
    switch (i) {
      case 0:
        return c == ' ' || c == '-' || c == '+';
      case 2:
        return c == '.';
      case 8:
        return c == 'E';
      case 9:
        return c == '-' || c == '+';
      case 12:
        return c == ' ';
      default:
        return is_digit(c);
    }
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (!shaped(i)) return false;
  }
  const auto* first = reinterpret_cast<const char*>(text.data()) + (text[0] == '-' ? 0 : 1);
  const auto* last = reinterpret_cast<const char*>(text.data()) + 12;
  return std::from_chars(first, last, value).ec == std::errc{};
}

bool read_float(Bytes bytes, double& value) {
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < 4; ++i) bits |= static_cast<std::uint32_t>(bytes[i]) << (8 * i);
  value = static_cast<double>(std::bit_cast<float>(bits));
  return std::isfinite(value);
}

bool read_compact(Bytes bytes, bool first, double scale, double& value) {
  if ((bytes[0] >> 7) != (first ? 1 : 0) || (bytes[1] >> 7) != 0) return false;
  const int code = (bytes[0] & 0x7F) | ((bytes[1] & 0x7F) << 7);
  value = (code >= 8192 ? code - 16384 : code) * scale / 8192.0;
  return true;
}

bool is_head(Bytes bytes) {
  constexpr auto letter = [](std::uint8_t c) {
    return c == ' ' || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
  };
  return (bytes.empty() || bytes[0] == '0') &&
         (bytes.size() < 2 || (bytes[1] >= '1' && bytes[1] <= '4')) &&
         (bytes.size() < 3 || letter(bytes[2]));
}

std::string text_of(const std::vector<std::uint8_t>& bytes) {
  return {bytes.begin(), bytes.end()};
}

enum class Verdict { no, yes, wait };

/// Whether a record begins at the front of `bytes`, and how many bytes it has.
Verdict candidate(Bytes bytes, const FastrakFormats& formats, FastrakFound& found) {
  if (!is_head(bytes.first(std::min(bytes.size(), kHead)))) return Verdict::no;
  if (bytes.size() < kHead) return Verdict::wait;
  const FastrakFormat& format = formats[static_cast<std::size_t>(bytes[1] - '1')];
  const std::size_t length = fastrak_record_length(format);
  if (bytes.size() < length) return Verdict::wait;
  const auto record = decode_record(bytes.first(length), format);
  if (!record) return Verdict::no;
  found.length = length;
  found.record = *record;
  return Verdict::yes;
}

/// Whether another record seems to begin after one of `length` bytes.
Verdict followed(Bytes bytes, std::size_t length) {
  const Bytes next = bytes.subspan(length, std::min(kHead, bytes.size() - length));
  if (!is_head(next)) return Verdict::no;
  return next.size() < kHead ? Verdict::wait : Verdict::yes;
}

/// Whether a record that begins inside the first one is more plausible: it decodes, and the next
/// one begins directly after it.
Verdict rivalled(Bytes bytes, const FastrakFormats& formats, std::size_t length) {
  Verdict verdict = Verdict::no;
  for (std::size_t i = 1; i < length; ++i) {
    FastrakFound rival;
    Verdict v = candidate(bytes.subspan(i), formats, rival);
    if (v == Verdict::yes) v = followed(bytes.subspan(i), rival.length);
    if (v == Verdict::yes) return v;
    if (v == Verdict::wait) verdict = v;
  }
  return verdict;
}

}  // namespace

bool is_fastrak_item(int item, bool early_firmware) {
  const Item found = item_of(item);
  return found.content != Content::none && (early_firmware || found.width != Width::compact);
}

std::size_t fastrak_item_length(int item, bool binary) {
  return length_of(item_of(item), binary);
}

std::size_t fastrak_record_length(const FastrakFormat& format) {
  std::size_t length = kHead;
  for (const int item : format.items) length += length_of(item_of(item), format.binary);
  return length;
}

void encode_record(const FastrakRecord& record, const FastrakFormat& format,
                   std::vector<std::uint8_t>& out) {
  out.push_back('0');
  out.push_back(static_cast<std::uint8_t>('0' + record.station));
  out.push_back(static_cast<std::uint8_t>(record.error));
  const std::size_t data = out.size();
  for (const int number : format.items) {
    const Item item = item_of(number);
    switch (item.content) {
      case Content::none:
        break;
      case Content::space:
        out.push_back(' ');
        break;
      case Content::line_end:
        append("\r\n", out);
        break;
      case Content::stylus_switch:
        append(record.pressed ? " 1" : " 0", out);
        break;
      default: {
        const bool first = out.size() == data;
        const Values values = values_of(record, item.content);
        for (std::size_t i = 0; i < static_cast<std::size_t>(item.values()); ++i) {
          if (item.width == Width::compact) {
            append_compact(values[i], full_scale(item, format), out);
          } else if (format.binary) {
            append_float(values[i], out);
          } else if (item.width == Width::extended) {
            append_extended(values[i], out);
          } else {
            append_fixed(values[i], 7, item.decimals(), out);
          }
        }
        // Compact data are marked by bit 7 of the first byte of the data set (IS-900 guide, p. 69).
        if (first && item.width == Width::compact) out[data] |= 0x80;
      }
    }
  }
}

std::optional<FastrakRecord> decode_record(Bytes bytes, const FastrakFormat& format) {
  if (bytes.size() < kHead || !is_head(bytes.first(kHead))) return std::nullopt;
  FastrakRecord record;
  record.station = bytes[1] - '0';
  record.error = static_cast<char>(bytes[2]);
  std::size_t at = kHead;
  for (const int number : format.items) {
    const Item item = item_of(number);
    const std::size_t length = length_of(item, format.binary);
    if (bytes.size() - at < length) return std::nullopt;
    const Bytes field = bytes.subspan(at, length);
    switch (item.content) {
      case Content::none:
        break;
      case Content::space:
        if (field[0] != ' ') return std::nullopt;
        break;
      case Content::line_end:
        if (field[0] != '\r' || field[1] != '\n') return std::nullopt;
        break;
      case Content::stylus_switch:
        if (field[0] != ' ' || (field[1] != '0' && field[1] != '1')) return std::nullopt;
        record.pressed = field[1] == '1';
        break;
      default: {
        const std::size_t step = value_length(item, format.binary);
        Values values{};
        for (std::size_t i = 0; i < static_cast<std::size_t>(item.values()); ++i) {
          const Bytes text = field.subspan(i * step, step);
          double& value = values[i];
          const bool ok =
              item.width == Width::compact
                  ? read_compact(text, at == kHead && i == 0, full_scale(item, format), value)
              : format.binary                 ? read_float(text, value)
              : item.width == Width::extended ? read_extended(text, value)
                                              : read_fixed(text, item.decimals(), value);
          if (!ok) return std::nullopt;
        }
        if (record.error == ' ' && !possible(item.content, values)) return std::nullopt;
        set_values(record, item.content, values);
      }
    }
    at += length;
  }
  return at == bytes.size() ? std::optional(record) : std::nullopt;
}

FastrakFound find_record(Bytes bytes, const FastrakFormats& formats, bool in_step, bool no_more) {
  FastrakFound found;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    found.skipped = i;
    const Bytes rest = bytes.subspan(i);
    Verdict verdict = candidate(rest, formats, found);
    if (verdict == Verdict::yes && !(in_step && i == 0)) {
      verdict = followed(rest, found.length);
      if (verdict == Verdict::no) {
        verdict = rivalled(rest, formats, found.length);
        if (verdict == Verdict::yes) {
          verdict = Verdict::no;
        } else if (verdict == Verdict::no || no_more) {
          verdict = Verdict::yes;
        }
      } else if (no_more) {
        verdict = Verdict::yes;
      }
    }
    if (verdict == Verdict::yes) return found;
    found.length = 0;
    if (verdict == Verdict::wait && !no_more) return found;
  }
  found.skipped = bytes.size();
  return found;
}

std::string encode_columns(std::span<const double> values, int width, int decimals) {
  std::vector<std::uint8_t> out;
  for (const double value : values) append_fixed(value, width, decimals, out);
  return text_of(out);
}

}  // namespace headpin::devices
