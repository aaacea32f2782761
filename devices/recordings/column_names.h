#pragma once

#include <algorithm>
#include <array>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// What the names of columns and tracked objects say.
namespace headpin::devices {

inline bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::ranges::find(words, word) != words.end();
}

enum class Quantity { none, position, quaternion, angle, matrix, trigger };

/// What one column says of an object; quaternions have index 0 for w, 1 to 3 for x, y, z; a matrix 10 times the row
/// and the column, as in its name.
struct Component {
  Quantity quantity = Quantity::none;
  std::size_t index = 0;  ///< of x, y, z; w, x, y, z; or the matrix's element
  std::string object;     ///< the words before, joined by spaces
};

/// The component that a column's name says: "HMD_qw", "leftHand.position.x", "Head Rotation X".
///
/// The last words say the component, the words before them the object.
Component component_of(const std::string& name);

/// The words of a name in small letters: split at signs, at digits and between small and capital letters.
std::vector<std::string> words_of(std::string_view name);

/// The part that a name is of: 0 head, 1 left hand, 2 right hand, or none.
std::optional<std::size_t> part_of_name(std::string_view name);

inline constexpr std::array kPartNames = {"head", "left hand", "right hand"};

}  // namespace headpin::devices
