#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/math.h"
#include "devices/base/bytes.h"

/// Encodes and decodes the bytes of the Polhemus 3SPACE FASTRAK. Pure functions.
///
/// Layouts: FASTRAK User Manual OPM00PI002 Rev. G (2012), pages named at each item. Values are in
/// the units of the line: inches or centimetres, degrees. If neither the manual nor clients specify
/// the form of a record, the code says "our choice".
namespace headpin::devices {

constexpr int kFastrakStations = 4;
/// Measurements a second, shared by the receivers (manual p. E-2).
constexpr std::int64_t kFastrakCycleRate = 120;
/// Commands of one control byte: save, go on sending, hold on, start again.
constexpr char kFastrakSave = 0x0B;          ///< ^K
constexpr char kFastrakResume = 0x11;        ///< ^Q, XON
constexpr char kFastrakSuspend = 0x13;       ///< ^S, XOFF
constexpr char kFastrakReinitialise = 0x19;  ///< ^Y
/// Baud rates of its line (command o, p. 80).
constexpr std::array<int, 7> kFastrakBauds = {2400, 4800, 9600, 19200, 38400, 57600, 115200};
constexpr double kMetrePerInch = 0.0254;
constexpr double kMetrePerCentimetre = 0.01;

/// Content and format of a station's data records (commands O, F f, U u).
struct FastrakFormat {
  std::vector<int> items = {2, 4, 1};  ///< output list (p. 57), in order
  bool binary = false;
  bool centimetres = false;

  double metre_per_unit() const { return centimetres ? kMetrePerCentimetre : kMetrePerInch; }
};

/// True for an output item that exists in a Fastrak. The compact items 18 to 20 belong to early
/// firmware only; Rev. G lists them as unused.
bool is_fastrak_item(int item, bool early_firmware = false);

/// Bytes of one item; 0 for one that does not exist. Compact items are two-byte codes in both
/// formats (our choice for ASCII, which the manuals do not describe).
std::size_t fastrak_item_length(int item, bool binary);

/// Bytes of a data record: three of head, then the items.
std::size_t fastrak_record_length(const FastrakFormat& format);

/// Of a possible position, along each axis [in or cm]: ten times what the columns of ASCII hold.
inline constexpr double kFastrakFarthest = 1e4;

/// One data record. Items that its list does not name keep their defaults.
struct FastrakRecord {
  int station = 1;                   ///< 1..4
  char error = ' ';                  ///< ' ' none, else the letter of a built-in-test code
  Vec3 position = Vec3::Zero();      ///< items 2, 52, 18 [in or cm]
  Vec3 relative = Vec3::Zero();      ///< items 3, 53: since the last output [in or cm]
  Vec3 angles_deg = Vec3::Zero();    ///< items 4, 54, 19: azimuth, elevation, roll
  Mat3 attitude = Mat3::Identity();  ///< rows in items 5-7, 55-57; columns: the sensor's axes
  std::array<double, 4> quaternion = {1, 0, 0, 0};  ///< items 11, 61, 20: scalar first
  bool pressed = false;                             ///< items 16, 66: stylus switch
};

/// Appends the record. Values that are too large for their columns become the largest that fits.
void encode_record(const FastrakRecord& record, const FastrakFormat& format,
                   std::vector<std::uint8_t>& out);

/// Reads a record of exactly `fastrak_record_length(format)` bytes.
///
/// @return  nothing unless every byte matches the format: head, station digit, space or letter,
///          digits in their columns, blanks, CR LF; and, in a record without error letter, every
///          value possible: finite, near enough, angles on the circle, a unit quaternion, unit axes
std::optional<FastrakRecord> decode_record(Bytes bytes, const FastrakFormat& format);

/// The formats of stations 1 to 4.
using FastrakFormats = std::array<FastrakFormat, kFastrakStations>;

/// A record in a stream that may contain other bytes too.
struct FastrakFound {
  std::size_t skipped = 0;  ///< bytes before it that belong to no record
  std::size_t length = 0;   ///< its own bytes; 0: none found, more bytes are needed
  FastrakRecord record;     ///< valid when length > 0
};

/// Finds the first record in `bytes`.
///
/// In step with the stream, a record that decodes is accepted at once. Out of step, the bytes after
/// it must begin another record. If they do not, the record is still accepted, unless a record that
/// begins inside it is followed by the begin of another one. So noise between records does not lose
/// any record.
///
/// @param in_step  the byte before `bytes` ended a record or a silence
/// @param no_more  no more bytes will follow: decide now
FastrakFound find_record(Bytes bytes, const FastrakFormats& formats, bool in_step, bool no_more);

/// The values of a read-back side by side, right-justified in equal columns.
std::string encode_columns(std::span<const double> values, int width, int decimals);

}  // namespace headpin::devices
