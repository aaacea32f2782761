#include "apps/xdf_session.h"

#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "base/output_file.h"
#include "devices/recordings/xdf_motion.h"
#include "scene/record/log.h"
#include "scene/record/xdf.h"

namespace headpin::apps {

bool is_xdf_session(const ImportOptions& options) {
  if (!options.axes.empty() || !options.columns.empty() || !options.names.empty()) return false;
  if (!std::filesystem::is_regular_file(options.file)) return false;
  devices::FileWindow file(options.file);
  return scene::is_xdf_trial(devices::bytes_of(file));
}

void import_xdf_session(const ImportOptions& options) {
  devices::FileWindow file(options.file);
  const scene::XdfTrial trial = scene::read_xdf_trial(devices::bytes_of(file), options.file);
  if (!options.explain) {
    watch_stop_signals();
    scene::Recorder recorder(base::OutputFile(*options.output, {.overwrite = options.force,
                                                                .standard_output = true,
                                                                .inputs = {options.file}}),
                             trial.header);
    scene::write(recorder, trial.samples, trial.events);
    check_stop();
    recorder.close();
  }
  for (const std::string& note : trial.notes) {
    say("headpin import: {}: {}\n", printable(options.file), printable(note));
  }
  const std::string& written = options.output ? *options.output : options.file;
  if (options.json) {
    return print_json(
        {{"output", written}, {"samples", trial.samples.size()}, {"notes", trial.notes}});
  }
  fmt::print("{}\n  samples            {}, a whole session\n", printable(written),
             trial.samples.size());
}

}  // namespace headpin::apps
