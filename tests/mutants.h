#pragma once

// What tests/mutants.py includes in every source that it has put faults into: switches between them.

#include <cstdlib>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

/// Whether the fault with this number is the one that HEADPIN_MUTANT asks for. That a test came here
/// is noted in the file HEADPIN_MUTANTS_REACHED, one byte a fault, also by processes that are killed.
inline bool headpin_mutant(int number) {
  static const int wanted = [] {
    const char* text = std::getenv("HEADPIN_MUTANT");
    return text != nullptr ? std::atoi(text) : 0;
  }();
  static char* const reached = [] {
    constexpr int kMost = 1 << 16;
    const char* name = std::getenv("HEADPIN_MUTANTS_REACHED");
    // Not open(), which a test may have taken over.
    const auto opened =
        name != nullptr ? syscall(SYS_openat, AT_FDCWD, name, O_RDWR | O_CLOEXEC) : -1;
    const auto file = static_cast<int>(opened);
    void* bytes =
        file < 0 ? MAP_FAILED : mmap(nullptr, kMost, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    if (file >= 0) close(file);
    return bytes == MAP_FAILED ? nullptr : static_cast<char*>(bytes);
  }();
  if (reached != nullptr) reached[number] = 1;
  return number == wanted;
}
