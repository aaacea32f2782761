#pragma once

#include <string>

/// Plots as files: SVG, PNG or PDF, as the ending of their name says.
namespace headpin::apps {

/// Loads what a plot with that name needs, so that a missing library is known before long work.
/// @throws std::runtime_error  naming the file, and what is missing
void require_plot_library(const std::string& name);

/// Whether the name ends as one of a plot.
bool is_plot(const std::string& name);

/// The bytes of the plot with that name: PNG or PDF if it ends so, else the SVG itself.
///
/// A PNG has twice the width and the height of the SVG in pixels. A PDF is one page of the size of
/// the SVG, where 96 px are one inch. Neither contains a date: where librsvg, cairo and the fonts
/// are the same, equal plots are equal bytes.
///
/// @throws std::runtime_error  naming the file and the reason
std::string plot_file(const std::string& svg, const std::string& name);

}  // namespace headpin::apps
