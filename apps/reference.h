#pragma once

#include <map>
#include <string>
#include <vector>

/// What the program knows about its own inputs and outputs, for docs/ and the tests that hold it.
namespace headpin::apps {

/// A channel of a trial or a live session.
struct ChannelUse {
  std::string channel, type, when;
};

std::vector<ChannelUse> channel_uses();

/// The pages of docs/ that are written by the program: file name -> Markdown.
std::map<std::string, std::string> reference_pages();

}  // namespace headpin::apps
