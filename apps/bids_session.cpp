#include "apps/bids_session.h"

#include <filesystem>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "base/input_file.h"
#include "base/output_file.h"
#include "scene/record/log.h"
#include "study/bids.h"
#include "study/bids_read.h"

namespace headpin::apps {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostOfTable = 1'000'000'000;

/// "_run-01_" of a file's name; empty if there is none.
std::string run_of(const std::string& name) {
  const std::size_t at = name.find("_run-");
  return at == std::string::npos ? "" : name.substr(at, name.find('_', at + 1) - at) + "_";
}

/// All tables and sidecars of the same run, without the simulated ones.
std::map<std::string, std::string> texts_beside(const fs::path& path) {
  const std::string run = run_of(path.filename().string());
  std::map<std::string, std::string> texts;
  for (const auto& entry : fs::directory_iterator(path.parent_path())) {
    const std::string name = entry.path().filename().string();
    if (run_of(name) != run || name.find("_tracksys-simulated_") != std::string::npos) continue;
    texts[name] = base::read_text(entry.path().string(), kMostOfTable);
  }
  return texts;
}

}  // namespace

bool is_bids_session(const std::string& path) {
  const fs::path file = path;
  const std::string name = file.filename().string();
  const std::size_t system = name.find("_tracksys-");
  if (system == std::string::npos || !name.ends_with("_motion.tsv")) return false;
  const std::string run = run_of(name);
  const fs::path sidecar = file.parent_path() / (name.substr(0, system) + run + "events.json");
  if (run.empty() || !fs::is_regular_file(sidecar)) return false;
  const nlohmann::json json =
      nlohmann::json::parse(base::read_text(sidecar.string(), kMostOfTable), nullptr, false);
  return json.is_object() && json.contains("HeadpinTrial");
}

void import_bids_session(const std::string& path, base::OutputFile output, bool json) {
  const fs::path file = fs::absolute(path);
  study::BidsTrial trial;
  try {
    trial = study::session_of(texts_beside(file));
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error((fs::path(path).parent_path() / error.what()).string());
  }
  const std::string name = output.path();
  scene::Recorder recorder(std::move(output), trial.header);
  for (const devices::Sample& sample : trial.samples) {
    check_stop();
    recorder.write(sample);
  }
  recorder.close();
  if (json) return print_json({{"output", name}, {"samples", trial.samples.size()}});
  fmt::print("{}\n  samples            {}, a whole session\n", name, trial.samples.size());
}

}  // namespace headpin::apps
