#pragma once

#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include "scene/scenario/fields.h"
#include "scene/scenario/scenario.h"

// How the values of a scenario are written.
namespace headpin::scene {

/// A float as TOML wants it: shortest text that reads back to the same bits.
inline std::string number_text(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

/// Writes fields in their order, each with its meaning, and with its source if the value is still
/// that of the source.
class Writer {
 public:
  /// @param sourced  the values to which the sources belong, by key; empty for no sources
  explicit Writer(const std::map<std::string, std::string>& sourced) : sourced_(sourced) {}

  template <typename T, typename Allowed>
  void field(std::string_view key, const T& value, const Allowed&, std::string_view meaning,
             std::string_view source = {}) {
    line(key, text(value), meaning, source);
  }

  template <typename T>
  void section(std::string_view key, std::string_view meaning, T& part) {
    const std::string outer = enter(key, meaning);
    visit(*this, part);
    path_ = outer;
  }

 private:
  void line(std::string_view key, std::string written, std::string_view meaning,
            std::string_view source) {
    const std::string path = path_ + "." + std::string(key);
    const auto usual = sourced_.find(path);
    if (usual == sourced_.end() || usual->second != written) source = {};
    written_[path] = written;
    out_ += fmt::format("{} = {}", key, written);
    if (!meaning.empty() || !source.empty()) {
      out_ +=
          fmt::format("  # {}{}{}", meaning, meaning.empty() || source.empty() ? "" : "; ", source);
    }
    out_ += "\n";
  }

  /// @return  the path of the outer table
  std::string enter(std::string_view key, std::string_view meaning) {
    const std::string outer = path_;
    path_ += (path_.empty() ? "" : ".") + std::string(key);
    out_ += fmt::format("\n[{}]{}\n", path_, meaning.empty() ? "" : fmt::format("  # {}", meaning));
    return outer;
  }

 public:
  std::string out() && { return std::move(out_); }
  std::map<std::string, std::string> written() && { return std::move(written_); }

  static std::string text(double value) { return number_text(value); }
  static std::string text(std::int64_t value) { return fmt::format("{}", value); }
  static std::string text(int value) { return fmt::format("{}", value); }
  static std::string text(bool value) { return value ? "true" : "false"; }
  static std::string text(const std::string& value) {
    if (value.find('\n') != std::string::npos) return escaped(value);
    std::ostringstream quoted;
    quoted << toml::value<std::string>(value);
    return quoted.str();
  }
  template <Choice T>
  static std::string text(T value) {
    return text(std::string(name_of(value)));
  }
  static std::string text(const Hmd& hmd) { return text(hmd.profile); }
  static std::string text(const Vec3& v) {
    return fmt::format("[{}, {}, {}]", text(v.x()), text(v.y()), text(v.z()));
  }
  static std::string text(const Pose& X) {
    return fmt::format("{{p = {}, q = [{}, {}, {}, {}]}}", text(X.p), text(X.q.w()), text(X.q.x()),
                       text(X.q.y()), text(X.q.z()));
  }
  static std::string text(const std::vector<Vec2>& points) {
    std::string all = "[";
    for (const Vec2& p : points) all += fmt::format("\n  [{}, {}],", text(p.x()), text(p.y()));
    return all + "\n]";
  }
  static std::string text(const std::vector<Vec3>& points) {
    std::string all;
    for (const Vec3& p : points) all += (all.empty() ? "" : ", ") + text(p);
    return "[" + all + "]";
  }
  static std::string text(const std::vector<std::vector<std::uint32_t>>& lists) {
    std::string all;
    for (const auto& list : lists) {
      all += fmt::format("{}[{}]", all.empty() ? "" : ", ", fmt::join(list, ", "));
    }
    return "[" + all + "]";
  }
  static std::string text(const std::vector<SkittlePart>& parts) {
    std::string all = "[";
    for (const SkittlePart& p : parts) {
      if (p.shape == PartShape::polyhedron) {
        all += text_of_hull(p);
        continue;
      }
      all += fmt::format("\n  {{shape = {}, radius = {}, low = {}, high = {}}},", text(p.shape),
                         text(p.radius), text(p.low), text(p.high));
    }
    return all + "\n]";
  }
  static std::string text(const std::vector<OilZone>& zones) {
    std::string all;
    for (const OilZone& z : zones) {
      all += fmt::format(
          "\n  {{first_board = {}, last_board = {}, from = {}, to = {}, friction = {}}},",
          z.first_board, z.last_board, text(z.from), text(z.to), text(z.friction));
    }
    return "[" + all + (zones.empty() ? "]" : "\n]");
  }

 private:
  /// A text of several lines, on one line. toml++ writes such a text line by line between three
  /// quotes, where TOML leaves out a line end at the start.
  static std::string escaped(const std::string& value) {
    std::string all = "\"";
    for (const char c : value) {
      const auto code = static_cast<unsigned char>(c);
      if (c == '\n') {
        all += "\\n";
      } else if (c == '"' || c == '\\') {
        all += {'\\', c};
      } else if (code < 0x20 || code == 0x7f) {
        all += fmt::format("\\u{:04X}", static_cast<unsigned>(code));
      } else {
        all += c;
      }
    }
    return all + '"';
  }

  /// On one line, as TOML wants a table in a list.
  static std::string text_of_hull(const SkittlePart& p) {
    return fmt::format(
        "\n  {{shape = \"polyhedron\", file = {}, unit = {}, axes = {}, sha256 = {},"
        " corners = {}, faces = {}}},",
        text(p.mesh.file), text(p.mesh.unit), text(p.mesh.axes), text(p.mesh.sha256),
        text(p.corners), text(p.faces));
  }

  const std::map<std::string, std::string>& sourced_;
  std::map<std::string, std::string> written_;  // by key
  std::string out_;
  std::string path_;
};

}  // namespace headpin::scene
