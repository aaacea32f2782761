// Hostile scenarios at the fuzz target's law, without a fuzzer: the bundled ones, with values, lines
// and bytes that somebody made wrong.
//
//   scenarios_check [FIRST [COUNT]]   numbers FIRST to FIRST + COUNT - 1; 1 and 20000 if not said
//
// Says every hundredth number before it tries it, so that one that crashes or hangs is found by a run
// of its hundred; a single one is written to standard output.

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

namespace fs = std::filesystem;

std::vector<std::string> texts_in(const fs::path& folder) {
  std::vector<fs::path> paths;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file()) paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  std::vector<std::string> texts;
  for (const fs::path& path : paths) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    texts.push_back(text.str());
  }
  return texts;
}

/// Numbers below a bound, the same everywhere.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : bits_(seed) {}
  std::size_t below(std::size_t bound) { return bound == 0 ? 0 : bits_() % bound; }
  template <typename T>
  const T& one_of(const std::vector<T>& all) {
    return all[below(all.size())];
  }

 private:
  std::mt19937_64 bits_;
};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

const std::vector<std::string> kValues = {
    "0",
    "-1",
    "1",
    "-0.0",
    "nan",
    "inf",
    "-inf",
    "1e308",
    "-1e308",
    "1e-308",
    "1e400",
    "1e-9",
    "0.5",
    "2",
    "100",
    "1000000",
    "9223372036854775807",
    "99999999999999999999",
    "0x7fffffff",
    "true",
    "false",
    "''",
    "'true'",
    "'none'",
    "'\xc3\xa9'",
    "\"\\u0000\"",
    "[]",
    "[[]]",
    "[0]",
    "[0, 0, 0]",
    "[nan, 0, 0]",
    "[1e308, 1e308, 1e308]",
    "[0, 0, 0, 0]",
    "[[0, 0], [0, 0]]",
    "[[0.0, 1e-300], [1e-300, 0.0]]",
    "{}",
    "{shape = 'cone'}",
    "1979-05-27",
    "",
    "[{shape = 'ellipsoid', radius = 0.0, low = 0.0, high = 0.0}]"};

/// Something done to one line, or to the bytes.
void spoil(std::string& text, Draw& draw) {
  std::vector<std::string> lines = lines_of(text);
  if (lines.empty()) lines.emplace_back();
  const std::size_t at = draw.below(lines.size());
  std::string& line = lines[at];
  const std::size_t equals = line.find('=');
  switch (draw.below(9)) {
    case 0:
    case 1:
    case 2:
      if (equals != std::string::npos)
        line = line.substr(0, equals + 1) + " " + draw.one_of(kValues);
      break;
    case 3: {  // a number in the line
      const std::size_t digit = line.find_first_of("0123456789", draw.below(line.size() + 1));
      if (digit == std::string::npos) break;
      const std::size_t end = line.find_first_not_of("0123456789.e-", digit);
      line.replace(digit, (end == std::string::npos ? line.size() : end) - digit,
                   draw.one_of(kValues));
      break;
    }
    case 4:
      lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(at));
      break;
    case 5:
      lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(at), draw.one_of(lines));
      break;
    case 6:
      std::swap(line, lines[draw.below(lines.size())]);
      break;
    case 7:
      line += std::string(draw.below(3000), "[{'\"#"[draw.below(5)]);
      break;
    default:
      if (!line.empty()) line[draw.below(line.size())] ^= static_cast<char>(1 << draw.below(8));
  }
  text.clear();
  for (const std::string& one : lines) text += one + "\n";
}

std::string scenario(const std::vector<std::string>& bases, std::uint64_t number) {
  Draw draw(number);
  std::string text = draw.one_of(bases);
  for (std::size_t n = 1 + draw.below(3); n > 0; --n) spoil(text, draw);
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t first = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 1;
  const std::uint64_t count = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 20000;
  std::vector<std::string> bases = texts_in(HEADPIN_SOURCE_DIR "/assets/scenarios");
  for (std::string& text : texts_in(HEADPIN_SOURCE_DIR "/tests/fuzz/corpus/scenario_fuzz")) {
    bases.push_back(std::move(text));
  }
  for (std::uint64_t number = first; number < first + count; ++number) {
    if (number % 100 == 0) {
      std::fprintf(stderr, "%llu\n", static_cast<unsigned long long>(number));
    }
    const std::string text = scenario(bases, number);
    if (count == 1) std::cout << text << std::flush;
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  }
  std::printf("%llu scenarios: refused in a short sentence, or written, read back and run\n",
              static_cast<unsigned long long>(count));
}
