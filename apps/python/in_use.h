#pragma once

#include <stdexcept>
#include <string>

namespace headpin::python {

/// Marks an object whose call runs without the GIL, until the end of the scope.
///
/// The object refuses all other calls until then, of other threads and of functions that the call
/// itself calls. Made and destroyed with the GIL.
class InUse {
 public:
  explicit InUse(bool& mark) : mark_(mark) { mark_ = true; }
  ~InUse() { mark_ = false; }
  InUse(const InUse&) = delete;
  InUse& operator=(const InUse&) = delete;

 private:
  bool& mark_;
};

/// @param what  "world"
/// @throws std::runtime_error  for an object that is in use
inline void require_free(bool in_use, const char* what) {
  if (!in_use) return;
  throw std::runtime_error(std::string(what) +
                           ": is making a step in another call; expected to be called after it");
}

}  // namespace headpin::python
