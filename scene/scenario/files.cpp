#include "scene/scenario/files.h"

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/auxv.h>

namespace headpin::scene {

namespace {

namespace fs = std::filesystem;

/// Path of the running program. Without /proc, as in a bare chroot, it comes from how it was
/// called.
fs::path program_file() {
  std::error_code error;
  fs::path file = fs::read_symlink("/proc/self/exe", error);
  if (!error) return file;
  const auto* called = reinterpret_cast<const char*>(getauxval(AT_EXECFN));
  file = fs::weakly_canonical(called ? called : "", error);
  return error ? fs::path{} : file;
}

/// Path of the file that has this code: the program, or a module that another program, such as
/// Python, has loaded.
fs::path code_file() {
#ifndef __EMSCRIPTEN__  // which loads no modules
  Dl_info found{};
  const bool known = dladdr(reinterpret_cast<const void*>(&program_file), &found) != 0;
  if (known && fs::path(found.dli_fname).extension() == ".so") return fs::absolute(found.dli_fname);
#endif
  return program_file();
}

/// The folder of the bundled scenarios; empty if there is none.
fs::path scenario_folder() {
  std::error_code none;
  for (const fs::path& data : data_folders()) {
    const fs::path folder = data / "scenarios";
    if (fs::is_directory(folder, none)) return folder;
  }
  return {};
}

}  // namespace

fs::path program_folder() {
  return program_file().parent_path();
}

std::vector<fs::path> data_folders() {
  std::vector<fs::path> folders;
  std::vector<fs::path> files = {code_file(), program_file()};
  files.erase(std::unique(files.begin(), files.end()), files.end());
  for (const fs::path& file : files) {
    for (const char* data : {HEADPIN_DATA_FROM_PROGRAM, "share/headpin"}) {
      folders.push_back((file.parent_path() / data).lexically_normal());
    }
  }
  return folders;
}

std::vector<std::string> scenario_names() {
  std::vector<std::string> names;
  const fs::path folder = scenario_folder();
  if (folder.empty()) return names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  }
  std::ranges::sort(names);
  return names;
}

std::string scenario_path(std::string_view name_or_file) {
  if (name_or_file.find_first_of("./") != std::string_view::npos) return std::string(name_or_file);
  const std::vector<std::string> names = scenario_names();
  if (std::ranges::find(names, name_or_file) == names.end()) {
    throw std::invalid_argument(fmt::format(
        "no scenario is called '{}'; expected a TOML file (./{} if it is one) or one of: {}",
        name_or_file, name_or_file,
        names.empty() ? "none, as none came with this program"
                      : fmt::format("{}", fmt::join(names, ", "))));
  }
  return (scenario_folder() / fmt::format("{}.toml", name_or_file)).string();
}

}  // namespace headpin::scene
