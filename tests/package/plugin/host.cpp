// Loads plugins and lets each drop a ball: it falls by g t^2 / 2, and in all of them to the bit.
// usage: host PLUGIN...
#include <cmath>
#include <cstdio>

#include <dlfcn.h>

int main(int argc, char** argv) {
  const double t = 0.25;  // [s], 60 ticks
  double first = 0.0;
  for (int i = 1; i < argc; ++i) {
    void* plugin = dlopen(argv[i], RTLD_NOW | RTLD_LOCAL);
    if (!plugin) {
      std::printf("%s\n", dlerror());
      return 1;
    }
    const auto height_of_a_ball =
        reinterpret_cast<double (*)(int)>(dlsym(plugin, "height_of_a_ball"));
    const double height = height_of_a_ball ? height_of_a_ball(60) : NAN;
    if (i == 1) first = height;
    std::printf("%s: %.17g m\n", argv[i], height);
    if (!(std::abs(height - (1.0 - 0.5 * 9.81 * t * t)) < 9.81 * t / 240.0)) return 1;  // one step
    if (height != first) return 1;
  }
  return argc > 1 ? 0 : 1;
}
