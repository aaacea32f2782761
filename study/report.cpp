#include "study/report.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "study/paper_tables.h"

namespace headpin::study {

namespace {

constexpr const char* kStyle =
    "body{font:15px/1.5 system-ui,sans-serif;max-width:70em;margin:2em auto;padding:0 "
    "1em;color:#222}"
    "table{border-collapse:collapse;margin:.6em 0}th,td{padding:.15em .7em;text-align:left;"
    "border-bottom:1px solid #ddd}th{border-bottom:2px solid #888}td.n{text-align:right;"
    "font-variant-numeric:tabular-nums}.note{color:#666;font-size:90%}.virtual{background:#fff3cd;"
    "padding:.5em 1em;border-left:4px solid #c9a227}img{max-width:100%}"
    ".throws svg{width:44px;height:96px;margin:1px}.throws a{text-decoration:none}"
    "details{margin:.4em 0}.wide{overflow-x:auto}";

bool is_number(const std::string& cell) {
  return !cell.empty() && cell.find_first_not_of("0123456789.-+e%") == std::string::npos;
}

std::string row_of(const std::vector<std::string>& cells, const char* kind) {
  std::string row = "<tr>";
  for (const std::string& cell : cells) {
    row += fmt::format("<{0}{2}>{1}</{0}>", kind, escaped(cell), is_number(cell) ? " class=n" : "");
  }
  return row + "</tr>\n";
}

std::string table_of(const Table& table, const Design& design) {
  std::string html = fmt::format("<h3>{}</h3>\n<div class=wide><table>\n", escaped(table.title));
  std::vector<std::string> names;
  for (const Column& column : table.columns) names.push_back(column.name);
  html += row_of(names, "th");
  for (const auto& row : table.rows) html += row_of(row, "td");
  html += "</table></div>\n";
  for (const Note& note : design.notes) {
    if (note.table == table.name) html += fmt::format("<p class=note>{}</p>\n", escaped(note.text));
  }
  return html;
}

/// A picture of a throw from above: release, direction, and skittles knocked down.
std::string throw_picture(const scene::ThrowRow& one, bool red) {
  constexpr double kPerMetre = 10.0, kAcross = 22.0, kFoulLine = 84.0, kAhead = 6.0, kWidth = 44.0;
  std::string svg =
      "<svg viewBox='0 0 44 96'><rect x='16.7' y='14' width='10.5' height='70' "
      "fill='#eee'/><line x1='12' x2='32' y1='84' y2='84' stroke='#999'/>";
  if (one.p_WB && one.v_WB && one.v_WB->y() > 0.1) {
    const double x = kAcross + kPerMetre * one.p_WB->x(), y = kFoulLine - kPerMetre * one.p_WB->y();
    const double ahead = kAhead * kPerMetre, aside = one.v_WB->x() / one.v_WB->y() * ahead;
    double part = 1.0;  // of the line; it ends at the edge
    if (aside != 0.0) part = std::clamp(((aside > 0.0 ? kWidth : 0.0) - x) / aside, 0.0, 1.0);
    svg += fmt::format(
        "<line x1='{:.1f}' y1='{:.1f}' x2='{:.1f}' y2='{:.1f}' stroke='{}' "
        "stroke-width='1.5'/>",
        x, y, x + part * aside, y - part * ahead, red ? "#b42d2d" : "#1f6fb4");
  }
  return svg +
         fmt::format("<text x='22' y='11' text-anchor='middle' font-size='11'>{}</text></svg>",
                     one.counted ? fmt::format("{}", *one.counted) : "-");
}

/// A text in which the characters that are not plain are %XX (RFC 3986).
std::string percent_encoded(std::string_view text, bool (*plain)(char)) {
  std::string out;
  for (const char c : text) {
    out += plain(c) ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return out;
}

/// A path as a relative address.
std::string address_of(const std::string& path) {
  return percent_encoded(path, [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') ||
           std::string_view("-._~/").find(c) != std::string_view::npos;
  });
}

std::string throws_of(const Person& person, const ReportParts& parts) {
  std::string html = "<div class=throws>";
  const auto page = parts.pages.find(person.planned.id);
  if (page != parts.pages.end()) html += fmt::format("<a href=\"{}\">", address_of(page->second));
  for (const scene::ThrowRow& one : person.played.measures.throws) {
    html += throw_picture(one, one.version == "red");
  }
  if (page != parts.pages.end()) html += "</a>";
  return html + "</div>\n";
}

std::string person_of(const Design& design, const Questionnaire& questions, const Person& person,
                      const ReportParts& parts) {
  const std::string why = why_not(design, questions, person);
  std::string html =
      fmt::format("<h3>{}{}</h3>\n<p>cell {}, {} changes; {}{}</p>\n", escaped(person.planned.id),
                  person.is_virtual() ? " (virtual)" : "", cell_of(design, person.planned),
                  changed_key_of(design, person.planned),
                  person.played.run.empty()
                      ? std::string("no session that counts")
                      : fmt::format("{} of {}, {:.1f} s", person.played.run, person.played.runs,
                                    person.played.measures.duration_s),
                  why.empty() ? "" : "; does not count: " + escaped(why));
  html += throws_of(person, parts);
  if (person.answers.empty()) return html;
  html += "<details><summary>answers</summary><table>\n";
  for (const Answer& answer : person.answers) {
    const Item* item = questions.find(answer.item);
    html += row_of(
        {answer.item, item->text.at(questions.languages[0]), answer.answer, answer.source}, "td");
  }
  return html + "</table></details>\n";
}

std::string design_of(const Design& design) {
  Table table{
      "design",
      "Factors",
      {{"factor", "", "", ""}, {"parameter", "", "", ""}, {"0", "", "", ""}, {"1", "", "", ""}},
      {}};
  for (const Factor& factor : design.factors) {
    table.rows.push_back({factor.letter, factor.key, factor.levels[0], factor.levels[1]});
  }
  return table_of(table, design);
}

/// A picture as a separate document, because R uses the same glyph names in every picture.
std::string picture_of(const std::string& svg) {
  const std::string data = percent_encoded(svg, [](char c) {
    return c >= ' ' && c <= '~' && std::string_view("\"#%<>&").find(c) == std::string_view::npos;
  });
  return fmt::format("<img alt=\"\" src=\"data:image/svg+xml,{}\">", data);
}

/// How many sessions nobody played, and how many participants did not answer themselves.
std::string not_of_people(const std::vector<Person>& people) {
  const auto virtuals = std::ranges::count_if(people, &Person::is_virtual),
             drawn = std::ranges::count_if(people, &Person::has_drawn_answers);
  std::vector<std::string> sentences;
  if (virtuals > 0) {
    const std::string who = people.size() == 1
                                ? "The participant is virtual"
                                : fmt::format("{} of these {} participants {} virtual", virtuals,
                                              people.size(), virtuals == 1 ? "is" : "are");
    sentences.push_back(fmt::format("{}: nobody played {}.", who,
                                    virtuals == 1 ? "that session" : "their sessions"));
  }
  if (drawn > 0) {
    sentences.push_back(fmt::format("The answers of {} participant{} are drawn from a model.",
                                    drawn, drawn == 1 ? "" : "s"));
  }
  if (sentences.empty()) return {};
  return fmt::format("<p class=virtual>{}</p>\n", fmt::join(sentences, " "));
}

}  // namespace

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    out += c == '&'   ? "&amp;"
           : c == '<' ? "&lt;"
           : c == '>' ? "&gt;"
           : c == '"' ? "&quot;"
                      : std::string(1, c);
  }
  return out;
}

