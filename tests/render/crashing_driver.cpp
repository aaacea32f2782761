// A driver of EGL's that crashes as soon as it is loaded, as one may whose card is hidden.
#include <cstdlib>

namespace {
[[gnu::constructor]] void crash() {
  std::abort();
}
}  // namespace
