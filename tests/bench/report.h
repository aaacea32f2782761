#pragma once

#include <functional>
#include <string>
#include <vector>

/// Timing side by side, and what came of it as a table and as JSON.
namespace headpin::bench {

/// One comparison: ratio = theirs / ours.
struct Row {
  std::string name;
  std::string unit;
  double ours = 0.0;
  std::string peer;
  double theirs = 0.0;
};

/// Prints the rows and writes them to out/bench/NAME.json under the current directory, as a list of
/// {"case", "unit", "ours", "peer", "theirs", "ratio"}.
///
/// @throws std::runtime_error  when the file cannot be written
void publish(const std::string& name, const std::vector<Row>& rows);

/// Writes a text file beside its final name and renames it; makes the folder.
void write_text(const std::string& path, const std::string& text);

/// One contestant: does the whole job once and returns something that depends on all of it.
struct Contestant {
  std::string name;
  std::function<double()> run;
};

/// Runs the contestants in turn, `rounds` times over, and returns the least time of each [s]: what
/// comes between on a shared machine only ever adds, and the turns give all the same chance of a
/// quiet moment.
std::vector<double> interleaved(const std::vector<Contestant>& contestants, int rounds);

/// The upper one of two in the middle.
double median(std::vector<double> values);

/// Slope of log y over log x, least squares.
double growth_exponent(const std::vector<double>& x, const std::vector<double>& y);

/// Keeps a result alive.
extern volatile double sink;

}  // namespace headpin::bench