std::string html_report(const Design& design, const Questionnaire& questions,
                        const std::vector<Person>& people, const ReportParts& parts) {
  const std::string title = escaped(design.title.empty() ? design.name : design.title);
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=en><meta charset=utf-8><title>{0}</title>\n<style>{1}</style>\n"
      "<h1>{0}</h1>\n",
      title, kStyle);
  html += not_of_people(people);
  const auto counted = std::ranges::count_if(
      people, [&](const Person& one) { return why_not(design, questions, one).empty(); });
  html += fmt::format("<p>{} participants, {} of whom count.</p>\n<h2>Design</h2>\n", people.size(),
                      counted);
  html += design_of(design) + "<h2>Tables</h2>\n";
  for (const Table& table : parts.tables) html += table_of(table, design);
  if (!parts.left_out.empty()) {
    html += fmt::format("<p class=note>{}</p>\n", escaped(parts.left_out));
  }
  if (!parts.pictures.empty()) html += "<h2>Pictures</h2>\n";
  for (const std::string& picture : parts.pictures) {
    html += fmt::format("<figure>{}</figure>\n", picture_of(picture));
  }
  html +=
      "<h2>Participants</h2>\n<p class=note>Each small picture is a throw from above: where the "
      "ball left the hand and where it headed, red or blue by its button, and the skittles it "
      "felled.</p>\n";
  for (const Person& person : people) html += person_of(design, questions, person, parts);
  return html + "</html>\n";
}

}  // namespace headpin::study
