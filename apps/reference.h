#pragma once

#include <map>
#include <string>
#include <vector>

/// The generated reference pages of docs/, which a test compares.
namespace headpin::apps {

/// A channel of a trial or a live session.
struct ChannelUse {
  std::string channel, type, when;
};

std::vector<ChannelUse> channel_uses();

/// The pages of docs/ that are written by the program: file name -> Markdown.
std::map<std::string, std::string> reference_pages();

}  // namespace headpin::apps
