#include "apps/page_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>
#include <zlib.h>

#include "base/input_file.h"
#include "devices/base/bytes.h"
#include "devices/log/event_log.h"
#include "scene/record/messages.h"
#include "scene/scenario/files.h"

namespace headpin::apps {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMark = "<!--headpin:data-->";
constexpr double kMostQuanta = 4503599627370496.0;  // 2^52: the page reads them as doubles

}  // namespace

std::string base64(std::span<const std::uint8_t> bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t here = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t three = 0;
    for (std::size_t j = 0; j < 3; ++j) three = three << 8 | (j < here ? bytes[i + j] : 0u);
    for (std::size_t j = 0; j < 4; ++j) {
      out += j <= here ? kDigits[three >> (18 - 6 * j) & 63] : '=';
    }
  }
  return out;
}

std::string deflated(std::span<const std::uint8_t> bytes) {
  uLongf size = compressBound(bytes.size());
  std::vector<std::uint8_t> out(size);
  if (compress2(out.data(), &size, bytes.data(), bytes.size(), Z_BEST_COMPRESSION) != Z_OK) {
    throw std::runtime_error("zlib: out of memory");
  }
  return base64({out.data(), size});
}

std::string deflated(const std::string& text) {
  return deflated({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

std::vector<std::uint8_t> in_quanta(const scene::PageData& data) {
  std::vector<std::uint8_t> out;
  for (const nlohmann::json& section : data.json["sections"]) {
    const std::size_t rows = section["rows"], columns = section["columns"].size();
    const float* first = data.floats.data() + section["offset"].get<std::size_t>();
    for (std::size_t column = 0; column < columns; ++column) {
      const double quantum = section["quanta"][column];
      std::int64_t before = 0;
      for (std::size_t row = 0; row < rows; ++row) {
        const double quanta = first[row * columns + column] / quantum;
        const std::int64_t now = std::llround(
            std::isfinite(quanta) ? std::clamp(quanta, -kMostQuanta, kMostQuanta) : 0.0);
        devices::append_varint(devices::zigzag(now - before), out);
        before = now;
      }
    }
  }
  return out;
}

std::vector<std::uint8_t> log_of_inputs(const std::string& path) {
  devices::FileWindow file(path);
  devices::LogReader log(file);
  std::vector<std::uint8_t> out;
  std::int64_t number = 0;
  while (auto event = log.next()) {
    const bool of_simulation =
        event->channel == scene::kStateChannel || event->channel == scene::kStateChangeChannel ||
        event->channel == scene::kSnapshotChannel || event->channel == scene::kFrameChannel;
    if (of_simulation) continue;
    event->number = number++;
    devices::append(*event, out);
  }
  return out;
}

std::string page_template(const std::string& path) {
  constexpr std::size_t kMost = 100'000'000;  // it has one of 1.2 million
  std::string page = base::read_text(path, kMost);
  if (page.find(kMark) == std::string::npos) {
    throw std::runtime_error(
        fmt::format("{}: expected a page template with the mark {}, found none", path, kMark));
  }
  return page;
}

namespace {

std::string built_template(const std::string& name) {
  std::vector<fs::path> places;
  for (const fs::path& data : scene::data_folders()) places.push_back(data / name);
  places.push_back((scene::program_folder() / "../report" / name).lexically_normal());
  std::error_code none;
  for (const fs::path& place : places) {
    if (fs::is_regular_file(place, none)) return page_template(place.string());
  }
  throw std::runtime_error(
      "the page template has not been built; `./dev page` in headpin's sources builds it (needs "
      "nodejs and npm)");
}

}  // namespace

std::string page_template() {
  return built_template("page.html");
}

std::string play_template() {
  return built_template("play.html");
}

std::string watch_template() {
  return built_template("watch.html");
}

std::string filled(const std::string& page, const PageBlocks& blocks) {
  std::string data;
  for (const auto& [name, base64_text] : blocks) {
    data += fmt::format("<script type=\"text/plain\" data-block=\"{}\">{}</script>\n", name,
                        base64_text);
  }
  const std::size_t at = page.find(kMark);
  return page.substr(0, at) + data + page.substr(at + kMark.size());
}

}  // namespace headpin::apps
