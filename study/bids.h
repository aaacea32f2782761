#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "devices/trial/trial.h"
#include "scene/play/run.h"
#include "study/people.h"

/// A study as others read it: Motion-BIDS (Brain Imaging Data Structure 1.9 and later).
namespace headpin::study {

/// Name of a file in the dataset, and its text.
using BidsFile = std::pair<std::string, std::string>;

/// One recorded session, ready to be written.
struct BidsSession {
  std::string subject;  ///< p001
  std::string run;      ///< 01
  const devices::TrialHeader* header = nullptr;
  std::vector<devices::Sample> samples;  ///< in the order of the log
  std::vector<devices::Event> events;
};

/// What the dataset is of, for people; the same whoever is in it under whatever name.
std::string bids_readme(const Design& design, const std::vector<Person>& people);

/// Who and what a dataset is of, but for README and sessions; its description comes last.
///
/// @param people  those who are in it, named as their subjects
std::vector<BidsFile> dataset_files(const Design& design, const Questionnaire& questions,
                                    const std::vector<Person>& people, const std::string& version);

/// Trackers, one tracking system a receiver, and the session's events with the buttons among them.
///
/// Nothing is lost: every field of every sample has its column, LATENCY is the time of measurement on
/// the session's clock and log_index the order of the log; the events' sidecar has the trial's header.
std::vector<BidsFile> session_files(const BidsSession& session);

/// What is simulated as a tracking system of its own, a row a frame of 1/60 s.
class SimulatedSystem : public scene::Observer {
 public:
  /// @param take  is given pieces of the table
  explicit SimulatedSystem(std::function<void(const std::string&)> take) : take_(std::move(take)) {}
  void start(const scene::Session& session) override;
  void tick(const scene::Session& session) override;

  /// Channels and sidecar, once it is over.
  std::vector<BidsFile> files(const BidsSession& session) const;
  static std::string table_name(const BidsSession& session);

 private:
  std::function<void(const std::string&)> take_;
  std::vector<std::string> names_;
  devices::TickState state_;
  std::int64_t every_ = 4, rows_ = 0;
  double rate_hz_ = 60.0, duration_s_ = 0.0;
};

/// A session read back from the tables of its trackers and events.
struct BidsTrial {
  devices::TrialHeader header;
  std::vector<devices::Sample> samples;  ///< in the order of the log
};

/// @param texts  by name, as session_files() gives them, the folders left out
/// @throws std::invalid_argument  naming file and line: a table that does not fit its channels, what
///                                is no number, a session that headpin did not write
BidsTrial session_of(const std::map<std::string, std::string>& texts);

}  // namespace headpin::study
