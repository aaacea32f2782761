#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/gl_context.h"

/// The devices that EGL lists: graphics cards and the processor. Opening a hidden card, or one with
/// a wrong driver, may crash the process, so each device is first tested in a separate process.
namespace headpin::render {

struct EglDevice {
  int number = 0;
  bool works = false;
  bool card = false;        ///< not Mesa's software renderer; known only if it works
  std::optional<int> cuda;  ///< its CUDA number
  std::string says;         ///< its renderer, or the error
};

/// @throws std::runtime_error  when EGL gives no list
std::vector<EglDevice> egl_devices();

/// Whether a name is `egl:auto` or `egl:NUMBER`.
bool is_egl_device(std::string_view name);

/// Chooses the device for `egl:auto`: the first card that works, among those of
/// CUDA_VISIBLE_DEVICES in its order if it is set; else the processor.
///
/// @param visible  value of the variable, if it is set
/// @return         number of the device; nothing if none works
/// @throws std::invalid_argument  if the variable has names other than numbers
std::optional<int> chosen_device(const std::vector<EglDevice>& devices,
                                 std::optional<std::string_view> visible);

/// @param name  as is_egl_device()
/// @throws std::runtime_error  when no device draws, with the reason for each
std::unique_ptr<GlContext> open_egl_device(std::string_view name);

}  // namespace headpin::render
