#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/gl_context.h"

/// Graphics cards, and the processor, as EGL lists them. A card that is hidden, or whose driver does
/// not fit, may crash whoever opens it: each device is tried in a process of its own before.
namespace headpin::render {

struct EglDevice {
  int number = 0;
  bool works = false;
  bool card = false;        ///< not Mesa's software; known only where it works
  std::optional<int> cuda;  ///< CUDA's number of it
  std::string says;         ///< who draws, or what is wrong
};

/// @throws std::runtime_error  when the list cannot be had
std::vector<EglDevice> egl_devices();

/// Whether a name is `egl:auto` or `egl:NUMBER`.
bool is_egl_device(std::string_view name);

/// What `egl:auto` takes: the first card that works and that CUDA_VISIBLE_DEVICES, where it is set,
/// does not hide, in its order; else the processor.
///
/// @param visible  the variable's value, nothing where it is not set
/// @return         a number, nothing where no device works
/// @throws std::invalid_argument  for other names in the variable than numbers
std::optional<int> chosen_device(const std::vector<EglDevice>& devices,
                                 std::optional<std::string_view> visible);

/// @param name  as is_egl_device()
/// @throws std::runtime_error  when it does not draw, saying of each that was tried why
std::unique_ptr<GlContext> open_egl_device(std::string_view name);

}  // namespace headpin::render
