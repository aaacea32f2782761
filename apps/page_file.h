#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "scene/page/page_parts.h"

/// Writes the files of `headpin report` and `headpin play`: page templates with data.
namespace headpin::apps {

/// The data in a page, by name: base64 of deflated bytes, so that text of a trial is never parsed
/// as HTML.
using PageBlocks = std::map<std::string, std::string>;

std::string base64(std::span<const std::uint8_t> bytes);
/// Compresses with zlib and encodes in base64. Base64 stays our own code: it is a dozen lines, and
/// no dependency has it.
std::string deflated(std::span<const std::uint8_t> bytes);
std::string deflated(const std::string& text);

/// The numbers of each section, column by column, in whole quanta. Each number is stored as the
/// difference from the one above it: zigzag, then LEB128 (seven bits per byte, the lowest first;
/// the eighth bit is set if more bytes follow). Deflated, it has a fifth of the size of the floats.
std::vector<std::uint8_t> in_quanta(const scene::PageData& data);

/// A trial's log without states and frames, which a replay computes again.
///
/// @throws std::runtime_error  when there is no such file
std::vector<std::uint8_t> log_of_inputs(const std::string& path);

/// The installed page template of `headpin report`, or the one in the build folder.
///
/// @throws std::runtime_error  without one, naming the command that makes it
std::string page_template();
/// The same of `headpin play`.
std::string play_template();
/// The same of the operator's view of `headpin serve`.
std::string watch_template();
/// @throws std::runtime_error  naming the file, when it cannot be read or takes no data
std::string page_template(const std::string& path);

/// @param page  a template with its mark, which page_template() has checked
std::string filled(const std::string& page, const PageBlocks& blocks);

}  // namespace headpin::apps
