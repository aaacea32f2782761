#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

/// The XML of headers in other files: elements and texts.
namespace headpin::devices {

/// An element; its attributes are ignored.
struct XmlElement {
  std::string name;
  std::string text = {};  ///< of its own, without that of its children
  std::vector<XmlElement> children = {};

  /// The first element at the end of a path of names; null if there is none.
  const XmlElement* find(std::initializer_list<std::string_view> path) const;
  /// Its text without blanks around it; empty if there is none.
  std::string text_at(std::initializer_list<std::string_view> path) const;
};

/// Reads a text with one element at its top.
/// @throws std::invalid_argument  saying what is wrong, and at which byte
XmlElement parse_xml(std::string_view text);

/// A text as it stands in XML. Bytes that XML cannot have become question marks.
std::string xml_escaped(std::string_view text);

}  // namespace headpin::devices
