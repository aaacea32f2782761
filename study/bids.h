#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "scene/play/run.h"
#include "scene/record/trial.h"
#include "scene/scenario/scenario.h"
#include "study/people.h"

/// Writes and reads studies as Motion-BIDS (Brain Imaging Data Structure 1.9 and later).
namespace headpin::study {

/// Name of a file in the dataset, and its text.
using BidsFile = std::pair<std::string, std::string>;

/// One recorded session, ready to be written.
struct BidsSession {
  std::string subject;  ///< p001
  std::string run;      ///< 01
  const scene::TrialHeader* header = nullptr;
  std::vector<devices::Sample> samples;  ///< in the order of the log; stations from 1 on
  std::vector<scene::Event> events;
  scene::Rig rig = {};  ///< says which station is head and hand, and how the transmitter stands
  Time end{};           ///< of the session, which may go on after its last sample
};

/// The README of the dataset. Of the participants it says only whether some are virtual.
/// @param deidentified  the dataset has numbers in place of names, and no trials
std::string bids_readme(const Design& design, const std::vector<Person>& people, bool deidentified);

/// The files of a dataset except README and sessions; its description is the last.
///
/// @param people  the participants, with the names of their subjects
std::vector<BidsFile> dataset_files(const Design& design, const Questionnaire& questions,
                                    const std::vector<Person>& people, const std::string& version);

/// The files of a session: one tracking system per receiver, and the events with the buttons.
///
/// They contain all data: every field of a sample has a column, LATENCY is the time of measurement
/// on the session's clock, and log_index is the order of the log. The events' sidecar has the
/// trial's header, the number of samples, and the station of each system. Who made the tracker is not said: no trial tells it.
std::vector<BidsFile> session_files(const BidsSession& session);

/// The simulated bodies as a further tracking system, with one row per frame (`rates.frame_hz`).
class SimulatedSystem : public scene::Observer {
 public:
  /// @param take  receives pieces of the table
  explicit SimulatedSystem(std::function<void(const std::string&)> take) : take_(std::move(take)) {}
  void start(const scene::Session& session) override;
  void tick(const scene::Session& session) override;

  /// Channels and sidecar, at the end.
  std::vector<BidsFile> files(const BidsSession& session) const;
  static std::string table_name(const BidsSession& session);

 private:
  std::function<void(const std::string&)> take_;
  std::vector<std::string> names_;
  scene::TickState state_;
  std::int64_t every_ = 4, rows_ = 0;
  double rate_hz_ = 60.0;
  Time first_{};  ///< of the rows; the last one's is that of the state
};

}  // namespace headpin::study
