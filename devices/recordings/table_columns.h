#pragma once

#include <array>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "devices/recordings/any_table.h"
#include "devices/recordings/column_names.h"

/// What the columns of a table mean, found by their names or told by the user.
namespace headpin::devices {

/// A column told by the user.
struct ToldColumn {
  /// Its meaning: `time`, `trigger`, `object` (the name of a row's object), `head`, `left`, `right`, or one
  /// component such as `head.x`, `right.qw`, `left.rx` (an angle), `head.m00` (a matrix).
  std::string key;
  /// Its name, `#3` for the third column, or for head and hands a pattern with one `*`: `HMD_*`.
  std::string column;
  std::string source = {};  ///< where it was told: an option, or FILE:LINE
};
using ToldColumns = std::vector<ToldColumn>;

/// Whether a key is the meaning of a column, as ToldColumn has it; its component is not checked.
bool is_column_key(std::string_view key);
inline constexpr std::string_view kColumnKeys = "time, trigger, object, head, left or right";

/// A told column that means nothing, or that the table does not have.
struct WrongColumn : std::invalid_argument {
  WrongColumn(ToldColumn which, std::string what_is_wrong, const std::string& expected,
              std::vector<std::string> names = {});
  ToldColumn told;
  std::string wrong;               ///< what is wrong with it
  std::vector<std::string> known;  ///< names of columns that may be meant
};

/// How the rotation of a head or hand is written.
enum class RotationKind { none, quaternion, angles, vector, matrix };

/// The columns of a head or hand.
struct PartColumns {
  std::array<std::optional<std::size_t>, 3> position;    ///< x, y, z
  std::array<std::optional<std::size_t>, 4> quaternion;  ///< w, x, y, z
  std::array<std::optional<std::size_t>, 3> angles;      ///< about x, y, z, or a rotation vector
  std::array<std::optional<std::size_t>, 9> matrix;      ///< row by row
  std::optional<std::size_t> trigger;
  RotationKind rotation = RotationKind::none;

  bool tracked() const { return position[0].has_value(); }
};

/// The columns of a recording; parts are head, left and right hand.
struct MotionColumns {
  std::optional<std::size_t> time;
  std::array<PartColumns, 3> parts;
  /// Of a table with a row for each object: the column with the object's name, and the names of the parts.
  std::optional<std::size_t> object;
  std::array<std::string, 3> objects;
  std::array<bool, 3> told_of_rows = {};  ///< some of the part's columns there were told, not found
  /// What each column of the table is, such as "head, position x"; empty if it is not used.
  std::vector<std::string> meanings;
  std::vector<std::string> missing;  ///< sentences about what a throw needs and was not found
};

/// Finds the columns of time, head and hands.
///
/// A column's name is split into words: "HMD_qw", "leftHand.position.x", "Rigid Body Head Rotation X".
/// The last words say the component, the words before them the object. What the user told is used first.
///
/// @param only_hand_is_left  of a hand whose name does not say the side
/// @param uses_rotations     false where none is used: then some may be told for two kinds of rotation of one part,
///                           as in the files of columns that were once written so
/// @throws WrongColumn            for told columns that are not there, that mean nothing, or that are of two kinds
///                                of rotation of one part
/// @throws std::invalid_argument  for two objects that could be the same part
MotionColumns find_columns(const AnyTable& table, const ToldColumns& told, bool only_hand_is_left,
                           std::string_view where, bool uses_rotations = true);

/// Says what each column is, again where another kind of rotation was told.
void say_meanings(const AnyTable& table, MotionColumns& columns);

/// The columns that are used, as a user would tell them: "head.x", "HMD_x".
ToldColumns mapping_of(const AnyTable& table, const MotionColumns& columns);

inline constexpr std::array kPartKeys = {"head", "left", "right"};

}  // namespace headpin::devices
