#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// How messages of LCM lie in their bytes, from the text of .lcm files.
namespace headpin::devices {

/// A field of a message: a number, a text, another structure, or an array of these.
struct MessageField {
  enum class Kind { number, text, structure };
  Kind kind = Kind::number;
  std::ptrdiff_t size = 0;  ///< of a number, in bytes
  std::string structure;    ///< name of its type
  std::string name;
  std::ptrdiff_t times = 1;            ///< product of the fixed dimensions
  std::vector<std::string> counts_in;  ///< earlier fields whose numbers are further dimensions
  bool counts = false;                 ///< it is such an earlier field
};

/// The fields of each type by its name.
class Layouts {
 public:
  /// @param schema  .lcm files, one after another
  /// @throws std::invalid_argument  for a field of a type that is not in it
  explicit Layouts(std::string_view schema);

  /// The position behind a message that begins at `at`, without its fingerprint; -1 if it does not lie
  /// within `bytes`, a count is negative, or a text does not end in a NUL.
  ///
  /// @throws std::out_of_range  for an unknown type
  std::ptrdiff_t end_of(const std::string& type, std::span<const std::uint8_t> bytes,
                        std::ptrdiff_t at) const;

 private:
  std::map<std::string, std::vector<MessageField>> types_;
};

}  // namespace headpin::devices
