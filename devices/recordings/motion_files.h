#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "devices/base/resample.h"
#include "devices/recordings/motion_recording.h"
#include "devices/recordings/table_columns.h"

/// Readers for recordings of human motion in foreign formats, with one common frame.
///
/// Units and axes come from the format's specification, from the file, or from the user. What a table
/// does not say and a reader had to decide is a note.
namespace headpin::devices {

/// Options for a recording that a user gives.
struct MotionOptions {
  /// Units, axes and order of quaternions where the format does not say them, or says them wrongly.
  ToldReading reading = {};
  /// What head, left and right hand are called: an object of UXF, a tracked point of Motion-BIDS,
  /// a sensor of VRPN as DEVICE:NUMBER or NUMBER, the beginning of columns' names. One hand may be
  /// empty: it was not tracked. All empty: found by name, or sensors 0, 1, 2; of two sensors the
  /// second is the only hand.
  std::array<std::string, 3> names = {};
  std::string names_source = "names";  ///< where they were told, for errors
  /// Which hand is the only one of a file that does not say it.
  bool only_hand_is_left = false;
  /// Where positions count from, in our frame [m]: a transmitter above the floor.
  Vec3 p_origin = Vec3::Zero();
  /// Place of a head that was not recorded, in our frame [m]. Its rotation is not known.
  std::optional<Vec3> p_head = {};
  bool no_hand = false;  ///< a recording of the head alone is accepted
  /// Which hand throws: its times are those of the recording. Otherwise the faster one is taken.
  std::optional<bool> left_throws = {};

  // For tables and XDF alone; but rotations "none" holds for every format.
  ToldColumns columns = {};
  /// Order of angles ("YXZ" about axes that turn with the body, "yxz" about fixed ones), "vector", or "none".
  std::optional<std::string> rotations = {};
  std::optional<bool> degrees = {};
};

/// Which columns have the time, the head or a hand was not found, and not told.
struct UnclearColumns : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// Which object is the head or a hand was not found, and not told.
struct UnclearObjects : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// The tracks by name, and notes about ignored parts of the file.
struct MotionTracks {
  bool since_start = false;  ///< times count from the start of the recording, so they are kept
  bool by_part = false;  ///< the tracks have the names of head and hands, whatever the file says
  std::vector<std::pair<std::string, PoseTrack>> tracks;
  std::vector<std::string> notes;
  Reading reading = {};  ///< how the format says that its numbers are read
  std::vector<std::string> without_rotation = {};  ///< tracks whose rotation was not measured
  std::array<std::vector<Stamped<bool>>, 2> triggers = {};  ///< as MotionRecording has them
};

/// What is understood of a table, though it may be no recording.
struct TableFindings {
  struct Column {
    std::string name, unit, meaning, first;  ///< first: its first cell that is not empty
  };
  std::vector<Column> columns;
  ToldColumns mapping;  ///< the columns that are used, as a user would tell them
  std::string kind;     ///< the program whose header it has, or empty
  char separator = ',';
  bool decimal_comma = false;
  bool of_streams = false;  ///< as AnyTable has it
  std::size_t rows = 0;
  std::vector<std::string> missing;  ///< sentences
};

/// One format and its reader.
struct MotionFormat {
  std::string_view name;   ///< as it is called: "VRPN log"
  std::string_view files;  ///< what is given: "a .vrpn file"
  /// Whether this is one, by the name and the first bytes.
  bool (*is_one)(const std::string& path, std::string_view begin);
  /// @throws std::invalid_argument  naming file and line or byte of what is wrong
  /// @throws std::runtime_error     for a file that cannot be read
  MotionTracks (*read)(const std::string& path, const MotionOptions& options);
  /// What is understood of its columns; null where the format has none that a user could tell.
  TableFindings (*inspect)(const std::string& path, const MotionOptions& options) = nullptr;
};

std::span<const MotionFormat> motion_formats();

/// The format of a file or folder; null if it is none of these.
const MotionFormat* format_of(const std::string& path);

/// Detects the format of a file or folder and reads it.
///
/// What the user says of units, axes and quaternions holds for every format.
///
/// @throws std::invalid_argument  for a format not known here, naming those that are and what this
///                                seems to be; for columns or angles that are told of a format that
///                                says its own; else as MotionFormat::read
MotionRecording read_motion(const std::string& path, const MotionOptions& options);

/// Head and hands among tracks, by the given names or by words in theirs.
/// @throws UnclearObjects         when there is not one head and at least one hand
/// @throws std::invalid_argument  as `together`
MotionRecording recording_of(const MotionTracks& read, const MotionOptions& options,
                             const std::string& where);

}  // namespace headpin::devices
